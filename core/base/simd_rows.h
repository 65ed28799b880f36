/// Tables with rows of four or eight doubles, read and written as lanes: lane k belongs to the row that begins
/// at[k] doubles into the table, a multiple of the row's length.
///
/// A row is one quad of four columns, or two, columns 0 to 3 and 4 to 7. Whole quads are loaded and transposed
/// in registers, which costs far less than gathering columns one number at a time. Rows are aligned to
/// their size.

#pragma once

#include "core/base/simd.h"

#include <stddef.h>
#include <stdint.h>

enum {
    SIMD_ROW = 8,  ///< doubles in a row
    SIMD_QUAD = 4, ///< doubles in a row that is one quad
};

/// Four columns of SIMD_LANES rows.
typedef struct simd_quad {
    simd column[4]; ///< each with a lane per row
} simd_quad;

#if defined(__AVX2__)

/// A quad of one row, in a register.
typedef double simd_row_quad __attribute__((vector_size(4 * sizeof(double))));

/// Load it.
static inline simd_row_quad simd_row_load(const double *at)
{
    simd_row_quad x;
    memcpy(&x, __builtin_assume_aligned(at, sizeof x), sizeof x);
    return x;
}

/// Store it.
static inline void simd_row_store(double *at, simd_row_quad x)
{
    memcpy(__builtin_assume_aligned(at, sizeof x), &x, sizeof x);
}

#endif

#if defined(__AVX512F__)

/// Quads of two rows in one register.
static inline simd simd_join(const double *low, const double *high)
{
    __m512d x = _mm512_castpd256_pd512((__m256d)simd_row_load(low));

    return (simd)_mm512_insertf64x4(x, (__m256d)simd_row_load(high), 1);
}

/// Columns 0 to 3 of a table's rows, or 4 to 7 of a table that begins at column 4 of the first row.
static inline simd_quad simd_quad_load(const double *table, const uint32_t *at)
{
    const double *row[SIMD_LANES];
    for (int k = 0; k < SIMD_LANES; k++)
        row[k] = table + at[k];
    // Pairs of columns of rows 0 1 2 3, a c with a c and b d with b d, then of rows 4 5 6 7.
    simd r02 = simd_join(row[0], row[2]), r13 = simd_join(row[1], row[3]);
    simd r46 = simd_join(row[4], row[6]), r57 = simd_join(row[5], row[7]);
    simd ac0 = __builtin_shufflevector(r02, r13, 0, 8, 2, 10, 4, 12, 6, 14);
    simd bd0 = __builtin_shufflevector(r02, r13, 1, 9, 3, 11, 5, 13, 7, 15);
    simd ac4 = __builtin_shufflevector(r46, r57, 0, 8, 2, 10, 4, 12, 6, 14);
    simd bd4 = __builtin_shufflevector(r46, r57, 1, 9, 3, 11, 5, 13, 7, 15);
    return (simd_quad){ {
        __builtin_shufflevector(ac0, ac4, 0, 1, 4, 5, 8, 9, 12, 13),
        __builtin_shufflevector(bd0, bd4, 0, 1, 4, 5, 8, 9, 12, 13),
        __builtin_shufflevector(ac0, ac4, 2, 3, 6, 7, 10, 11, 14, 15),
        __builtin_shufflevector(bd0, bd4, 2, 3, 6, 7, 10, 11, 14, 15),
    } };
}

