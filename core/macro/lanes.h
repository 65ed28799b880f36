/// Eight doubles that move together: one AVX-512 register, two of AVX2, four of SSE2 or NEON.
///
/// Every operation acts on each lane alone and is exact or correctly rounded, so a kernel written
/// with lanes gives the same bits on every processor. Kernels are compiled once per instruction set
/// (see kernels.h); this header picks the instructions from what the compiler is allowed to use.

#pragma once

#include "core/macro/block_set.h"

#include <string.h>

#if defined(__AVX512F__) || defined(__AVX2__) || defined(__SSE2__)
#include <immintrin.h>
#endif

/// A block of doubles; + - * / act lane by lane, and with a scalar on all lanes.
typedef double lanes __attribute__((vector_size(64)));

/// Load from an address aligned to 64 bytes.
static inline lanes lanes_load(const double *at)
{
    lanes x;
    memcpy(&x, __builtin_assume_aligned(at, 64), sizeof x);
    return x;
}

/// Load from any address.
static inline lanes lanes_load_any(const double *at)
{
    lanes x;
    memcpy(&x, at, sizeof x);
    return x;
}

/// Store to an address aligned to 64 bytes.
static inline void lanes_store(double *at, lanes x)
{
    memcpy(__builtin_assume_aligned(at, 64), &x, sizeof x);
}

/// The same value in all lanes.
static inline lanes lanes_all(double value)
{
    return (lanes){ value, value, value, value, value, value, value, value };
}

#if defined(__AVX512F__)

/// max(x, 0): 0 for -0 and NaN, like every variant below.
static inline lanes lanes_positive(lanes x)
{
    return (lanes)_mm512_max_pd((__m512d)x, _mm512_setzero_pd());
}

/// min(x, 0).
static inline lanes lanes_negative(lanes x)
{
    return (lanes)_mm512_min_pd((__m512d)x, _mm512_setzero_pd());
}

/// The larger of x and y.
static inline lanes lanes_max(lanes x, lanes y)
{
    return (lanes)_mm512_max_pd((__m512d)x, (__m512d)y);
}

/// x where x >= 1, else 0.
static inline lanes lanes_packed(lanes x)
{
    __mmask8 packed = _mm512_cmp_pd_mask((__m512d)x, _mm512_set1_pd(1.0), _CMP_GE_OQ);
    return (lanes)_mm512_maskz_mov_pd(packed, (__m512d)x);
}

/// Bit k is set where lane k >= 1.
static inline unsigned lanes_packed_bits(lanes x)
{
    return _mm512_cmp_pd_mask((__m512d)x, _mm512_set1_pd(1.0), _CMP_GE_OQ);
}

/// Square roots.
static inline lanes lanes_sqrt(lanes x)
{
    return (lanes)_mm512_sqrt_pd((__m512d)x);
}

#else

#if defined(__AVX2__)
typedef __m256d lanes_part;
#define LANES_OP(name)  _mm256_##name##_pd
#define LANES_PACKED(x) _mm256_cmp_pd(x, _mm256_set1_pd(1.0), _CMP_GE_OQ)
#elif defined(__SSE2__)
typedef __m128d lanes_part;
#define LANES_OP(name)  _mm_##name##_pd
#define LANES_PACKED(x) _mm_cmpge_pd(x, _mm_set1_pd(1.0))
#endif

#if defined(LANES_OP)

enum { LANES_PARTS = sizeof(lanes) / sizeof(lanes_part), LANES_PART = LANES / LANES_PARTS };

// Applies expression, in terms of the parts a of x and b of y, to all parts.
#define LANES_EACH(x, y, expression)                                                               \
    lanes_part parts_x[LANES_PARTS], parts_y[LANES_PARTS];                                         \
    memcpy(parts_x, &(x), sizeof parts_x);                                                         \
    memcpy(parts_y, &(y), sizeof parts_y);                                                         \
    for (int part = 0; part < LANES_PARTS; part++) {                                               \
        lanes_part a = parts_x[part], b = parts_y[part];                                           \
        (void)b;                                                                                   \
        parts_x[part] = expression;                                                                \
    }                                                                                              \
    memcpy(&(x), parts_x, sizeof parts_x);                                                         \
    return x

static inline lanes lanes_positive(lanes x)
{
    LANES_EACH(x, x, LANES_OP(max)(a, LANES_OP(setzero)()));
}

static inline lanes lanes_negative(lanes x)
{
    LANES_EACH(x, x, LANES_OP(min)(a, LANES_OP(setzero)()));
}

static inline lanes lanes_max(lanes x, lanes y)
{
    LANES_EACH(x, y, LANES_OP(max)(a, b));
}

static inline lanes lanes_packed(lanes x)
{
    LANES_EACH(x, x, LANES_OP(and)(a, LANES_PACKED(a)));
}

static inline lanes lanes_sqrt(lanes x)
{
    LANES_EACH(x, x, LANES_OP(sqrt)(a));
}

static inline unsigned lanes_packed_bits(lanes x)
{
    lanes_part parts[LANES_PARTS];
    unsigned bits = 0;

    memcpy(parts, &x, sizeof parts);
    for (int part = 0; part < LANES_PARTS; part++)
        bits |= (unsigned)LANES_OP(movemask)(LANES_PACKED(parts[part])) << part * LANES_PART;
    return bits;
}

#else

static inline lanes lanes_positive(lanes x)
{
    for (int k = 0; k < LANES; k++)
        x[k] = x[k] > 0.0 ? x[k] : 0.0;
    return x;
}

static inline lanes lanes_negative(lanes x)
{
    for (int k = 0; k < LANES; k++)
        x[k] = x[k] < 0.0 ? x[k] : 0.0;
    return x;
}

static inline lanes lanes_max(lanes x, lanes y)
{
    for (int k = 0; k < LANES; k++)
        x[k] = x[k] > y[k] ? x[k] : y[k];
    return x;
}

static inline lanes lanes_packed(lanes x)
{
    for (int k = 0; k < LANES; k++)
        x[k] = x[k] >= 1.0 ? x[k] : 0.0;
    return x;
}

static inline lanes lanes_sqrt(lanes x)
{
    for (int k = 0; k < LANES; k++)
        x[k] = __builtin_sqrt(x[k]);
    return x;
}

static inline unsigned lanes_packed_bits(lanes x)
{
    unsigned bits = 0;

    for (unsigned k = 0; k < LANES; k++)
        bits |= (x[k] >= 1.0 ? 1U : 0U) << k;
    return bits;
}

#endif
#endif
