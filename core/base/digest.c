#include "core/base/digest.h"

#include <string.h>

#define FACTOR UINT64_C(0xc6a4a7935bd1e995)

// The word is mixed before it is combined with the digest: otherwise its top bit could be cancelled by one
// bit of the next word.
static uint64_t add_word(uint64_t digest, uint64_t word)
{
    word *= FACTOR;
    word ^= word >> 47;
    word *= FACTOR;
    return (digest ^ word) * FACTOR;
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
    digest = add_word(add_word(digest, word), n);
    digest = (digest ^ digest >> 47) * FACTOR;
    return digest ^ digest >> 47;
}
