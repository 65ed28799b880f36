// The dispersion velocity I of (10) where it is needed, by the sums of convolution.h: the x1 part in a ring of
// rows, then the x2 part and the root.
//
// Most of what a step needs is known before it: I at the faces whose cells are active in `now`. So
// the x1 part of a row is computed once, for all rows that will read it, when the row enters the ring. The
// exception are cells that become active by the x1 sweep; their blocks are computed when they are found.

#include "core/macro/convolution.h"
#include "core/macro/macro_priv.h"

#include <string.h>

enum { NO_ROW = -0x7fffffff };

static macro_ring_row *ring_row(const macro_band *band, ptrdiff_t r)
{
    return &band->ring[r & (band->solver->n_ring - 1)];
}

// Computes the x1 part of row r for the blocks of wanted that are missing.
static void convolve_row(macro_band *band, ptrdiff_t r, const uint64_t *wanted)
{
    const macro_solver *s = band->solver;
    macro_ring_row *row = ring_row(band, r);
    uint64_t *todo = band->todo;
    ptrdiff_t b = -1;
    block_span run;

    for (size_t w = 0; w < macro__words(s); w++) {
        todo[w] = wanted[w] & ~row->done[w];
        row->done[w] |= todo[w];
    }
    while (block_set_next_run(todo, macro__words(s), &b, &run))
        convolution_along_x1(macro__row(s, s->now.rho, r), &s->along, run.first, run.last,
                             row->gradient1, row->integral1);
}

