// The sweeps along x1 and x2 over a band of rows.

#include "core/macro/kernels.h"
#include "core/macro/macro_priv.h"

#include <math.h>
#include <string.h>

static const double cost_of_push = 8.0; // I of a block, in blocks swept

static const block_span no_blocks = { 0, 0 };

static block_span span_hull(block_span a, block_span b)
{
    if (a.first >= a.last)
        return b;
    if (b.first >= b.last)
        return a;
    return (block_span){ a.first < b.first ? a.first : b.first, a.last > b.last ? a.last : b.last };
}

// H(rho - 1) rho where the kernels do not gate by themselves: the row itself, or made in storage.
static const double *gate_row(const macro_solver *s, const double *rho, block_span span,
                              double *storage)
{
    if (s->def.gate != MACRO_GATE_SMOOTH)
        return rho;
    // A block on each side is read as the neighbour of the first and last cell.
    memset(storage - BLOCK_CELLS, 0, (size_t)(s->n_blocks + 2) * BLOCK_CELLS * sizeof *storage);
    for (ptrdiff_t i = span.first * BLOCK_CELLS; i < span.last * BLOCK_CELLS; i++)
        storage[i] = rho[i] * (0.5 + atan((rho[i] - 1.0) / s->def.gate_width) / M_PI);
    return storage;
}

// Marks where the gate is open in what was just updated. Kernels marked what is packed; in its other
// forms H has no zero, so there the gate is open wherever there is mass.
static void mark_open(const macro_solver *s, block_span range, uint64_t *open, uint64_t *open_first)
{
    if (s->def.gate == MACRO_GATE_SHARP)
        return;
    for (size_t w = 0; w < macro__words(s); w++) {
        open[w] |= block_set_span_word(range, w);
        open_first[w] |= block_set_span_word(range, w);
    }
}

// Makes I of row r where its x1 sweep needs it, and where its x2 flux probably will. Sets
// band->open_faces.
static void prepare_push(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const uint64_t *open = macro__set(s, s->now.open, r);
    const uint64_t *first = macro__set(s, s->now.open_first, r);
    const uint64_t *expected = macro__set(s, band->expected, r);
    uint64_t any = 0;

    for (size_t w = 0; w < macro__words(s); w++) {
        band->open_faces[w] = open[w] | block_set_shifted_down(first, macro__words(s), w);
        any |= band->wanted[w] = expected[w];
    }
    if (any != 0)
        macro__push_make(band, r);
    if (r >= band->first && r < band->last)
        s->cost[r] = 1.0 + (double)s->n_blocks +
                     (any == 0 ? 0.0 : cost_of_push * block_set_count(expected, macro__words(s)));
}

// The flux through the faces of the blocks of range, between the rows (or the shifted row) near and
// far: static everywhere, pushed in the blocks of open.
static void make_flux(const macro_solver *s, const double *v, const double *push,
                      const macro_swept *near, const macro_swept *far, block_span range,
                      const uint64_t *open, double *flux)
{
    ptrdiff_t b = range.first, done = range.first;
    block_span run;

    while (done < range.last) {
        if (!block_set_next_run(open, macro__words(s), &b, &run) || run.first > range.last)
            run = (block_span){ range.last, range.last };
        run.last = run.last < range.last ? run.last : range.last;
        kernels_upwind(v, near->rho, far->rho, done, run.first, flux);
        if (s->def.gate == MACRO_GATE_SHARP) {
            kernels_upwind_sharp(v, push, near->rho, far->rho, run.first, run.last, flux);
        } else {
            kernels_upwind(v, near->rho, far->rho, run.first, run.last, flux);
            kernels_upwind_add(push, near->gated, far->gated, run.first, run.last, flux);
        }
        done = run.last;
    }
}

// Where the density of a row can be after a step along x1: mass moves by one cell at most.
static block_span grown_span(const macro_solver *s, block_span span, const double *rho)
{
    if (span.first >= span.last)
        return no_blocks;
    if (span.first > 0 && rho[span.first * BLOCK_CELLS] != 0.0)
        span.first--;
    if (span.last < s->n_blocks && rho[span.last * BLOCK_CELLS - 1] != 0.0)
        span.last++;
    return span;
}

// The blocks of cells that need their fluxes one by one: those at a face that is mixed or open.
static void find_special(macro_band *band, ptrdiff_t r, block_span span)
{
    const macro_solver *s = band->solver;
    const uint64_t *mixed = macro__set(s, s->faces1.mixed, r);
    uint64_t carry = 0; // the face at the end of the word before

    for (size_t w = 0; w < macro__words(s); w++) {
        uint64_t faces = mixed[w] | band->open_faces[w];
        band->special[w] = (faces | faces << 1 | carry) & block_set_span_word(span, w);
        carry = faces >> 63;
    }
}

