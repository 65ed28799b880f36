#include "tests/fuzz/fuzz.h"

#include "core/base/digest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    ENVELOPE_LENGTH_AT = 24, // of a checkpoint; its digest follows
    ENVELOPE_BYTES = 40,
    FRAME_LENGTH_AT = 8,
    FRAME_HEADER_BYTES = 16,
    DIGEST_BYTES = 8,
};

void fuzz_require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "fuzz: does not hold: %s\n", what);
    abort();
}

char *fuzz_text(const uint8_t *bytes, size_t n)
{
    char *text = malloc(n + 1);

    fuzz_require(text != NULL, "memory for an input");
    if (n > 0)
        memcpy(text, bytes, n);
    text[n] = '\0';
    return text;
}

static void put(uint8_t *to, uint64_t value)
{
    memcpy(to, &value, sizeof value);
}

// The envelope from its first byte to the end of the n bytes.
static void seal_envelope(uint8_t *bytes, size_t n)
{
    put(bytes + ENVELOPE_LENGTH_AT, n - ENVELOPE_BYTES);
    const uint64_t head = digest_add(DIGEST_START, bytes, ENVELOPE_BYTES - DIGEST_BYTES);
    put(bytes + ENVELOPE_BYTES - DIGEST_BYTES,
        digest_add(head, bytes + ENVELOPE_BYTES, n - ENVELOPE_BYTES));
}

bool fuzz_seal_checkpoint(uint8_t *bytes, size_t n)
{
    if (n < ENVELOPE_BYTES)
        return false;
    // Envelopes are nested, each to the end: the inner one's digest is part of what the outer one's is of.
    for (size_t at = n - ENVELOPE_BYTES + 1; at-- > 0;) {
        if (at == 0 || memcmp(bytes + at, "BFCP", 4) == 0)
            seal_envelope(bytes + at, n - at);
    }
    return true;
}

bool fuzz_seal_frame(uint8_t *bytes, size_t n)
{
    uint64_t n_payload;

    if (n < FRAME_HEADER_BYTES + DIGEST_BYTES || n % DIGEST_BYTES != 0)
        return false;
    memcpy(&n_payload, bytes + FRAME_LENGTH_AT, sizeof n_payload);
    const uint64_t room = n - FRAME_HEADER_BYTES - DIGEST_BYTES;
    if (n_payload > room || room - n_payload >= DIGEST_BYTES)
        put(bytes + FRAME_LENGTH_AT, room);
    put(bytes + n - DIGEST_BYTES, digest_add(DIGEST_START, bytes, n - DIGEST_BYTES));
    return true;
}