// Lets the rows up to r enter the ring, each with the blocks that the rows within S of it expect.
static void fill_ring(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const ptrdiff_t end = r + 1 < s->n2 ? r + 1 : s->n2;

    for (; band->ring_end < end; band->ring_end++) {
        block_set_clear(ring_row(band, band->ring_end)->done, macro__words(s));
        convolve_row(band, band->ring_end,
                     macro__set(s, band->near, band->ring_end + s->across.reach));
    }
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

// Computes near from expected: the union over windows of 2 S + 1 rows, in windows that double in length.
static void spread_expected(macro_band *band, ptrdiff_t first, ptrdiff_t last)
{
    const macro_solver *s = band->solver;
    const size_t reach = (size_t)s->across.reach, window = 2 * reach + 1, n_words = macro__words(s);
    // Row j of the grid is put at j + 2 S, so that the window j - S .. j + S begins at j + S.
    uint64_t *rows = band->near;
    const size_t from = (size_t)first * n_words, to = ((size_t)last + 2 * reach) * n_words;
    size_t length = 1;

    memset(rows + from, 0, (to - from + 2 * reach * n_words) * sizeof *rows);
    memcpy(rows + ((size_t)first + 2 * reach) * n_words, band->expected + from,
           (size_t)(last - first) * n_words * sizeof *rows);
    for (; 2 * length <= window; length *= 2)
        for (size_t k = from; k < to; k++)
            rows[k] |= rows[k + length * n_words];
    for (size_t k = from; k < to; k++)
        rows[k] |= rows[k + (window - length) * n_words];
}

void macro__dispersion_begin(macro_band *band)
{
    const macro_solver *s = band->solver;
    const ptrdiff_t first = band->first > 0 ? band->first - 1 : 0;
    const ptrdiff_t last = band->last < s->n2 ? band->last + 1 : s->n2;

    for (ptrdiff_t r = first; r < last; r++) {
        const uint64_t *active = macro__set(s, s->now.active, r);
        const uint64_t *first_active = macro__set(s, s->now.active_first, r);
        const uint64_t *north = r + 1 < s->n2 ? macro__set(s, s->now.active, r + 1) : band->empty;
        uint64_t *expected = macro__set(s, band->expected, r);
        for (size_t w = 0; w < macro__words(s); w++)
            expected[w] =
                active[w] | block_set_shifted_down(first_active, macro__words(s), w) | north[w];
    }
    spread_expected(band, first, last);
    for (int k = 0; k < 2; k++)
        band->dispersion[k].row = NO_ROW;
    band->ring_end = first > s->across.reach ? first - s->across.reach : 0;
}

static macro_dispersion_row *dispersion_row(macro_band *band, ptrdiff_t r)
{
    macro_dispersion_row *made = &band->dispersion[r & 1];

    if (made->row != r) {
        made->row = r;
        block_set_clear(made->done, macro__words(band->solver));
    }
    return made;
}

// Nothing crosses a closed face, so I is zero there.
static void close_faces(const macro_solver *s, const macro_faces *faces, ptrdiff_t row,
                        const uint64_t *blocks, double *velocity)
{
    const uint8_t *closed = macro__closed(s, faces, row);
    const uint64_t *closable = macro__set(s, faces->closable, row);

    for (size_t w = 0; w < macro__words(s); w++)
        for (uint64_t word = blocks[w] & closable[w]; word != 0; word &= word - 1) {
            ptrdiff_t b = (ptrdiff_t)(w * 64) + __builtin_ctzll(word) - 1;
            for (unsigned mask = closed[b]; mask != 0; mask &= mask - 1)
                velocity[b * BLOCK_CELLS + __builtin_ctz(mask)] = 0.0;
        }
}

// Scales I by the factors of the belts under the faces.
static void scale_faces(const macro_solver *s, const macro_faces *faces, ptrdiff_t row,
                        block_span blocks, double *velocity)
{
    const uint16_t *belt = macro__belts(s, faces, row);

    for (ptrdiff_t i = blocks.first * BLOCK_CELLS; i < blocks.last * BLOCK_CELLS; i++)
        velocity[i] *= s->factors[belt[i]];
}

// Computes the x1 part of all rows that row r reads for the missing blocks that were not expected.
static void make_unexpected(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const uint64_t *expected = r < 0 ? band->empty : macro__set(s, band->expected, r);
    uint64_t *unexpected = band->unexpected;
    uint64_t any = 0;

    for (size_t w = 0; w < macro__words(s); w++)
        any |= unexpected[w] = band->missing[w] & ~expected[w];
    for (int m = 0; any != 0 && m <= 2 * s->across.reach; m++) {
        ptrdiff_t row = r - s->across.reach + m;
        if (row >= 0 && row < s->n2)
            convolve_row(band, row, unexpected);
    }
}

// The rows r - S .. r + S as the convolution sees them.
typedef struct window {
    const double *const *gradient_rows;
    const double *const *integral_rows;
} window;

static window window_of(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    const ptrdiff_t first = r - s->across.reach;

    if (first >= 0 && r + s->across.reach < s->n2) {
        const ptrdiff_t at = first & (s->n_ring - 1);
        return (window){ band->gradient_ring + at, band->integral_ring + at };
    }
    for (int m = 0; m <= 2 * s->across.reach; m++) {
        ptrdiff_t seen = seen_row(s, first + m);
        const macro_ring_row *row = ring_row(band, seen);
        band->gradient_rows[m] = seen == NO_ROW ? s->zero_row + s->margin : row->gradient1;
        band->integral_rows[m] = seen == NO_ROW ? s->zero_row + s->margin : row->integral1;
    }
    return (window){ band->gradient_rows, band->integral_rows };
}

void macro__dispersion_make(macro_band *band, ptrdiff_t r)
{
    const macro_solver *s = band->solver;
    macro_dispersion_row *made = dispersion_row(band, r);
    uint64_t *missing = band->missing;
    uint64_t any = 0;
    ptrdiff_t b = -1;
    block_span run;

    for (size_t w = 0; w < macro__words(s); w++) {
        any |= missing[w] = band->wanted[w] & ~made->done[w];
        made->done[w] |= missing[w];
    }
    if (any == 0)
        return;
    band->swept.dispersed += block_set_count(missing, macro__words(s)) * BLOCK_CELLS;
    fill_ring(band, r + s->across.reach);
    make_unexpected(band, r);
    const window seen = window_of(band, r);
    while (block_set_next_run(missing, macro__words(s), &b, &run)) {
        convolution_dispersion_velocity(seen.gradient_rows, seen.integral_rows, &s->across,
                                        s->def.dispersion, run.first, run.last, made->i1, made->i2);
        if (s->speeds != NULL && r >= 0)
            scale_faces(s, &s->faces1, r, run, made->i1);
        if (s->speeds != NULL)
            scale_faces(s, &s->faces2, r + 1, run, made->i2);
    }
    if (r >= 0)
        close_faces(s, &s->faces1, r, missing, made->i1);
    close_faces(s, &s->faces2, r + 1, missing, made->i2);
}
