/// The reconstruction of the MUSCL scheme (van Leer 1979), row by row: in each cell the density is linear along an
/// axis, with the slope limited by the generalised minmod function,
///
///     s_i = minmod( theta (rho_i - rho_{i-1}), (rho_{i+1} - rho_{i-1})/2, theta (rho_{i+1} - rho_i) ),  theta = 3/2
///     low_i = rho_i - s_i/2,   high_i = rho_i + s_i/2
///
/// where minmod is the argument of smallest size if all have one sign, else 0. The flux through face i + 1/2 is then
/// the upwind flux (flux.h) of high_i and low_{i+1}. If no density is negative,
///
///     low_i, high_i >= (1 - theta/2) rho_i,   low_i + high_i = 2 rho_i
///
/// so no state is negative and nothing flows out of an empty cell; core/macro/README.md has the bounds on the step that
/// follow. As theta <= 2, a state lies between the densities of the two cells at its face: it is saturated only if one
/// of them is.
///
/// States depend on the density alone, whatever carries it. `open` is a factor of the slope of each cell, 0 or 1: 0
/// beside closed faces, so that no cell sees what is behind them.
///
/// For the files that are compiled once per instruction set; rows, blocks and ranges as in flux.h.

#pragma once

#include "core/base/simd_compare.h"
#include "core/base/simd_shift.h"
#include "core/macro/active_blocks.h"

#include <stddef.h>

enum { MUSCL_STAGES = 2 }; ///< of a step: Heun's method, SSP-RK2

#define MUSCL_THETA 1.5 ///< 1: minmod, the most diffusive; 2: the steepest that creates no extrema

/// s_i/2 from theta/2 times the differences to the cells before and after.
static inline simd muscl_half_slope(simd backward, simd forward)
{
    simd central = 0.5 / MUSCL_THETA * (backward + forward);
    simd upper = simd_positive(simd_min(backward, forward));
    simd lower = simd_negative(simd_max(backward, forward));

    // One of the bounds is 0, or both where the differences have two signs.
    return simd_min(simd_max(central, lower), upper);
}

/// A register of cells on its way along a row. Neighbours come from registers: loads that straddle what was stored
/// just before would wait for it.
typedef struct muscl_cells {
    simd rho;     ///< their densities
    simd next;    ///< those of the following register
    simd forward; ///< theta/2 times the differences to the cells behind
    simd half;    ///< s_i/2
} muscl_cells;

/// Advance by a register; next is the one after it.
static inline muscl_cells muscl_advance(muscl_cells cells, simd next)
{
    simd forward = 0.5 * MUSCL_THETA * (simd_shift_down(cells.next, next) - cells.next);
    simd half = muscl_half_slope(simd_shift_up(cells.forward, forward), forward);

    return (muscl_cells){ cells.next, next, forward, half };
}

/// Before the register at rho, which muscl_advance() makes; half is not known yet.
static inline muscl_cells muscl_before(const double *rho)
{
    simd here = simd_load(rho - SIMD_LANES), next = simd_load(rho);
    simd forward = 0.5 * MUSCL_THETA * (simd_shift_down(here, next) - here);

    return (muscl_cells){ here, next, forward, simd_all(0.0) };
}

/// The states on both sides of the x1-faces of a row of cells: left_i = high_i, right_i = low_{i+1}.
static inline void muscl_states_x1(const double *rho, const double *open, ptrdiff_t b_min,
                                   ptrdiff_t b_max, double *left, double *right)
{
    const ptrdiff_t end = b_max * BLOCK_CELLS;
    ptrdiff_t i = b_min * BLOCK_CELLS;
    muscl_cells cells = muscl_advance(muscl_before(rho + i), simd_load(rho + i + SIMD_LANES));
    simd half = cells.half * simd_load(open + i), low = cells.rho - half;

    for (; i < end; i += SIMD_LANES) {
        simd_store(left + i, cells.rho + half);
        // Of the cells from the end on the first one alone is read.
        ptrdiff_t next = i + SIMD_LANES < end ? i + 2 * SIMD_LANES : end;
        cells = muscl_advance(cells, simd_load(rho + next));
        half = cells.half * simd_load(open + i + SIMD_LANES);
        simd_store(right + i, simd_shift_down(low, cells.rho - half));
        low = cells.rho - half;
    }
}

/// The states of a row of cells at their x2-faces, low south and high north, from the rows of cells on both sides.
static inline void muscl_states_x2(const double *south, const double *rho, const double *north,
                                   const double *open, ptrdiff_t b_min, ptrdiff_t b_max,
                                   double *low, double *high)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += SIMD_LANES) {
        simd here = simd_load(rho + i);
        simd backward = 0.5 * MUSCL_THETA * (here - simd_load(south + i));
        simd forward = 0.5 * MUSCL_THETA * (simd_load(north + i) - here);
        simd half = muscl_half_slope(backward, forward) * simd_load(open + i);
        simd_store(low + i, here - half);
        simd_store(high + i, here + half);
    }
}
