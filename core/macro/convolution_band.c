// What a thread needs for its band of rows, in two blocks of memory.

#include "core/base/memory.h"
#include "core/macro/macro_priv.h"

// Hands out rows and sets, one after the other.
typedef struct cutter {
    const macro_solver *solver;
    double *rows;
    uint64_t *sets;
} cutter;

static double *cut_row(cutter *c)
{
    double *row = c->rows + c->solver->margin;

    c->rows += c->solver->stride;
    return row;
}

static uint64_t *cut_set(cutter *c)
{
    uint64_t *set = c->sets;

    c->sets += c->solver->n_words;
    return set;
}

static void cut_ring(macro_band *band, cutter *c)
{
    for (ptrdiff_t k = 0; k < c->solver->n_ring; k++) {
        band->ring[k].slope1 = cut_row(c);
        band->ring[k].share1 = cut_row(c);
        band->ring[k].done = cut_set(c);
        band->slope_ring[k] = band->slope_ring[k + c->solver->n_ring] = band->ring[k].slope1;
        band->share_ring[k] = band->share_ring[k + c->solver->n_ring] = band->ring[k].share1;
    }
}

static void cut_pairs(macro_band *band, cutter *c)
{
    for (int k = 0; k < 2; k++) {
        band->push[k].i1 = cut_row(c);
        band->push[k].i2 = cut_row(c);
        band->push[k].done = cut_set(c);
        band->outside_open[k] = cut_set(c);
        band->outside_first[k] = cut_set(c);
        band->swept_gated[k] = cut_row(c);
        band->outside[k] = cut_row(c);
        band->flux2[k] = cut_row(c);
        band->flux2_set[k] = cut_set(c);
    }
}

enum { ROWS_IN_PAIRS = 5, SETS_IN_PAIRS = 4, SINGLE_ROWS = 2, SINGLE_SETS = 7 };

bf_status macro__band_init(const macro_solver *s, macro_band *band)
{
    const size_t n_ring = (size_t)s->n_ring;
    const size_t n_rows = 2 * n_ring + 2 * ROWS_IN_PAIRS + SINGLE_ROWS;
    const size_t n_sets = n_ring + 2 * SETS_IN_PAIRS + SINGLE_SETS;

    band->solver = s;
    band->rows = memory_alloc(n_rows * (size_t)s->stride, sizeof *band->rows);
    band->sets = memory_alloc(n_sets * s->n_words, sizeof *band->sets);
    band->ring = memory_alloc(n_ring, sizeof *band->ring);
    band->expected = memory_alloc((size_t)s->n2 * s->n_words, sizeof *band->expected);
    band->near =
        memory_alloc((size_t)(s->n2 + 4 * s->across.reach) * s->n_words, sizeof *band->near);
    band->slope_ring = memory_alloc(2 * n_ring, sizeof *band->slope_ring);
    band->share_ring = memory_alloc(2 * n_ring, sizeof *band->share_ring);
    band->slope_rows = memory_alloc(n_ring, sizeof *band->slope_rows);
    band->share_rows = memory_alloc(n_ring, sizeof *band->share_rows);
    if (band->rows == NULL || band->sets == NULL || band->ring == NULL || band->expected == NULL ||
        band->near == NULL || band->slope_ring == NULL || band->share_ring == NULL ||
        band->slope_rows == NULL || band->share_rows == NULL)
        return BF_ENOMEM;
    cutter c = { s, band->rows, band->sets };
    cut_ring(band, &c);
    cut_pairs(band, &c);
    band->gated = cut_row(&c);
    band->flux1 = cut_row(&c);
    band->open_faces = cut_set(&c);
    band->wanted = cut_set(&c);
    band->missing = cut_set(&c);
    band->unexpected = cut_set(&c);
    band->todo = cut_set(&c);
    band->special = cut_set(&c);
    band->empty = cut_set(&c);
    return BF_OK;
}

void macro__band_fini(macro_band *band)
{
    memory_free(band->rows);
    memory_free(band->sets);
    memory_free(band->ring);
    memory_free(band->expected);
    memory_free(band->near);
    memory_free(band->slope_ring);
    memory_free(band->share_ring);
    memory_free(band->slope_rows);
    memory_free(band->share_rows);
    *band = (macro_band){ 0 };
}
