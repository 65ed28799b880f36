// The loops over cells of the times of entry, compiled once per instruction set.

#include "core/base/simd.h"
#include "core/macro/entry_times.h"

// A density and its times' integral.
typedef struct content {
    simd rho;
    simd sum;
} content;

// Less is no density: it only keeps an empty cell's time finite.
static const double least = 1e-300;

static inline content add_inflow(content c, simd inflow, simd times)
{
    return (content){ c.rho + inflow, c.sum + inflow * times };
}

static inline simd time_of(content c)
{
    return c.sum / simd_max(c.rho, simd_all(least));
}

void entry_times__carry(const macro_solver *s, ptrdiff_t row)
{
    const entry_times *e = s->entries;
    const double *nothing = s->zero_row + s->margin, *rho = macro__row(s, s->now.rho, row);
    const double *times = macro__row(s, e->times, row), *x1 = macro__row(s, e->flux1, row);
    const double *times_south = row > 0 ? times - s->stride : nothing;
    const double *times_north = row + 1 < s->n2 ? times + s->stride : nothing;
    const double *x2_south = macro__row(s, e->flux2, row), *x2_north = x2_south + s->stride;
    const block_span span = s->now.span[row];
    double *next = macro__row(s, e->next, row);

    entry_times_clear(s, next, span);
    for (ptrdiff_t i = span.first * BLOCK_CELLS; i < span.last * BLOCK_CELLS; i += SIMD_LANES) {
        const simd from_west = simd_load_any(x1 + i - 1), to_east = simd_load(x1 + i);
        const simd from_south = simd_load(x2_south + i), to_north = simd_load(x2_north + i);
        const simd west = simd_positive(from_west), east = simd_positive(-to_east);
        const simd south = simd_positive(from_south), north = simd_positive(-to_north);
        const simd stays = simd_positive(simd_load(rho + i) - (west + east + south + north));
        content c = { stays, stays * simd_load(times + i) };

        c = add_inflow(c, west, simd_load_any(times + i - 1));
        c = add_inflow(c, east, simd_load_any(times + i + 1));
        c = add_inflow(c, south, simd_load(times_south + i));
        c = add_inflow(c, north, simd_load(times_north + i));
        simd_store(next + i, time_of(c));
    }
}
