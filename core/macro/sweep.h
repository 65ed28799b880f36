/// What the sweeps of all schemes have in common: the flux of a run of faces, the marks of saturated blocks, and
/// the work of a row. For the files that are compiled once per instruction set (core/CMakeLists.txt).

#pragma once

#include "core/macro/flux.h"
#include "core/macro/macro_priv.h"
#include "core/macro/skip.h"
#include "core/macro/tracers.h"

#include <math.h>

/// flux += I rho H(rho - 1) with the smooth H and rho of the upwind side; ranges as in flux.h.
static inline void sweep_flux_smooth(const double *dispersion, double width, const double *left,
                                     const double *right, ptrdiff_t b_min, ptrdiff_t b_max,
                                     double *flux)
{
    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i++) {
        double rho = dispersion[i] >= 0.0 ? left[i] : right[i];
        double h_rho = rho * (0.5 + atan((rho - 1.0) / width) / M_PI);
        flux[i] += dispersion[i] * h_rho;
    }
}

/// The flux through the faces of the blocks of range between left and right, the densities before and after each
/// face: the static one everywhere, the dynamic one in the blocks of active.
static inline void sweep_flux(const macro_solver *s, const double *v, const double *dispersion,
                              const double *left, const double *right, block_span range,
                              const uint64_t *active, double *flux)
{
    ptrdiff_t b = range.first, done = range.first;
    block_span run;

    while (done < range.last) {
        if (!block_set_next_run(active, macro__words(s), &b, &run) || run.first > range.last)
            run = (block_span){ range.last, range.last };
        run.last = run.last < range.last ? run.last : range.last;
        flux_upwind(v, left, right, done, run.first, flux);
        if (s->def.heaviside == SCENE_HEAVISIDE_SHARP) {
            flux_upwind_sharp(v, dispersion, left, right, run.first, run.last, flux);
        } else {
            flux_upwind(v, left, right, run.first, run.last, flux);
            if (s->def.heaviside == SCENE_HEAVISIDE_SMOOTH)
                sweep_flux_smooth(dispersion, s->def.heaviside_width, left, right, run.first,
                                  run.last, flux);
            else
                flux_upwind_add(dispersion, left, right, run.first, run.last, flux);
        }
        done = run.last;
    }
}

/// Mark the blocks of a range in two sets (active_blocks.h): those with a cell rho >= 1, and those whose first cell is
/// one. Other blocks of the sets stay as they are.
static inline void sweep_mark(const double *rho, ptrdiff_t b_min, ptrdiff_t b_max,
                              uint64_t *saturated, uint64_t *saturated_first)
{
    for (ptrdiff_t low = b_min, high; low < b_max; low = high) {
        block_marks m = block_marks_from(low);
        high = block_set_end_of_word(low, b_max);
        for (ptrdiff_t b = low; b < high; b++) {
            unsigned saturated_cells = 0;
            for (int k = 0; k < BLOCK_CELLS; k += SIMD_LANES)
                saturated_cells |= simd_bits_from_1(simd_load(rho + b * BLOCK_CELLS + k)) << k;
            m = block_marks_add(m, saturated_cells);
        }
        block_marks_put(m, low, high, saturated, saturated_first);
    }
}

/// Make I of row r in these blocks, if there are any.
static inline void sweep_make_dispersion(macro_band *band, ptrdiff_t r, const uint64_t *blocks)
{
    uint64_t any = 0;

    for (size_t w = 0; w < macro__words(band->solver); w++)
        any |= band->wanted[w] = blocks[w];
    if (any != 0)
        macro__dispersion_make(band, r);
}

/// Estimated work of a row whose I is made in these blocks, in blocks that are swept.
static inline double sweep_row_cost(const macro_solver *s, const uint64_t *dispersion)
{
    const double cost_of_dispersion = 8.0; // I of a block

    return 1.0 + (double)s->n_blocks +
           cost_of_dispersion * block_set_count(dispersion, macro__words(s));
}

/// Record the velocities of cargo across the x1-faces of a row of the band.
static inline void sweep_record_x1(const macro_band *band, ptrdiff_t r, const double *left,
                                   const double *right)
{
    const macro_solver *s = band->solver;
    const cargo_velocity_fluxes of = { band->flux1, left, right, band->active_faces };

    if (s->records && r >= band->first && r < band->last)
        cargo_velocity_put(s, &s->faces1, &of, r, s->tracers->record.u1);
}

/// The same of the x2-faces south of row r, whose dynamic fluxes are in the blocks band->wanted; the last ones of a band are
/// those of the next one.
static inline void sweep_record_x2(const macro_band *band, ptrdiff_t r, const double *left,
                                   const double *right)
{
    const macro_solver *s = band->solver;
    const cargo_velocity_fluxes of = { band->flux2[r & 1], left, right, band->wanted };

    if (s->records && (r < band->last || r == s->n2))
        cargo_velocity_put(s, &s->faces2, &of, r, s->tracers->record.u2);
}
