/// What a step skips: which blocks of a row need which part of the work.
///
/// The sweeps (sweep_roe.c, sweep_muscl.c) are correct without any of it. These functions find where their terms
/// are exactly zero, or the same for whole blocks:
///
///     rho = 0                    no flux: a row is swept from its first to its last block with mass
///     H = 0 on both sides        no dynamic flux: I is not needed there
///     one velocity, I = 0        x1 fluxes of the free belt, without a row of velocities
///     v = 0 and I = 0            no x2 flux
///
/// A set may contain more blocks than necessary, never fewer: a flux made without need is exactly zero. For
/// the files that are compiled once per instruction set.

#pragma once

#include "core/macro/macro_priv.h"

#include <string.h>

/// Add the blocks in which H may not be zero in a range that was just updated. The update itself marks
/// saturated cells; in its other forms H has no zero, so there every block with mass counts.
static inline void skip_mark_active(const macro_solver *s, block_span range, uint64_t *active,
                                    uint64_t *active_first)
{
    if (s->def.heaviside == SCENE_HEAVISIDE_SHARP)
        return;
    for (size_t w = 0; w < macro__words(s); w++) {
        active[w] |= block_set_span_word(range, w);
        active_first[w] |= block_set_span_word(range, w);
    }
}

/// Set band->active_faces: the blocks with an x1-face of row r at which H may not be zero on a side.
static inline void skip_find_active_faces(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const uint64_t *active = macro__set(s, s->now.active, r);
    const uint64_t *first = macro__set(s, s->now.active_first, r);

    for (size_t w = 0; w < macro__words(s); w++)
        band->active_faces[w] = active[w] | block_set_shifted_down(first, macro__words(s), w);
}

/// Where the density of a row can be after a step along x1: mass moves by one cell at most.
static inline block_span skip_grow_span(const macro_solver *s, block_span span, const double *rho)
{
    if (span.first >= span.last)
        return (block_span){ 0, 0 };
    if (span.first > 0 && rho[span.first * BLOCK_CELLS] != 0.0)
        span.first--;
    if (span.last < s->n_blocks && rho[span.last * BLOCK_CELLS - 1] != 0.0)
        span.last++;
    return span;
}

/// Set band->special: the blocks of row r whose x1 fluxes are made one by one, because a face has another
/// velocity than the free belt or I may not be zero there. Counts all cells of the span, and these.
static inline void skip_find_special(macro_band *band, ptrdiff_t r, block_span span)
{
    const macro_solver *s = band->solver;
    const uint64_t *mixed = macro__set(s, s->faces1.mixed, r);
    uint64_t carry = 0; // the face at the end of the word before

    for (size_t w = 0; w < macro__words(s); w++) {
        uint64_t faces = mixed[w] | band->active_faces[w];
        band->special[w] = (faces | faces << 1 | carry) & block_set_span_word(span, w);
        carry = faces >> 63;
    }
    band->swept.all += (double)((span.last - span.first) * BLOCK_CELLS);
    band->swept.varied += block_set_count(band->special, macro__words(s)) * BLOCK_CELLS;
}

/// Set band->flux2_set of the faces between rows r - 1 and r, and clear the flux in blocks that leave the set.
static inline void skip_put_flux_x2(macro_band *band, ptrdiff_t r, const uint64_t *blocks)
{
    uint64_t *set = band->flux2_set[r & 1], *left = band->unexpected;
    ptrdiff_t b = -1;
    block_span run;

    for (size_t w = 0; w < macro__words(band->solver); w++) {
        left[w] = set[w] & ~blocks[w];
        set[w] = blocks[w];
    }
    while (block_set_next_run(left, macro__words(band->solver), &b, &run))
        memset(band->flux2[r & 1] + run.first * BLOCK_CELLS, 0,
               (size_t)(run.last - run.first) * BLOCK_CELLS * sizeof(double));
}

/// Set the blocks of the x2 flux between rows r - 1 and r that are not exactly zero: band->flux2_set; of
/// them band->wanted needs I.
static inline void skip_find_flux_x2(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const macro_row_after_x1 *south = &band->after_x1[(r - 1) & 1], *north = &band->after_x1[r & 1];
    const uint64_t *mixed = macro__set(s, s->faces2.mixed, r);
    const uint64_t *closed_blocks = macro__set(s, s->faces2.closed_blocks, r);
    const block_span span = block_span_hull(south->span, north->span);

    for (size_t w = 0; w < macro__words(s); w++) {
        band->wanted[w] = (south->active[w] | north->active[w]) & ~closed_blocks[w];
        uint64_t carried = mixed[w] & ~closed_blocks[w] & block_set_span_word(span, w);
        band->todo[w] = band->wanted[w] | carried;
    }
    skip_put_flux_x2(band, r, band->todo);
}
