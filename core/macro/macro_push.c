// The push I of (10) where it is wanted: x1 part of the convolution in a ring of rows, then the x2
// part, then the root.

#include "core/base/check.h"
#include "core/macro/macro_priv.h"

#include <string.h>

enum { NO_ROW = -0x7fffffff };

static macro_ring_row *ring_place(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    macro_ring_row *place = &band->ring[r & (s->n_ring - 1)];

    if (place->row != r) {
        place->row = r;
        memset(place->done, 0, s->n_words * sizeof *place->done);
    }
    return place;
}

// Makes the x1 part of row r for the missing blocks that are not done.
static const macro_ring_row *convolve_row(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    macro_ring_row *place = ring_place(band, r);
    uint64_t *todo = band->todo;
    uint64_t any = 0;
    ptrdiff_t b = -1;
    block_span run;

    for (size_t w = 0; w < s->n_words; w++)
        any |= todo[w] = band->missing[w] & ~place->done[w];
    if (any == 0)
        return place;
    while (block_set_next_run(todo, s->n_words, &b, &run))
        s->kernel->convolve_x1(macro__row(s, s->now.rho, r), &s->along, run.first, run.last,
                               place->slope1, place->share1);
    for (size_t w = 0; w < s->n_words; w++)
        place->done[w] |= todo[w];
    return place;
}

// The row of the grid that the convolution sees at row r, which may lie outside; NO_ROW: zeros.
static ptrdiff_t seen_row(const macro_solver *s, ptrdiff_t r)
{
    if (r >= 0 && r < s->n2)
        return r;
    ptrdiff_t mirrored = r < 0 ? -1 - r : 2 * s->n2 - 1 - r;
    bool is_mirror = s->def.mirror[r < 0 ? 2 : 3];
    return is_mirror && mirrored >= 0 && mirrored < s->n2 ? mirrored : NO_ROW;
}

void macro__push_begin(macro_band *band)
{
    for (ptrdiff_t k = 0; k < band->solver->n_ring; k++)
        band->ring[k].row = NO_ROW;
    for (int k = 0; k < 2; k++)
        band->push[k].row = NO_ROW;
}

static macro_push_row *push_place(macro_band *band, ptrdiff_t r)
{
    macro_push_row *place = &band->push[r & 1];

    if (place->row != r) {
        place->row = r;
        memset(place->done, 0, band->solver->n_words * sizeof *place->done);
    }
    return place;
}

// Nothing crosses a closed face, so the push there is zero.
static void close_faces(const macro_solver *s, const macro_faces *faces, ptrdiff_t row,
                        const uint64_t *blocks, double *push)
{
    const uint8_t *closed = macro__closed(s, faces, row);
    const uint64_t *closable = macro__set(s, faces->closable, row);

    for (size_t w = 0; w < s->n_words; w++)
        for (uint64_t word = blocks[w] & closable[w]; word != 0; word &= word - 1) {
            ptrdiff_t b = (ptrdiff_t)(w * 64) + __builtin_ctzll(word) - 1;
            for (unsigned mask = closed[b]; mask != 0; mask &= mask - 1)
                push[b * LANES + __builtin_ctz(mask)] = 0.0;
        }
}

void macro__push_make(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    macro_push_row *place = push_place(band, r);
    uint64_t *missing = band->missing;
    uint64_t any = 0;
    ptrdiff_t b = -1;
    block_span run;

    for (size_t w = 0; w < s->n_words; w++)
        any |= missing[w] = band->wanted[w] & ~place->done[w];
    if (any == 0)
        return;
    for (int m = 0; m <= 2 * s->across.reach; m++) {
        ptrdiff_t seen = seen_row(s, r - s->across.reach + m);
        const macro_ring_row *row = seen == NO_ROW ? NULL : convolve_row(band, seen);
        band->slope_rows[m] = row == NULL ? s->zero_row + s->margin : row->slope1;
        band->share_rows[m] = row == NULL ? s->zero_row + s->margin : row->share1;
    }
    while (block_set_next_run(missing, s->n_words, &b, &run))
        s->kernel->push(band->slope_rows, band->share_rows, &s->across, s->def.dispersion,
                        run.first, run.last, place->i1, place->i2);
    if (r >= 0)
        close_faces(s, &s->faces1, r, missing, place->i1);
    close_faces(s, &s->faces2, r + 1, missing, place->i2);
    for (size_t w = 0; w < s->n_words; w++)
        place->done[w] |= missing[w];
}
