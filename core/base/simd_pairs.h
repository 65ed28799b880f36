/// SIMD: lanes of even and of odd places of an array taken apart and put together, and conversion to and from floats.

#pragma once

#include "core/base/simd.h"

/// As many floats as a register has doubles.
typedef float simd_narrow __attribute__((vector_size(SIMD_LANES * sizeof(float))));

/// Load floats from any address and widen them.
static inline simd simd_load_floats(const float *at)
{
    simd_narrow x;
    memcpy(&x, at, sizeof x);
    return __builtin_convertvector(x, simd);
}

/// x - y of floats from any addresses, rounded to floats and widened.
static inline simd simd_float_differences(const float *x, const float *y)
{
    simd_narrow from, what;
    memcpy(&from, x, sizeof from);
    memcpy(&what, y, sizeof what);
    return __builtin_convertvector(from - what, simd);
}

/// Round to floats and store them to any address.
static inline void simd_store_floats(float *at, simd x)
{
    const simd_narrow narrow = __builtin_convertvector(x, simd_narrow);
    memcpy(at, &narrow, sizeof narrow);
}

/// Lanes 0, 2, 4, .. of `low` and then of `high`.
static inline simd simd_even(simd low, simd high)
{
#if defined(__AVX512F__)
    return __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
#elif defined(__AVX2__)
    return __builtin_shufflevector(low, high, 0, 2, 4, 6);
#else
    return __builtin_shufflevector(low, high, 0, 2);
#endif
}

/// Lanes 1, 3, 5, .. of `low` and then of `high`.
static inline simd simd_odd(simd low, simd high)
{
#if defined(__AVX512F__)
    return __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
#elif defined(__AVX2__)
    return __builtin_shufflevector(low, high, 1, 3, 5, 7);
#else
    return __builtin_shufflevector(low, high, 1, 3);
#endif
}

/// The inverse of simd_even and simd_odd: what was `low`.
static inline simd simd_pairs_low(simd even, simd odd)
{
#if defined(__AVX512F__)
    return __builtin_shufflevector(even, odd, 0, 8, 1, 9, 2, 10, 3, 11);
#elif defined(__AVX2__)
    return __builtin_shufflevector(even, odd, 0, 4, 1, 5);
#else
    return __builtin_shufflevector(even, odd, 0, 2);
#endif
}

/// What was `high`.
static inline simd simd_pairs_high(simd even, simd odd)
{
#if defined(__AVX512F__)
    return __builtin_shufflevector(even, odd, 4, 12, 5, 13, 6, 14, 7, 15);
#elif defined(__AVX2__)
    return __builtin_shufflevector(even, odd, 2, 6, 3, 7);
#else
    return __builtin_shufflevector(even, odd, 1, 3);
#endif
}
