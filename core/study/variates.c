#include "core/study/variates.h"

#include "core/base/draws.h"

#include <math.h>

static void make_words(const variates_key *key, uint64_t index, uint64_t ret_words[4])
{
    const uint64_t counter[4] = { index, key->item, key->set, (uint64_t)key->purpose };
    const uint64_t cipher_key[2] = { key->seed, 1 };

    draws_philox(counter, cipher_key, ret_words);
}

static double to_unit(uint64_t word)
{
    return (double)(word >> 11 | 1) * 0x1p-53;
}

uint64_t variates_bits(const variates_key *key, uint64_t index)
{
    uint64_t words[4];

    make_words(key, index, words);
    return words[0];
}

double variates_unit(const variates_key *key, uint64_t index)
{
    return to_unit(variates_bits(key, index));
}

double variates_normal(const variates_key *key, uint64_t index)
{
    uint64_t words[4];

    make_words(key, index, words);
    return sqrt(-2.0 * log(to_unit(words[0]))) * cos(2.0 * M_PI * to_unit(words[1]));
}
