#include "core/base/draws.h"

#include <math.h>

enum { PHILOX_ROUNDS = 10 };

// Of 128 bits; ISO C has no such integer.
__extension__ typedef unsigned __int128 wide;

void draws_philox(const uint64_t counter[4], const uint64_t key[2], uint64_t ret_words[4])
{
    uint64_t x0 = counter[0], x1 = counter[1], x2 = counter[2], x3 = counter[3];
    uint64_t k0 = key[0], k1 = key[1];

    for (int round = 0; round < PHILOX_ROUNDS; round++) {
        const wide a = (wide)x0 * UINT64_C(0xd2e7470ee14c6c93);
        const wide b = (wide)x2 * UINT64_C(0xca5a826395121157);
        x0 = (uint64_t)(b >> 64) ^ x1 ^ k0;
        x2 = (uint64_t)(a >> 64) ^ x3 ^ k1;
        x1 = (uint64_t)b;
        x3 = (uint64_t)a;
        k0 += UINT64_C(0x9e3779b97f4a7c15);
        k1 += UINT64_C(0xbb67ae8584caa73b);
    }
    ret_words[0] = x0;
    ret_words[1] = x1;
    ret_words[2] = x2;
    ret_words[3] = x3;
}

static void make_words(const draws *from, uint64_t item, draws_purpose purpose, uint64_t block,
                       uint64_t ret_words[4])
{
    const uint64_t counter[4] = { block | (uint64_t)purpose << 56, item, from->source,
                                  from->substream };
    const uint64_t key[2] = { from->seed, 0 };

    draws_philox(counter, key, ret_words);
}

static double to_unit(uint64_t word)
{
    return (double)(word >> 11 | 1) * 0x1p-53;
}

double draws_unit(const draws *from, uint64_t item, draws_purpose purpose, uint64_t index)
{
    uint64_t words[4];

    make_words(from, item, purpose, index / 4, words);
    return to_unit(words[index % 4]);
}

double draws_gap(const draws *from, uint64_t part, uint32_t shape)
{
    double sum = 0.0;
    uint64_t words[4];

    for (uint32_t k = 0; k < shape; k++) {
        if (k % 4 == 0)
            make_words(from, part, DRAWS_GAP, k / 4, words);
        sum -= log(to_unit(words[k % 4]));
    }
    return sum / shape;
}

double draws_weibull(const draws *from, uint64_t item, draws_purpose purpose, double shape)
{
    const double exponential = -log(draws_unit(from, item, purpose, 0));

    return shape == 1.0 ? exponential : pow(exponential, 1.0 / shape) / tgamma(1.0 + 1.0 / shape);
}
