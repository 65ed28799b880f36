#include "core/base/digest.h"

#include <string.h>

static uint64_t add_word(uint64_t digest, uint64_t word)
{
    digest = (digest ^ word) * UINT64_C(0x100000001b3);
    // FNV moves bits only upwards; the rotation brings high bits of a word back down.
    return digest << 29 | digest >> 35;
}

uint64_t digest_add(uint64_t digest, const void *bytes, size_t n)
{
    const unsigned char *at = bytes;
    uint64_t word;

    for (size_t left = n; left >= sizeof word; left -= sizeof word, at += sizeof word) {
        memcpy(&word, at, sizeof word);
        digest = add_word(digest, word);
    }
    word = 0;
    if (n % sizeof word != 0)
        memcpy(&word, at, n % sizeof word);
    digest = add_word(digest, word);
    return add_word(digest, n) ^ digest >> 31;
}
