/// Comparisons of lanes (simd.h). Comparisons with a NaN are false.

#pragma once

#include "core/base/simd.h"

/// What a comparison of lanes gives: all bits of a lane, or none.
typedef long long lanes_bits __attribute__((vector_size(sizeof(lanes))));

/// x in lanes where a < b, else 0.
static inline lanes lanes_where_less(lanes a, lanes b, lanes x)
{
#if defined(__AVX512F__)
    __mmask8 less = _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
    return (lanes)_mm512_maskz_mov_pd(less, (__m512d)x);
#else
    return (lanes)((lanes_bits)(a < b) & (lanes_bits)x);
#endif
}

/// Bit k is set where a < b in lane k.
static inline unsigned lanes_less(lanes a, lanes b)
{
#if defined(__AVX512F__)
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#elif defined(__AVX2__)
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ));
#elif defined(__SSE2__)
    return (unsigned)_mm_movemask_pd(_mm_cmplt_pd((__m128d)a, (__m128d)b));
#else
    unsigned bits = 0;
    for (unsigned k = 0; k < LANES; k++)
        bits |= (a[k] < b[k] ? 1U : 0U) << k;
    return bits;
#endif
}

/// The smaller of x and y; y if one is NaN.
static inline lanes lanes_min(lanes x, lanes y)
{
#if defined(__AVX512F__)
    return (lanes)_mm512_min_pd((__m512d)x, (__m512d)y);
#elif defined(__AVX2__)
    return (lanes)_mm256_min_pd((__m256d)x, (__m256d)y);
#elif defined(__SSE2__)
    return (lanes)_mm_min_pd((__m128d)x, (__m128d)y);
#else
    for (int k = 0; k < LANES; k++)
        x[k] = x[k] < y[k] ? x[k] : y[k];
    return x;
#endif
}

/// The larger of x's lanes.
static inline double lanes_peak(lanes x)
{
    double peak = x[0];

    for (int k = 1; k < LANES; k++)
        peak = x[k] > peak ? x[k] : peak;
    return peak;
}
