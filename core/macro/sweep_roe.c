// One step of a band of rows by the scheme of section 4.2 (SCENE_SCHEME_ROE),
//
//     rho <- rho - lambda (F+ - F-)        along x1, then along x2 with the same velocities,
//
// with the fluxes of flux.h and the dispersion velocity of convolution.c. Rows come in rising order: the x1
// sweep of row r, the flux between rows r - 1 and r, then the x2 sweep of row r - 1. skip.h finds the terms
// that are exactly zero and skipped.

#include "core/macro/skip.h"
#include "core/macro/sweep.h"

#include <string.h>

// out = rho - lambda (after - before): fluxes through the faces after and before each cell; out may be
// rho. Marks the blocks of the range in two sets (active_blocks.h): those with a new density >= 1, and
// those whose first cell has one. Other blocks of the sets stay as they are.
static void update(const double *rho, double lambda, const double *after, const double *before,
                   ptrdiff_t b_min, ptrdiff_t b_max, double *out, uint64_t *saturated,
                   uint64_t *saturated_first)
{
    for (ptrdiff_t low = b_min, high; low < b_max; low = high) {
        block_marks m = block_marks_from(low);
        high = block_set_end_of_word(low, b_max);
        for (ptrdiff_t b = low; b < high; b++) {
            unsigned saturated_cells = 0;
            for (int k = 0; k < BLOCK_CELLS; k += SIMD_LANES) {
                ptrdiff_t i = b * BLOCK_CELLS + k;
                simd flux = simd_load_any(after + i) - simd_load_any(before + i);
                simd updated = simd_load(rho + i) - lambda * flux;
                saturated_cells |= simd_bits_from_1(updated) << k;
                simd_store(out + i, updated);
            }
            m = block_marks_add(m, saturated_cells);
        }
        block_marks_put(m, low, high, saturated, saturated_first);
    }
}

// update() along x1 with the fluxes v rho of one velocity v >= 0, in one pass. The sets must not hold
// blocks of the range before.
static void update_uniform(const double *rho, double lambda, double v, ptrdiff_t b_min,
                           ptrdiff_t b_max, double *out, uint64_t *saturated,
                           uint64_t *saturated_first)
{
    simd largest = simd_all(0.0);

    for (ptrdiff_t i = b_min * BLOCK_CELLS; i < b_max * BLOCK_CELLS; i += SIMD_LANES) {
        simd here = simd_load(rho + i);
        simd updated = here - lambda * (v * here - v * simd_load_any(rho + i - 1));
        largest = simd_max(updated, largest);
        simd_store(out + i, updated);
    }
    // Transported cargo seldom becomes saturated, so cells are tested one by one only in blocks where one did.
    if (simd_bits_from_1(largest) != 0)
        sweep_mark(out, b_min, b_max, saturated, saturated_first);
}

// The x1 sweep of row r of `now`, over the span of after_x1.
static void sweep_row_x1(macro_band *band, ptrdiff_t r, macro_row_after_x1 *after_x1, double *out)
{
    const macro_solver *s = band->solver;
    const double *rho = macro__row(s, s->now.rho, r);
    ptrdiff_t b = -1, done = after_x1->span.first;
    block_span run;

    skip_find_special(band, r, after_x1->span);
    while (done < after_x1->span.last) {
        if (!block_set_next_run(band->special, macro__words(s), &b, &run))
            run = (block_span){ after_x1->span.last, after_x1->span.last };
        if (done < run.first)
            update_uniform(rho, s->lambda1, s->uniform1, done, run.first, out, after_x1->active,
                           after_x1->active_first);
        if (run.first < run.last) {
            sweep_flux(s, macro__row(s, s->faces1.v, r), band->dispersion[r & 1].i1, rho, rho + 1,
                       (block_span){ run.first - 1, run.last }, band->active_faces, band->flux1);
            update(rho, s->lambda1, band->flux1, band->flux1 - 1, run.first, run.last, out,
                   after_x1->active, after_x1->active_first);
        }
        done = run.last;
    }
    skip_mark_active(s, after_x1->span, after_x1->active, after_x1->active_first);
    sweep_record_x1(band, r, rho, rho + 1);
}

