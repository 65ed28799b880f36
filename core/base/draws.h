/// Random draws of a scenario: each is a function of what it is for, so that none depends on how many were made before.
///
/// The generator is Philox4x64-10, which encrypts a counter with a key:
///
///     key     = (seed, 0)
///     counter = (index/4, item, source, substream), with the purpose in the top 8 bits of the first word
///
/// Each counter has four words; the draw of an index is word index mod 4.
///
/// Source   J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw: Parallel random numbers: as easy as 1, 2, 3,
///          Proc. SC'11 (2011). Not cryptographic.
/// Bits     the same on every machine; those of other variates are as exact as libm's functions.

#pragma once

#include <stdint.h>

/// What a draw of an item, which is a part or a failure, is for.
typedef enum draws_purpose {
    DRAWS_GAP,     ///< between the part before and this one
    DRAWS_KIND,    ///< of cargo
    DRAWS_PLACE,   ///< on the line of its feed; index 0 first, the others where that is not free
    DRAWS_HEADING, ///< see scene_feed
    DRAWS_BETWEEN, ///< the failure before, or the start, and this failure; see scene_failure
    DRAWS_REPAIR,  ///< of a failure
    DRAWS_PURPOSES
} draws_purpose;

/// The draws of a feed, a photo eye or a failure.
typedef struct draws {
    uint64_t seed;      ///< of a feed; else 0
    uint64_t substream; ///< of the scenario; replications differ in it
    uint64_t source;    ///< a digest of the id of what draws
} draws;

/// Philox4x64-10: the four words of a counter under a key.
void draws_philox(const uint64_t counter[4], const uint64_t key[2], uint64_t ret_words[4]);

/// Draw `index` of an item for a purpose, uniform in (0, 1): an odd multiple of 2^-53, so never 0 nor 1.
double draws_unit(const draws *from, uint64_t item, draws_purpose purpose, uint64_t index);

/// The gap before a part, in units of the mean gap: an Erlang variate of mean 1, the sum of `shape` exponential ones
/// of mean 1/shape; shape >= 1, and 1 is the exponential variate of Poisson arrivals.
double draws_gap(const draws *from, uint64_t part, uint32_t shape);

/// A time of mean 1 by a Weibull distribution of a shape > 0, by inversion of draw 0; shape 1 is the exponential one:
/// (-ln u)^(1/shape)/Gamma(1 + 1/shape).
double draws_weibull(const draws *from, uint64_t item, draws_purpose purpose, double shape);
