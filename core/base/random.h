/// A random generator with the same sequence on every machine: xoshiro256** (Blackman and Vigna 2018),
/// seeded through splitmix64 as its authors advise. Not cryptographic.

#pragma once

#include <stdint.h>

/// A generator. Begin with random_init().
typedef struct bf_random {
    uint64_t state[4]; ///< never all zero
} bf_random;

/// Start the sequence of a seed.
void random_init(bf_random *random, uint64_t seed);

/// The next 64 bits.
uint64_t random_bits(bf_random *random);

/// The next number, uniform on the multiples of 2^-53 in [0, 1).
double random_unit(bf_random *random);
