/// The convolution (15)-(16) and the dispersion velocity I of (10), row by row.
///
///     G1_i = sum_p gradient1_p rho_{i-p},   J1_i = sum_p integral1_p rho_{i-p}        along x1, one row
///     D1 = sum_q integral2_q G1_{j-q},      D2 = sum_q gradient2_q J1_{j-q}           along x2
///     I1 = D1 s,  I2 = D2 s,  s = -eps / sqrt(1 + D1^2 + D2^2)
///
/// For the files that are compiled once per instruction set (core/CMakeLists.txt), so that the loops are
/// inlined there with the registers of that set; all builds give the same bits (core/base/simd.h). A row pointer
/// is the address of its cell 0, aligned to 64 bytes; rows have room on both sides (macro_priv.h). Block b
/// is cells 8 b .. 8 b + 7 and, for faces, the faces i + 1/2 east (or north) of those cells; b may be -1.
/// Ranges are b_min <= b < b_max.

#pragma once

#include "core/base/simd.h"
#include "core/macro/active_blocks.h"
#include "core/macro/mollifier.h"

#include <stddef.h>

enum { CONVOLUTION_UNROLL = 4 }; ///< registers that are updated per load of a weight

/// The sums of n neighbouring registers; a constant n unrolls.
static inline __attribute__((always_inline)) void convolve_registers(
    const double *rho, const mollifier *m, ptrdiff_t i, int n, double *gradient1, double *integral1)
{
    const double *first = rho + i - m->reach;
    simd gradient[CONVOLUTION_UNROLL], integral[CONVOLUTION_UNROLL];

    for (int k = 0; k < n; k++)
        gradient[k] = integral[k] = simd_all(0.0);
    for (int tap = 0; tap <= 2 * m->reach; tap++) {
        simd gradient_weight = simd_all(m->gradient[tap]);
        simd integral_weight = simd_all(m->integral[tap]);
        for (int k = 0; k < n; k++) {
            simd x = simd_held(simd_load_any(first + tap + k * SIMD_LANES));
            gradient[k] += gradient_weight * x;
            integral[k] += integral_weight * x;
        }
    }
    for (int k = 0; k < n; k++) {
        simd_store(gradient1 + i + k * SIMD_LANES, gradient[k]);
        simd_store(integral1 + i + k * SIMD_LANES, integral[k]);
    }
}

/// gradient1_i = sum_p gradient_p rho_{i-p}, integral1_i = sum_p integral_p rho_{i-p}: the part of D1 and D2
/// along x1, for one row.
static inline void convolution_along_x1(const double *rho, const mollifier *m, ptrdiff_t b_min,
                                        ptrdiff_t b_max, double *gradient1, double *integral1)
{
    ptrdiff_t i = b_min * BLOCK_CELLS;

    for (; i + CONVOLUTION_UNROLL * SIMD_LANES <= b_max * BLOCK_CELLS;
         i += CONVOLUTION_UNROLL * SIMD_LANES)
        convolve_registers(rho, m, i, CONVOLUTION_UNROLL, gradient1, integral1);
    for (; i < b_max * BLOCK_CELLS; i += SIMD_LANES)
        convolve_registers(rho, m, i, 1, gradient1, integral1);
}

static inline __attribute__((always_inline)) void dispersion_registers(
    const double *const *gradient1, const double *const *integral1, const mollifier *m,
    double dispersion, ptrdiff_t i, int n, double *velocity1, double *velocity2)
{
    simd d1[CONVOLUTION_UNROLL], d2[CONVOLUTION_UNROLL];

    for (int k = 0; k < n; k++)
        d1[k] = d2[k] = simd_all(0.0);
    for (int tap = 0; tap <= 2 * m->reach; tap++) {
        simd integral_weight = simd_all(m->integral[tap]);
        simd gradient_weight = simd_all(m->gradient[tap]);
        const double *gradient_row = gradient1[tap] + i;
        const double *integral_row = integral1[tap] + i;
        for (int k = 0; k < n; k++) {
            d1[k] += integral_weight * simd_load(gradient_row + k * SIMD_LANES);
            d2[k] += gradient_weight * simd_load(integral_row + k * SIMD_LANES);
        }
    }
    for (int k = 0; k < n; k++) {
        simd scale = -dispersion / simd_sqrt(1.0 + d1[k] * d1[k] + d2[k] * d2[k]);
        simd_store(velocity1 + i + k * SIMD_LANES, d1[k] * scale);
        simd_store(velocity2 + i + k * SIMD_LANES, d2[k] * scale);
    }
}

/// The part along x2, and the dispersion velocity I of (10):
///     D1 = sum_m integral_m gradient1[m],  D2 = sum_m gradient_m integral1[m]
///     I1 = D1 s,  I2 = D2 s,  s = -dispersion / sqrt(1 + D1^2 + D2^2)
/// gradient1[m] and integral1[m] are the rows j - S + m.
static inline void convolution_dispersion_velocity(const double *const *gradient1,
                                                   const double *const *integral1,
                                                   const mollifier *m, double dispersion,
                                                   ptrdiff_t b_min, ptrdiff_t b_max,
                                                   double *velocity1, double *velocity2)
{
    ptrdiff_t i = b_min * BLOCK_CELLS;

    for (; i + CONVOLUTION_UNROLL * SIMD_LANES <= b_max * BLOCK_CELLS;
         i += CONVOLUTION_UNROLL * SIMD_LANES)
        dispersion_registers(gradient1, integral1, m, dispersion, i, CONVOLUTION_UNROLL, velocity1,
                             velocity2);
    for (; i < b_max * BLOCK_CELLS; i += SIMD_LANES)
        dispersion_registers(gradient1, integral1, m, dispersion, i, 1, velocity1, velocity2);
}
