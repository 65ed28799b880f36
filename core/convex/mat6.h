/// Symmetric, positive definite systems of six equations, one in each lane (core/base/simd.h), for the inner loops of
/// contacts in space.
///
/// Of a matrix only the lower triangle is read and written. All loops but that of squares are unrolled, which
/// makes an implicit step of boxes a tenth shorter.

#pragma once

#include "core/base/simd.h"

/// Symmetric matrices by its rows.
typedef struct mat6 {
    simd row[6][6]; ///< row[i][j] for j <= i; the others are unused
} mat6;

/// m = 0.
static inline void mat6_clear(mat6 *m)
{
#pragma GCC unroll 6
    for (int i = 0; i < 6; i++)
#pragma GCC unroll 6
        for (int j = 0; j <= i; j++)
            m->row[i][j] = simd_all(0.0);
}

/// m += weight a a^T.
static inline void mat6_add_square(mat6 *m, simd weight, const simd a[6])
{
    for (int i = 0; i < 6; i++)
        for (int j = 0; j <= i; j++)
            m->row[i][j] += weight * a[i] * a[j];
}

/// ret_b = m a.
static inline void mat6_apply(const mat6 *m, const simd a[6], simd ret_b[6])
{
#pragma GCC unroll 6
    for (int i = 0; i < 6; i++) {
        simd sum = simd_all(0.0);
#pragma GCC unroll 6
        for (int j = 0; j < 6; j++)
            sum += (j <= i ? m->row[i][j] : m->row[j][i]) * a[j];
        ret_b[i] = sum;
    }
}

/// Make m = L D L^T its factors: L below the diagonal, whose own is 1, and 1/D on it.
static inline void mat6_factor(mat6 *m)
{
#pragma GCC unroll 6
    for (int i = 0; i < 6; i++) {
        simd scaled[6], pivot = m->row[i][i];
#pragma GCC unroll 6
        for (int j = 0; j < i; j++) {
            scaled[j] = m->row[i][j];
#pragma GCC unroll 6
            for (int k = 0; k < j; k++)
                scaled[j] -= scaled[k] * m->row[j][k];
        }
#pragma GCC unroll 6
        for (int j = 0; j < i; j++) {
            m->row[i][j] = scaled[j] * m->row[j][j];
            pivot -= scaled[j] * m->row[i][j];
        }
        m->row[i][i] = 1.0 / pivot;
    }
}

/// Solve m x = b, in place, with the factors of m.
static inline void mat6_solve(const mat6 *factors, simd b[6])
{
#pragma GCC unroll 6
    for (int i = 1; i < 6; i++)
#pragma GCC unroll 6
        for (int j = 0; j < i; j++)
            b[i] -= factors->row[i][j] * b[j];
#pragma GCC unroll 6
    for (int i = 0; i < 6; i++)
        b[i] *= factors->row[i][i];
#pragma GCC unroll 6
    for (int i = 4; i >= 0; i--)
#pragma GCC unroll 6
        for (int j = i + 1; j < 6; j++)
            b[i] -= factors->row[j][i] * b[j];
}

/// The inverse of a matrix, by its factors.
static inline void mat6_invert(const mat6 *factors, mat6 *ret_inverse)
{
#pragma GCC unroll 6
    for (int j = 0; j < 6; j++) {
        simd unit[6] = { 0 };
        unit[j] = simd_all(1.0);
        mat6_solve(factors, unit);
#pragma GCC unroll 6
        for (int i = j; i < 6; i++)
            ret_inverse->row[i][j] = unit[i];
    }
}
