/// Comparisons of lanes (simd.h). Comparisons with a NaN are false.

#pragma once

#include "core/base/simd.h"

/// The result of a comparison: all bits of a lane set, or none.
typedef long long simd_bits __attribute__((vector_size(sizeof(simd))));

/// x in lanes where a < b, else 0.
static inline simd simd_where_less(simd a, simd b, simd x)
{
#if defined(__AVX512F__)
    __mmask8 less = _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
    return (simd)_mm512_maskz_mov_pd(less, (__m512d)x);
#else
    return (simd)((simd_bits)(a < b) & (simd_bits)x);
#endif
}

/// x in lanes where a < b, else y.
static inline simd simd_select_less(simd a, simd b, simd x, simd y)
{
#if defined(__AVX512F__)
    __mmask8 less = _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
    return (simd)_mm512_mask_mov_pd((__m512d)y, less, (__m512d)x);
#else
    const simd_bits less = a < b;
    return (simd)((less & (simd_bits)x) | (~less & (simd_bits)y));
#endif
}

/// Bit k is set where a < b in lane k.
static inline unsigned simd_less(simd a, simd b)
{
#if defined(__AVX512F__)
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#elif defined(__AVX2__)
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ));
#elif defined(__SSE2__)
    return (unsigned)_mm_movemask_pd(_mm_cmplt_pd((__m128d)a, (__m128d)b));
#else
    unsigned bits = 0;
    for (unsigned k = 0; k < SIMD_LANES; k++)
        bits |= (a[k] < b[k] ? 1U : 0U) << k;
    return bits;
#endif
}

/// The smaller of x and y; y if one is NaN.
static inline simd simd_min(simd x, simd y)
{
#if defined(__AVX512F__)
    return (simd)_mm512_min_pd((__m512d)x, (__m512d)y);
#elif defined(__AVX2__)
    return (simd)_mm256_min_pd((__m256d)x, (__m256d)y);
#elif defined(__SSE2__)
    return (simd)_mm_min_pd((__m128d)x, (__m128d)y);
#else
    for (int k = 0; k < SIMD_LANES; k++)
        x[k] = x[k] < y[k] ? x[k] : y[k];
    return x;
#endif
}

/// The larger of x's lanes.
static inline double simd_peak(simd x)
{
    double peak = x[0];

    for (int k = 1; k < SIMD_LANES; k++)
        peak = x[k] > peak ? x[k] : peak;
    return peak;
}
