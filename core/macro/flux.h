/// The fluxes through a row of faces, upwinded (section 4.2): static and dynamic flux each by itself.
///
///     static   v >= 0 ? rho_i v : rho_{i+1} v
///     dynamic  I >= 0 ? rho_i H(rho_i - 1) I : rho_{i+1} H(rho_{i+1} - 1) I
///
/// For the files that are compiled once per instruction set (core/CMakeLists.txt), so that the loops are
/// inlined there with the registers of that set; all builds give the same bits (core/base/simd.h). A row pointer
/// is the address of its cell 0, aligned to 64 bytes; rows have room on both sides (macro_priv.h). Block b
/// is cells 8 b .. 8 b + 7 and, for faces, the faces i + 1/2 east (or north) of those cells; b may be -1.
/// Ranges are b_min <= b < b_max.

#pragma once

#include "core/base/simd.h"
#include "core/macro/active_blocks.h"

#include <stddef.h>

/// One of the two products is zero, so their sum is the upwind flux to the bit.
static inline simd flux_upwind_one(simd v, simd left, simd right)
{
    return simd_positive(v) * left + simd_negative(v) * right;
}

/// flux = v >= 0 ? left v : right v, where left and right are the cells before and after the face.
static inline void flux_upwind(const double *v, const double *left, const double *right,
                               ptrdiff_t b_min, ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += SIMD_LANES)
        simd_store(flux + i, flux_upwind_one(simd_load(v + i), simd_load_any(left + i),
                                             simd_load_any(right + i)));
}

/// The same, added to flux.
static inline void flux_upwind_add(const double *v, const double *left, const double *right,
                                   ptrdiff_t b_min, ptrdiff_t b_max, double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += SIMD_LANES)
        simd_store(flux + i,
                   simd_load(flux + i) + flux_upwind_one(simd_load(v + i), simd_load_any(left + i),
                                                         simd_load_any(right + i)));
}

/// Static and dynamic flux with the sharp H: of v and rho, and of the dispersion velocity and H(rho - 1) rho.
static inline void flux_upwind_sharp(const double *v, const double *dispersion, const double *left,
                                     const double *right, ptrdiff_t b_min, ptrdiff_t b_max,
                                     double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += SIMD_LANES) {
        simd rho = simd_load_any(left + i), next = simd_load_any(right + i);
        simd_store(flux + i, flux_upwind_one(simd_load(v + i), rho, next) +
                                 flux_upwind_one(simd_load(dispersion + i), simd_from_1(rho),
                                                 simd_from_1(next)));
    }
}
