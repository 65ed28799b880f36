/// Registers of lanes (simd.h) moved by one lane, so that neighbours in a row come from registers.

#pragma once

#include "core/base/simd.h"

/// The lanes of x moved up by one; the lowest is the highest of before.
static inline simd simd_shift_up(simd before, simd x)
{
#if defined(__AVX512F__)
    return (simd)_mm512_alignr_epi64((__m512i)x, (__m512i)before, 7);
#elif defined(__AVX2__)
    return __builtin_shufflevector(before, x, 3, 4, 5, 6);
#else
    return __builtin_shufflevector(before, x, 1, 2);
#endif
}

/// The lanes of x moved down by one; the highest is the lowest of after.
static inline simd simd_shift_down(simd x, simd after)
{
#if defined(__AVX512F__)
    return (simd)_mm512_alignr_epi64((__m512i)after, (__m512i)x, 1);
#elif defined(__AVX2__)
    return __builtin_shufflevector(x, after, 1, 2, 3, 4);
#else
    return __builtin_shufflevector(x, after, 1, 2);
#endif
}
