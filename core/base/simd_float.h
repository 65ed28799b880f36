/// SIMD: a register of floats, twice as many lanes as simd.h has doubles.
///
/// Every operation acts on each lane alone and is exact or correctly rounded, as in simd.h. For
/// iterations whose result is only a guide, such as a pressure: what is conserved is computed in doubles.

#pragma once

#include "core/base/simd.h"

#include <stdbool.h>

enum { SIMD_FLOAT_LANES = 2 * SIMD_LANES }; ///< floats in a register

/// A register of floats; + - * / act lane by lane, and with a scalar on all lanes.
typedef float simd_float __attribute__((vector_size(SIMD_FLOAT_LANES * sizeof(float))));

/// Load from any address.
static inline simd_float simd_float_load(const float *at)
{
    simd_float x;
    memcpy(&x, at, sizeof x);
    return x;
}

/// Store to any address.
static inline void simd_float_store(float *at, simd_float x)
{
    memcpy(at, &x, sizeof x);
}

/// The same value in all lanes.
static inline simd_float simd_float_all(float value)
{
    return value - (simd_float){ 0.0F };
}

#if defined(__AVX512F__)

/// The larger of x and y.
static inline simd_float simd_float_max(simd_float x, simd_float y)
{
    return (simd_float)_mm512_max_ps((__m512)x, (__m512)y);
}

/// The smaller of x and y.
static inline simd_float simd_float_min(simd_float x, simd_float y)
{
    return (simd_float)_mm512_min_ps((__m512)x, (__m512)y);
}

#elif defined(__AVX2__)

static inline simd_float simd_float_max(simd_float x, simd_float y)
{
    return (simd_float)_mm256_max_ps((__m256)x, (__m256)y);
}

static inline simd_float simd_float_min(simd_float x, simd_float y)
{
    return (simd_float)_mm256_min_ps((__m256)x, (__m256)y);
}

#elif defined(__SSE2__)

static inline simd_float simd_float_max(simd_float x, simd_float y)
{
    return (simd_float)_mm_max_ps((__m128)x, (__m128)y);
}

static inline simd_float simd_float_min(simd_float x, simd_float y)
{
    return (simd_float)_mm_min_ps((__m128)x, (__m128)y);
}

#else

static inline simd_float simd_float_max(simd_float x, simd_float y)
{
    for (int k = 0; k < SIMD_FLOAT_LANES; k++)
        x[k] = x[k] > y[k] ? x[k] : y[k];
    return x;
}

static inline simd_float simd_float_min(simd_float x, simd_float y)
{
    for (int k = 0; k < SIMD_FLOAT_LANES; k++)
        x[k] = x[k] < y[k] ? x[k] : y[k];
    return x;
}

#endif

/// True if a bit of a lane of x is set. Of lanes that are not negative: if one is not 0.
static inline bool simd_float_has_bits(simd_float x)
{
#if defined(__AVX512F__)
    return _mm512_test_epi32_mask((__m512i)x, (__m512i)x) != 0;
#elif defined(__AVX2__)
    return _mm256_testz_si256((__m256i)x, (__m256i)x) == 0;
#else
    int32_t bits[SIMD_FLOAT_LANES], all = 0;

    memcpy(bits, &x, sizeof bits);
    for (int k = 0; k < SIMD_FLOAT_LANES; k++)
        all |= bits[k];
    return all != 0;
#endif
}

/// The larger of `largest` and of all lanes of x.
static inline float simd_float_largest(simd_float x, float largest)
{
    for (int k = 0; k < SIMD_FLOAT_LANES; k++)
        largest = x[k] > largest ? x[k] : largest;
    return largest;
}