// The x1 sweep of row r of `now` over the swept row's span.
static void sweep_row_x1(macro_band *band, ptrdiff_t r, macro_swept *swept, double *out)
{
    const macro_solver *s = band->solver;
    const double *rho = macro__row(s, s->now.rho, r);
    const double *gated = gate_row(s, rho, s->now.span[r], band->gated);
    const macro_swept near = { .rho = rho, .gated = gated };
    const macro_swept far = { .rho = rho + 1, .gated = gated + 1 };
    ptrdiff_t b = -1, done = swept->span.first;
    block_span run;

    find_special(band, r, swept->span);
    while (done < swept->span.last) {
        if (!block_set_next_run(band->special, macro__words(s), &b, &run))
            run = (block_span){ swept->span.last, swept->span.last };
        if (done < run.first)
            kernels_update_uniform(rho, s->lambda1, s->plain1, done, run.first, out, swept->open,
                                   swept->open_first);
        if (run.first < run.last) {
            make_flux(s, macro__row(s, s->faces1.v, r), band->push[r & 1].i1, &near, &far,
                      (block_span){ run.first - 1, run.last }, band->open_faces, band->flux1);
            kernels_update(rho, s->lambda1, band->flux1, band->flux1 - 1, run.first, run.last, out,
                           swept->open, swept->open_first);
        }
        done = run.last;
    }
    mark_open(s, swept->span, swept->open, swept->open_first);
}

// Where the x1 sweep of row r goes: into `next` inside the band, aside for its neighbours.
static double *open_swept(macro_band *band, ptrdiff_t r, macro_swept *swept)
{
    const macro_solver *s = band->solver;
    const int side = r < band->first ? 0 : 1;
    double *out = band->outside[side];

    swept->open = band->outside_open[side];
    swept->open_first = band->outside_first[side];
    if (r >= band->first && r < band->last) {
        out = macro__row(s, s->next.rho, r);
        swept->open = macro__set(s, s->next.open, r);
        swept->open_first = macro__set(s, s->next.open_first, r);
    } else {
        memset(out - s->margin, 0, (size_t)s->stride * sizeof *out);
    }
    block_set_clear(swept->open, macro__words(s));
    block_set_clear(swept->open_first, macro__words(s));
    return out;
}

// Sweeps row r along x1; outside the grid there is nothing.
static void sweep_x1(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    macro_swept *swept = &band->swept[r & 1];

    if (r < 0 || r >= s->n2) {
        const double *nothing = s->zero_row + s->margin;
        *swept = (macro_swept){ nothing, nothing, band->empty, band->empty, no_blocks };
        return;
    }
    double *out = open_swept(band, r, swept);
    swept->rho = out;
    swept->span = grown_span(s, s->now.span[r], macro__row(s, s->now.rho, r));
    prepare_push(band, r);
    sweep_row_x1(band, r, swept, out);
    swept->gated = gate_row(s, out, swept->span, band->swept_gated[r & 1]);
}

// Sets the blocks of the flux between rows r - 1 and r that are not exactly zero; of them band->wanted
// are those with an open cell at a side. What the array held before is wiped.
static void find_flux_x2(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const macro_swept *south = &band->swept[(r - 1) & 1], *north = &band->swept[r & 1];
    const uint64_t *mixed = macro__set(s, s->faces2.mixed, r);
    const uint64_t *shut = macro__set(s, s->faces2.shut, r);
    const block_span span = span_hull(south->span, north->span);
    uint64_t *set = band->flux2_set[r & 1];
    ptrdiff_t b = -1;
    block_span run;

    for (size_t w = 0; w < macro__words(s); w++) {
        band->wanted[w] = (south->open[w] | north->open[w]) & ~shut[w];
        uint64_t carried = mixed[w] & ~shut[w] & block_set_span_word(span, w);
        band->todo[w] = set[w];
        set[w] = band->wanted[w] | carried;
        band->todo[w] &= ~set[w];
    }
    while (block_set_next_run(band->todo, macro__words(s), &b, &run))
        memset(band->flux2[r & 1] + run.first * BLOCK_CELLS, 0,
               (size_t)(run.last - run.first) * BLOCK_CELLS * sizeof(double));
}

// The flux through the faces between rows r - 1 and r after their x1 sweeps.
static void flux_x2(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    ptrdiff_t b = -1;
    block_span run;

    find_flux_x2(band, r);
    if (!block_set_is_empty(band->wanted, macro__words(s)))
        macro__push_make(band, r - 1);
    while (block_set_next_run(band->flux2_set[r & 1], macro__words(s), &b, &run))
        make_flux(s, macro__row(s, s->faces2.v, r), band->push[(r - 1) & 1].i2,
                  &band->swept[(r - 1) & 1], &band->swept[r & 1], run, band->wanted,
                  band->flux2[r & 1]);
}

// The x2 sweep of row r, in place, with the fluxes on both its sides.
static void finish_row(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const macro_swept *swept = &band->swept[r & 1];
    const uint64_t *south = band->flux2_set[r & 1], *north = band->flux2_set[(r + 1) & 1];
    double *rho = macro__row(s, s->next.rho, r);
    block_span span = swept->span, run;
    ptrdiff_t b = -1;

    for (size_t w = 0; w < macro__words(s); w++)
        band->todo[w] = south[w] | north[w];
    while (block_set_next_run(band->todo, macro__words(s), &b, &run)) {
        kernels_update(rho, s->lambda2, band->flux2[(r + 1) & 1], band->flux2[r & 1], run.first,
                       run.last, rho, swept->open, swept->open_first);
        mark_open(s, run, swept->open, swept->open_first);
        span = span_hull(span, run);
    }
    macro__fill_margins(s, rho);
    s->next.span[r] = span;
}

void macro__sweep_band(macro_band *band)
{
    macro__push_begin(band);
    sweep_x1(band, band->first - 1);
    for (ptrdiff_t r = band->first; r <= band->last; r++) {
        sweep_x1(band, r);
        flux_x2(band, r);
        if (r > band->first)
            finish_row(band, r - 1);
    }
}