// Makes I of row r where its x1 sweep needs it, and where its x2 flux probably will.
static void prepare_dispersion(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const uint64_t *expected = macro__set(s, band->expected, r);

    skip_find_active_faces(band, r);
    sweep_make_dispersion(band, r, expected);
    if (r >= band->first && r < band->last)
        s->cost[r] = sweep_row_cost(s, expected);
}

// The output of the x1 sweep of row r: `next` inside the band, separate storage for the rows next to it.
static double *begin_after_x1(macro_band *band, ptrdiff_t r, macro_row_after_x1 *after_x1)
{
    const macro_solver *s = band->solver;
    const int side = r < band->first ? 0 : 1;
    double *out = band->outside[side];

    after_x1->active = band->outside_active[side];
    after_x1->active_first = band->outside_first[side];
    if (r >= band->first && r < band->last) {
        out = macro__row(s, s->next.rho, r);
        after_x1->active = macro__set(s, s->next.active, r);
        after_x1->active_first = macro__set(s, s->next.active_first, r);
    } else {
        memset(out - s->margin, 0, (size_t)s->stride * sizeof *out);
    }
    block_set_clear(after_x1->active, macro__words(s));
    block_set_clear(after_x1->active_first, macro__words(s));
    return out;
}

// Sweeps row r along x1; outside the grid there is nothing.
static void sweep_x1(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    macro_row_after_x1 *after_x1 = &band->after_x1[r & 1];

    if (r < 0 || r >= s->n2) {
        const double *nothing = s->zero_row + s->margin;
        *after_x1 = (macro_row_after_x1){ nothing, band->empty, band->empty, { 0, 0 } };
        return;
    }
    double *out = begin_after_x1(band, r, after_x1);
    after_x1->rho = out;
    after_x1->span = skip_grow_span(s, s->now.span[r], macro__row(s, s->now.rho, r));
    prepare_dispersion(band, r);
    sweep_row_x1(band, r, after_x1, out);
}

// The x2 sweep of row r, in place, with the fluxes on both its sides.
static void finish_row(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const macro_row_after_x1 *after_x1 = &band->after_x1[r & 1];
    const uint64_t *south = band->flux2_set[r & 1], *north = band->flux2_set[(r + 1) & 1];
    double *rho = macro__row(s, s->next.rho, r);
    block_span span = after_x1->span, run;
    ptrdiff_t b = -1;

    for (size_t w = 0; w < macro__words(s); w++)
        band->todo[w] = south[w] | north[w];
    while (block_set_next_run(band->todo, macro__words(s), &b, &run)) {
        update(rho, s->lambda2, band->flux2[(r + 1) & 1], band->flux2[r & 1], run.first, run.last,
               rho, after_x1->active, after_x1->active_first);
        skip_mark_active(s, run, after_x1->active, after_x1->active_first);
        span = block_span_hull(span, run);
    }
    macro__fill_margins(s, rho);
    s->next.span[r] = span;
}

void macro__sweep_roe(macro_band *band)
{
    macro__dispersion_begin(band);
    sweep_x1(band, band->first - 1);
    for (ptrdiff_t r = band->first; r <= band->last; r++) {
        sweep_x1(band, r);
        // The flux through the faces between rows r - 1 and r after their x1 sweeps.
        const macro_solver *s = band->solver;
        ptrdiff_t b = -1;
        block_span run;
        skip_find_flux_x2(band, r);
        sweep_make_dispersion(band, r - 1, band->wanted);
        while (block_set_next_run(band->flux2_set[r & 1], macro__words(s), &b, &run))
            sweep_flux(s, macro__row(s, s->faces2.v, r), band->dispersion[(r - 1) & 1].i2,
                       band->after_x1[(r - 1) & 1].rho, band->after_x1[r & 1].rho, run,
                       band->wanted, band->flux2[r & 1]);
        sweep_record_x2(band, r, band->after_x1[(r - 1) & 1].rho, band->after_x1[r & 1].rho);
        if (r > band->first)
            finish_row(band, r - 1);
    }
}
