/// Random variates of studies: each is a function of what it is for, by the generator of core/base/draws.h. So a study
/// makes the same trials whatever the order in which they end.
///
///     key     = (seed, 1)              feeds have (seed, 0)
///     counter = (index, item, set, purpose)

#pragma once

#include <stdint.h>

/// What variates are for.
typedef enum variates_purpose {
    VARIATES_SHIFT,       ///< of Sobol's points
    VARIATES_PERMUTATION, ///< of the strata of Latin hypercubes
    VARIATES_PLACE,       ///< within such a stratum
    VARIATES_STEP         ///< of the evolution strategy
} variates_purpose;

/// Where a variate comes from.
typedef struct variates_key {
    uint64_t seed;            ///< of the study
    variates_purpose purpose; ///< what it is for
    uint64_t set;  ///< a number that the caller chooses, say of a generation or of a parameter
    uint64_t item; ///< one within the set
} variates_key;

/// 64 random bits.
uint64_t variates_bits(const variates_key *key, uint64_t index);

/// Uniform in (0, 1), never 0 nor 1.
double variates_unit(const variates_key *key, uint64_t index);

/// Of the standard normal distribution, by Box and Muller's transform.
double variates_normal(const variates_key *key, uint64_t index);