/// Write columns 0 to 3 of a table's rows; a row that occurs twice must have the same values.
static inline void simd_quad_scatter(double *table, const uint32_t *at, const simd_quad *quad)
{
    const simd *c = quad->column;
    simd ab0 = __builtin_shufflevector(c[0], c[1], 0, 8, 2, 10, 4, 12, 6, 14);
    simd ab1 = __builtin_shufflevector(c[0], c[1], 1, 9, 3, 11, 5, 13, 7, 15);
    simd cd0 = __builtin_shufflevector(c[2], c[3], 0, 8, 2, 10, 4, 12, 6, 14);
    simd cd1 = __builtin_shufflevector(c[2], c[3], 1, 9, 3, 11, 5, 13, 7, 15);
    const simd pair[4] = {
        __builtin_shufflevector(ab0, cd0, 0, 1, 8, 9, 2, 3, 10, 11),
        __builtin_shufflevector(ab1, cd1, 0, 1, 8, 9, 2, 3, 10, 11),
        __builtin_shufflevector(ab0, cd0, 4, 5, 12, 13, 6, 7, 14, 15),
        __builtin_shufflevector(ab1, cd1, 4, 5, 12, 13, 6, 7, 14, 15),
    };
    for (int k = 0; k < 4; k++) {
        const int row = k / 2 * 4 + k % 2;
        simd_row_store(table + at[row], __builtin_shufflevector(pair[k], pair[k], 0, 1, 2, 3));
        simd_row_store(table + at[row + 2], __builtin_shufflevector(pair[k], pair[k], 4, 5, 6, 7));
    }
}

#elif defined(__AVX2__)

/// Four registers, transposed.
static inline simd_quad simd_quad_turned(simd r0, simd r1, simd r2, simd r3)
{
    simd ac0 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6);
    simd bd0 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
    simd ac2 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6);
    simd bd2 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
    return (simd_quad){ {
        __builtin_shufflevector(ac0, ac2, 0, 1, 4, 5),
        __builtin_shufflevector(bd0, bd2, 0, 1, 4, 5),
        __builtin_shufflevector(ac0, ac2, 2, 3, 6, 7),
        __builtin_shufflevector(bd0, bd2, 2, 3, 6, 7),
    } };
}

static inline simd_quad simd_quad_load(const double *table, const uint32_t *at)
{
    return simd_quad_turned(simd_row_load(table + at[0]), simd_row_load(table + at[1]),
                            simd_row_load(table + at[2]), simd_row_load(table + at[3]));
}

static inline void simd_quad_scatter(double *table, const uint32_t *at, const simd_quad *quad)
{
    const simd *c = quad->column;
    simd_quad turned = simd_quad_turned(c[0], c[1], c[2], c[3]);

    for (int k = 0; k < SIMD_LANES; k++)
        simd_row_store(table + at[k], turned.column[k]);
}

#else

static inline simd_quad simd_quad_load(const double *table, const uint32_t *at)
{
    simd_quad quad;

    for (int half = 0; half < 2; half++) {
        simd r0 = simd_load(table + at[0] + half * SIMD_LANES);
        simd r1 = simd_load(table + at[1] + half * SIMD_LANES);
        quad.column[2 * half] = (simd){ r0[0], r1[0] };
        quad.column[2 * half + 1] = (simd){ r0[1], r1[1] };
    }
    return quad;
}

static inline void simd_quad_scatter(double *table, const uint32_t *at, const simd_quad *quad)
{
    for (int half = 0; half < 2; half++) {
        simd a = quad->column[2 * half], b = quad->column[2 * half + 1];
        simd_store(table + at[0] + half * SIMD_LANES, (simd){ a[0], b[0] });
        simd_store(table + at[1] + half * SIMD_LANES, (simd){ a[1], b[1] });
    }
}

#endif

/// Write columns 0 to 3 of SIMD_LANES rows of a length, doubles, that follow one another.
static inline void simd_quad_store(double *rows, size_t length, const simd_quad *quad)
{
    uint32_t at[SIMD_LANES];

    for (uint32_t k = 0; k < SIMD_LANES; k++)
        at[k] = k * (uint32_t)length;
    simd_quad_scatter(rows, at, quad);
}

/// Write one column of SIMD_LANES rows that follow one another; rows begins at that column.
static inline void simd_column_store(double *rows, simd x)
{
    for (int k = 0; k < SIMD_LANES; k++)
        rows[k * SIMD_ROW] = x[k];
}
