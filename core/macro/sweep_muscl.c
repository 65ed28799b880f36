// A stage of a step of a band of rows by the MUSCL scheme (SCENE_SCHEME_MUSCL): with
//
//     L(rho) = -(F1+ - F1-)/dx1 - (F2+ - F2-)/dx2
//
// and the upwind fluxes of flux.h at the states of muscl.h, a step is Heun's method in the form of Shu and Osher,
//
//     rho' = rho + dt L(rho)                       stage 0
//     rho  = rho/2 + (rho' + dt L(rho'))/2         stage 1
//
// The field I in L is that of the stage's density. A stage reads `now` and writes `next`, where stage 1 finds the density
// at the beginning of the step. Rows come in rising order: the update of row r along x1, the flux between rows r and
// r + 1, then the update of row r along x2. skip.h finds the terms that are exactly zero and skipped; on the free belt
// states, fluxes and update are one pass, with the same bits.

#include "core/base/subnormals.h"
#include "core/macro/muscl.h"
#include "core/macro/skip.h"
#include "core/macro/sweep.h"

#include <string.h>

// What a stage makes of a row.
typedef struct row_update {
    double *rho;          // the row of `next`
    bool is_mean;         // stage 1: the mean of what is there and the result
    block_span saturated; // where a result >= 1 may be
} row_update;

// rho - lambda (after - before) from the fluxes through the faces after and before each cell; with is_mean the mean of
// out and this. Returns the larger of largest and the result.
static inline simd update(simd rho, double lambda, simd after, simd before, bool is_mean,
                          double *out, simd largest)
{
    simd updated = rho - lambda * (after - before);

    if (is_mean)
        updated = 0.5 * (simd_load(out) + updated);
    simd_store(out, updated);
    return simd_max(updated, largest);
}

// Transported cargo seldom becomes saturated, so cells are tested one by one only where one of a run did.
static void note_largest(row_update *out, block_span run, simd largest)
{
    if (simd_bits_from_1(largest) != 0)
        out->saturated = block_span_hull(out->saturated, run);
}

// The update of a run of blocks along x1 with a row of fluxes.
static void update_x1(const double *rho, double lambda, const double *flux, block_span run,
                      row_update *out)
{
    simd before = simd_load(flux + run.first * BLOCK_CELLS - SIMD_LANES), largest = simd_all(0.0);

    for (ptrdiff_t i = run.first * BLOCK_CELLS; i < run.last * BLOCK_CELLS; i += SIMD_LANES) {
        simd after = simd_load(flux + i);
        largest = update(simd_load(rho + i), lambda, after, simd_shift_up(before, after),
                         out->is_mean, out->rho + i, largest);
        before = after;
    }
    note_largest(out, run, largest);
}

// The same with the fluxes v high of one velocity v >= 0, in one pass.
static void update_uniform(const double *rho, double lambda, double v, block_span run,
                           row_update *out)
{
    const double *first = rho + run.first * BLOCK_CELLS;
    muscl_cells cells = muscl_advance(muscl_before(first - SIMD_LANES), simd_load(first));
    simd before = v * (cells.rho + cells.half), largest = simd_all(0.0);

    for (ptrdiff_t i = run.first * BLOCK_CELLS; i < run.last * BLOCK_CELLS; i += SIMD_LANES) {
        cells = muscl_advance(cells, simd_load(rho + i + SIMD_LANES));
        simd after = v * (cells.rho + cells.half);
        largest = update(cells.rho, lambda, after, simd_shift_up(before, after), out->is_mean,
                         out->rho + i, largest);
        before = after;
    }
    note_largest(out, run, largest);
}

// The stage of row r along x1, whose density is in span before and after.
static void sweep_x1(macro_band *band, ptrdiff_t r, block_span span, row_update *out)
{
    const macro_solver *s = band->solver;
    const double *rho = macro__row(s, s->now.rho, r);
    ptrdiff_t b = -1;
    block_span run;

    skip_find_special(band, r, span);
    for (ptrdiff_t done = span.first; done < span.last; done = run.last) {
        if (!block_set_next_run(band->special, macro__words(s), &b, &run))
            run = (block_span){ span.last, span.last };
        if (done < run.first)
            update_uniform(rho, s->lambda1, s->uniform1, (block_span){ done, run.first }, out);
        if (run.first == run.last)
            break;
        const block_span faces = { run.first - 1, run.last };
        muscl_states_x1(rho, macro__row(s, s->open1, r), faces.first, faces.last,
                        band->states1.left, band->states1.right);
        sweep_flux(s, macro__row(s, s->faces1.v, r), band->dispersion[r & 1].i1, band->states1.left,
                   band->states1.right, faces, band->active_faces, band->flux1);
        update_x1(rho, s->lambda1, band->flux1, run, out);
    }
    sweep_record_x1(band, r, band->states1.left, band->states1.right);
}

// Blocks of the x2-faces south of row r whose dynamic flux may not be 0, in word w of a set.
static uint64_t dynamic_x2(const macro_band *band, ptrdiff_t r, size_t w)
{
    const macro_solver *s = band->solver;
    uint64_t south = r > 0 ? macro__set(s, s->now.active, r - 1)[w] : 0;
    uint64_t north = r < s->n2 ? macro__set(s, s->now.active, r)[w] : 0;

    return (south | north) & ~macro__set(s, s->faces2.closed_blocks, r)[w];
}

