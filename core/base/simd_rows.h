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

/// A quad of one row, in a register; + and - act column by column.
typedef double simd_row_quad __attribute__((vector_size(SIMD_QUAD * sizeof(double))));

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

/// a + b, and a - b, column by column.
static inline simd_row_quad simd_row_sum(simd_row_quad a, simd_row_quad b)
{
    return a + b;
}

static inline simd_row_quad simd_row_difference(simd_row_quad a, simd_row_quad b)
{
    return a - b;
}

/// -a, -b, d, c of a row a, b, c, d.
static inline simd_row_quad simd_row_opposite(simd_row_quad x)
{
    return __builtin_shufflevector(x, x, 0, 1, 3, 2) * (simd_row_quad){ -1.0, -1.0, 1.0, 1.0 };
}

#else

/// A quad of one row, as two registers.
typedef struct simd_row_quad {
    simd low;  ///< columns 0 and 1
    simd high; ///< columns 2 and 3
} simd_row_quad;

static inline simd_row_quad simd_row_load(const double *at)
{
    return (simd_row_quad){ simd_load(at), simd_load(at + SIMD_LANES) };
}

static inline void simd_row_store(double *at, simd_row_quad x)
{
    simd_store(at, x.low);
    simd_store(at + SIMD_LANES, x.high);
}

static inline simd_row_quad simd_row_sum(simd_row_quad a, simd_row_quad b)
{
    return (simd_row_quad){ a.low + b.low, a.high + b.high };
}

static inline simd_row_quad simd_row_difference(simd_row_quad a, simd_row_quad b)
{
    return (simd_row_quad){ a.low - b.low, a.high - b.high };
}

static inline simd_row_quad simd_row_opposite(simd_row_quad x)
{
    return (simd_row_quad){ -x.low, { x.high[1], x.high[0] } };
}

#endif

#if defined(__AVX512F__)

/// Quads of two rows in one register.
static inline simd simd_join(simd_row_quad low, simd_row_quad high)
{
    return (simd)_mm512_insertf64x4(_mm512_castpd256_pd512((__m256d)low), (__m256d)high, 1);
}

/// The columns of SIMD_LANES quads.
static inline simd_quad simd_quad_of(const simd_row_quad *row)
{
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

/// The quads of SIMD_LANES rows, from their columns.
static inline void simd_quad_rows(const simd_quad *quad, simd_row_quad *ret_row)
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
        simd_row_quad *row = ret_row + k / 2 * 4 + k % 2;
        row[0] = __builtin_shufflevector(pair[k], pair[k], 0, 1, 2, 3);
        row[2] = __builtin_shufflevector(pair[k], pair[k], 4, 5, 6, 7);
    }
}

#elif defined(__AVX2__)

static inline simd_quad simd_quad_of(const simd_row_quad *row)
{
    simd ac0 = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
    simd bd0 = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
    simd ac2 = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
    simd bd2 = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
    return (simd_quad){ {
        __builtin_shufflevector(ac0, ac2, 0, 1, 4, 5),
        __builtin_shufflevector(bd0, bd2, 0, 1, 4, 5),
        __builtin_shufflevector(ac0, ac2, 2, 3, 6, 7),
        __builtin_shufflevector(bd0, bd2, 2, 3, 6, 7),
    } };
}

static inline void simd_quad_rows(const simd_quad *quad, simd_row_quad *ret_row)
{
    simd_quad turned = simd_quad_of(quad->column);

    for (int k = 0; k < SIMD_LANES; k++)
        ret_row[k] = turned.column[k];
}

#else

static inline simd_quad simd_quad_of(const simd_row_quad *row)
{
    return (simd_quad){ {
        { row[0].low[0], row[1].low[0] },
        { row[0].low[1], row[1].low[1] },
        { row[0].high[0], row[1].high[0] },
        { row[0].high[1], row[1].high[1] },
    } };
}

static inline void simd_quad_rows(const simd_quad *quad, simd_row_quad *ret_row)
{
    const simd *c = quad->column;

    for (int k = 0; k < SIMD_LANES; k++)
        ret_row[k] = (simd_row_quad){ { c[0][k], c[1][k] }, { c[2][k], c[3][k] } };
}

#endif

/// Columns 0 to 3 of a table's rows, or 4 to 7 of a table that begins at column 4 of the first row.
static inline simd_quad simd_quad_load(const double *table, const uint32_t *at)
{
    simd_row_quad row[SIMD_LANES];

    for (int k = 0; k < SIMD_LANES; k++)
        row[k] = simd_row_load(table + at[k]);
    return simd_quad_of(row);
}

/// The same of the sums, and of the differences a - b, of two rows each: half as much to transpose.
static inline simd_quad simd_quad_sum(const double *table, const uint32_t *a, const uint32_t *b)
{
    simd_row_quad row[SIMD_LANES];

    for (int k = 0; k < SIMD_LANES; k++)
        row[k] = simd_row_sum(simd_row_load(table + a[k]), simd_row_load(table + b[k]));
    return simd_quad_of(row);
}

static inline simd_quad simd_quad_difference(const double *table, const uint32_t *a,
                                             const uint32_t *b)
{
    simd_row_quad row[SIMD_LANES];

    for (int k = 0; k < SIMD_LANES; k++)
        row[k] = simd_row_difference(simd_row_load(table + a[k]), simd_row_load(table + b[k]));
    return simd_quad_of(row);
}

/// Write columns 0 to 3 of a table's rows; a row that occurs twice must have the same values.
static inline void simd_quad_scatter(double *table, const uint32_t *at, const simd_quad *quad)
{
    simd_row_quad row[SIMD_LANES];

    simd_quad_rows(quad, row);
    for (int k = 0; k < SIMD_LANES; k++)
        simd_row_store(table + at[k], row[k]);
}

/// Write columns 0 to 3 of SIMD_LANES rows of a length, doubles, that follow one another.
static inline void simd_quad_store(double *rows, size_t length, const simd_quad *quad)
{
    simd_row_quad row[SIMD_LANES];

    simd_quad_rows(quad, row);
    for (int k = 0; k < SIMD_LANES; k++)
        simd_row_store(rows + (size_t)k * length, row[k]);
}

/// Write one column of SIMD_LANES rows that follow one another; rows begins at that column.
static inline void simd_column_store(double *rows, simd x)
{
    for (int k = 0; k < SIMD_LANES; k++)
        rows[k * SIMD_ROW] = x[k];
}
