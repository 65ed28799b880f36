/// SIMD: a register of doubles of the instruction set that the compiler may use.
///
/// Every operation acts on each lane alone and is exact or correctly rounded, so a kernel written
/// with lanes gives the same bits on every processor, whatever their number. Kernels are compiled
/// once per instruction set (core/CMakeLists.txt).

#pragma once

#include <string.h>

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h> // the header above takes ten times as long to compile
#endif

#if defined(__AVX512F__)
enum { SIMD_LANES = 8 }; ///< doubles in a register; a block of cells is a multiple of it
#elif defined(__AVX2__)
enum { SIMD_LANES = 4 };
#else
enum { SIMD_LANES = 2 };
#endif

/// A register of doubles; + - * / act lane by lane, and with a scalar on all lanes.
typedef double simd __attribute__((vector_size(SIMD_LANES * sizeof(double))));

/// Load from an address aligned to a register's size.
static inline simd simd_load(const double *at)
{
    simd x;
    memcpy(&x, __builtin_assume_aligned(at, sizeof x), sizeof x);
    return x;
}

/// Load from any address.
static inline simd simd_load_any(const double *at)
{
    simd x;
    memcpy(&x, at, sizeof x);
    return x;
}

/// Store to an address aligned to a register's size.
static inline void simd_store(double *at, simd x)
{
    memcpy(__builtin_assume_aligned(at, sizeof x), &x, sizeof x);
}

/// The same value in all lanes.
static inline simd simd_all(double value)
{
    return value - (simd){ 0.0 };
}

#if defined(__AVX512F__)

/// x, kept in a register: without it the compiler loads x again for each of its uses.
static inline simd simd_held(simd x)
{
    __asm__("" : "+v"(x));
    return x;
}

/// max(x, 0): 0 for -0, like every variant below.
static inline simd simd_positive(simd x)
{
    return (simd)_mm512_max_pd((__m512d)x, _mm512_setzero_pd());
}

/// min(x, 0).
static inline simd simd_negative(simd x)
{
    return (simd)_mm512_min_pd((__m512d)x, _mm512_setzero_pd());
}

/// The larger of x and y.
static inline simd simd_max(simd x, simd y)
{
    return (simd)_mm512_max_pd((__m512d)x, (__m512d)y);
}

/// x where x >= 1, else 0.
static inline simd simd_from_1(simd x)
{
    __mmask8 mask = _mm512_cmp_pd_mask((__m512d)x, _mm512_set1_pd(1.0), _CMP_GE_OQ);
    return (simd)_mm512_maskz_mov_pd(mask, (__m512d)x);
}

/// Bit k is set where lane k >= 1.
static inline unsigned simd_bits_from_1(simd x)
{
    return _mm512_cmp_pd_mask((__m512d)x, _mm512_set1_pd(1.0), _CMP_GE_OQ);
}

/// Square roots.
static inline simd simd_sqrt(simd x)
{
    return (simd)_mm512_sqrt_pd((__m512d)x);
}

#elif defined(__AVX2__)

static inline simd simd_held(simd x)
{
    __asm__("" : "+x"(x));
    return x;
}

static inline simd simd_positive(simd x)
{
    return (simd)_mm256_max_pd((__m256d)x, _mm256_setzero_pd());
}

static inline simd simd_negative(simd x)
{
    return (simd)_mm256_min_pd((__m256d)x, _mm256_setzero_pd());
}

static inline simd simd_max(simd x, simd y)
{
    return (simd)_mm256_max_pd((__m256d)x, (__m256d)y);
}

static inline simd simd_from_1(simd x)
{
    __m256d mask = _mm256_cmp_pd((__m256d)x, _mm256_set1_pd(1.0), _CMP_GE_OQ);
    return (simd)_mm256_and_pd(mask, (__m256d)x);
}

static inline unsigned simd_bits_from_1(simd x)
{
    __m256d mask = _mm256_cmp_pd((__m256d)x, _mm256_set1_pd(1.0), _CMP_GE_OQ);
    return (unsigned)_mm256_movemask_pd(mask);
}

static inline simd simd_sqrt(simd x)
{
    return (simd)_mm256_sqrt_pd((__m256d)x);
}

#elif defined(__SSE2__)

static inline simd simd_held(simd x)
{
    __asm__("" : "+x"(x));
    return x;
}

static inline simd simd_positive(simd x)
{
    return (simd)_mm_max_pd((__m128d)x, _mm_setzero_pd());
}

static inline simd simd_negative(simd x)
{
    return (simd)_mm_min_pd((__m128d)x, _mm_setzero_pd());
}

static inline simd simd_max(simd x, simd y)
{
    return (simd)_mm_max_pd((__m128d)x, (__m128d)y);
}

static inline simd simd_from_1(simd x)
{
    return (simd)_mm_and_pd(_mm_cmpge_pd((__m128d)x, _mm_set1_pd(1.0)), (__m128d)x);
}

static inline unsigned simd_bits_from_1(simd x)
{
    return (unsigned)_mm_movemask_pd(_mm_cmpge_pd((__m128d)x, _mm_set1_pd(1.0)));
}

static inline simd simd_sqrt(simd x)
{
    return (simd)_mm_sqrt_pd((__m128d)x);
}

#else

static inline simd simd_held(simd x)
{
    return x;
}

static inline simd simd_positive(simd x)
{
    for (int k = 0; k < SIMD_LANES; k++)
        x[k] = x[k] > 0.0 ? x[k] : 0.0;
    return x;
}

static inline simd simd_negative(simd x)
{
    for (int k = 0; k < SIMD_LANES; k++)
        x[k] = x[k] < 0.0 ? x[k] : 0.0;
    return x;
}

static inline simd simd_max(simd x, simd y)
{
    for (int k = 0; k < SIMD_LANES; k++)
        x[k] = x[k] > y[k] ? x[k] : y[k];
    return x;
}

static inline simd simd_from_1(simd x)
{
    for (int k = 0; k < SIMD_LANES; k++)
        x[k] = x[k] >= 1.0 ? x[k] : 0.0;
    return x;
}

static inline unsigned simd_bits_from_1(simd x)
{
    unsigned bits = 0;

    for (unsigned k = 0; k < SIMD_LANES; k++)
        bits |= (x[k] >= 1.0 ? 1U : 0U) << k;
    return bits;
}

static inline simd simd_sqrt(simd x)
{
    for (int k = 0; k < SIMD_LANES; k++)
        x[k] = __builtin_sqrt(x[k]);
    return x;
}

#endif