// Sets the blocks of the x2-faces south of row r whose flux may not be 0.
static void find_flux_x2(const macro_band *band, ptrdiff_t r, uint64_t *set)
{
    const macro_solver *s = band->solver;
    const block_span none = { 0, 0 };
    const uint64_t *mixed = macro__set(s, s->faces2.mixed, r);
    const uint64_t *closed_blocks = macro__set(s, s->faces2.closed_blocks, r);
    const block_span span =
        block_span_hull(r > 0 ? s->now.span[r - 1] : none, r < s->n2 ? s->now.span[r] : none);

    for (size_t w = 0; w < macro__words(s); w++)
        set[w] =
            dynamic_x2(band, r, w) | (mixed[w] & ~closed_blocks[w] & block_set_span_word(span, w));
}

// The states of row r at its x2-faces, in the blocks with a flux south or north of it. On entry band->ahead has those
// of the south, afterwards those of the north.
static void make_states_x2(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const double *nothing = s->zero_row + s->margin;
    double *low = band->states2[r & 1].right, *high = band->states2[r & 1].left;
    ptrdiff_t b = -1;
    block_span run;

    memcpy(band->todo, band->ahead, macro__words(s) * sizeof *band->todo);
    if (r < band->last)
        find_flux_x2(band, r + 1, band->ahead);
    if (r < 0 || r >= s->n2)
        return;
    const double *rho = macro__row(s, s->now.rho, r);
    for (size_t w = 0; r < band->last && w < macro__words(s); w++)
        band->todo[w] |= band->ahead[w];
    while (block_set_next_run(band->todo, macro__words(s), &b, &run))
        muscl_states_x2(r > 0 ? rho - s->stride : nothing, rho,
                        r + 1 < s->n2 ? rho + s->stride : nothing, macro__row(s, s->open2, r),
                        run.first, run.last, low, high);
}

// The flux through the faces south of row r. I there belongs to row r - 1, and is made except for the band's first row.
static void flux_x2(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const double *nothing = s->zero_row + s->margin;
    const double *left = r > 0 ? band->states2[(r - 1) & 1].left : nothing;
    const double *right = r < s->n2 ? band->states2[r & 1].right : nothing;
    ptrdiff_t b = -1;
    block_span run;

    skip_put_flux_x2(band, r, band->ahead);
    make_states_x2(band, r);
    for (size_t w = 0; w < macro__words(s); w++)
        band->wanted[w] = dynamic_x2(band, r, w);
    sweep_make_dispersion(band, r - 1, band->wanted);
    while (block_set_next_run(band->flux2_set[r & 1], macro__words(s), &b, &run))
        sweep_flux(s, macro__row(s, s->faces2.v, r), band->dispersion[(r - 1) & 1].i2, left, right,
                   run, band->wanted, band->flux2[r & 1]);
    sweep_record_x2(band, r, left, right);
}

// The stage of row r along x2, and what is known of the result. After x1 the density was in span.
static void finish_row(macro_band *band, ptrdiff_t r, block_span span, row_update *out)
{
    const macro_solver *s = band->solver;
    const double lambda = out->is_mean ? 0.5 * s->lambda2 : s->lambda2;
    uint64_t *active = macro__set(s, s->next.active, r);
    uint64_t *active_first = macro__set(s, s->next.active_first, r);
    ptrdiff_t b = -1;
    block_span run;

    for (size_t w = 0; w < macro__words(s); w++)
        band->todo[w] = band->flux2_set[r & 1][w] | band->flux2_set[(r + 1) & 1][w];
    while (block_set_next_run(band->todo, macro__words(s), &b, &run)) {
        // The update of a run along x2 of what the one along x1 has left, with the fluxes north and south of the row.
        const double *north = band->flux2[(r + 1) & 1], *south = band->flux2[r & 1];
        simd largest = simd_all(0.0);
        for (ptrdiff_t i = run.first * BLOCK_CELLS; i < run.last * BLOCK_CELLS; i += SIMD_LANES)
            largest = update(simd_load(out->rho + i), lambda, simd_load(north + i),
                             simd_load(south + i), false, out->rho + i, largest);
        note_largest(out, run, largest);
        span = block_span_hull(span, run);
    }
    block_set_clear(active, macro__words(s));
    block_set_clear(active_first, macro__words(s));
    sweep_mark(out->rho, out->saturated.first, out->saturated.last, active, active_first);
    skip_mark_active(s, span, active, active_first);
    macro__fill_margins(s, out->rho);
    s->next.span[r] = span;
}

// The stage of row r.
static void sweep_row(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const uint64_t *expected = macro__set(s, band->expected, r);
    const block_span span = skip_grow_span(s, s->now.span[r], macro__row(s, s->now.rho, r));
    row_update out = { macro__row(s, s->next.rho, r), s->stage == 1, { 0, 0 } };

    skip_find_active_faces(band, r);
    sweep_make_dispersion(band, r, expected);
    s->cost[r] = sweep_row_cost(s, expected);
    sweep_x1(band, r, span, &out);
    flux_x2(band, r + 1);
    finish_row(band, r, span, &out);
}

void macro__sweep_muscl(macro_band *band)
{
    const uint64_t arithmetic = subnormals_flush();

    macro__dispersion_begin(band);
    block_set_clear(band->ahead, macro__words(band->solver));
    make_states_x2(band, band->first - 1);
    flux_x2(band, band->first);
    for (ptrdiff_t r = band->first; r < band->last; r++)
        sweep_row(band, r);
    subnormals_restore(arithmetic);
}
