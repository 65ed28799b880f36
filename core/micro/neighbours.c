#include "core/micro/neighbours.h"

#include "core/base/memory.h"
#include "core/micro/neighbours_priv.h"

#include <math.h>
#include <string.h>

// What a build reads.
typedef struct source {
    size_t n;
    const double *x;
    const double *y;
    const double *reach; // NULL: all are reach0
    double reach0;
} source;

static double reach_of(const source *from, size_t k)
{
    return from->reach != NULL ? from->reach[k] : from->reach0;
}

static double largest_reach(const source *from, const uint8_t *is_gone)
{
    double largest = from->reach != NULL ? 0.0 : from->reach0;

    for (size_t k = 0; from->reach != NULL && k < from->n; k++)
        if (is_gone == NULL || is_gone[k] == 0)
            largest = fmax(largest, from->reach[k]);
    return largest;
}

static bool is_near(const pairs *p, const source *from, size_t k, size_t other)
{
    double dx = from->x[other] - from->x[k], dy = from->y[other] - from->y[k];
    double range = reach_of(from, k) + reach_of(from, other) + p->skin;

    return dx * dx + dy * dy < range * range && other != k;
}

// Puts a number into the sorted run of n that ends at `end`.
static void insert(uint32_t *end, size_t n, uint32_t number)
{
    for (; n > 0 && end[-1] > number; n--, end--)
        *end = end[-1];
    *end = number;
}

// Adds the neighbours of k in one cell to the n that it has from *start on.
static bf_status add_cell(pairs *p, const source *from, size_t k, size_t cell, size_t start,
                          size_t *n)
{
    const uint32_t *first = p->cells->first;

    for (size_t place = first[cell]; place < first[cell + 1]; place++) {
        uint32_t other = p->cells->order[place];
        if (!is_near(p, from, k, other))
            continue;
        if (memory_reserve(&p->neighbour, &p->capacity, start + *n + 1, sizeof *p->neighbour) != 0)
            return BF_ENOMEM;
        insert(p->neighbour + start + *n, *n, other);
        ++*n;
    }
    return BF_OK;
}

// Lists the neighbours of k from place `start` on.
static bf_status list_part(pairs *p, const source *from, size_t k, size_t start, size_t *ret_n)
{
    const neighbours_cells *cells = p->cells;
    size_t column = neighbours__column(cells, from->x[k]), row = neighbours__row(cells, from->y[k]);
    size_t n = 0;

    for (size_t i = column > 0 ? column - 1 : 0; i <= column + 1 && i < cells->n_x; i++)
        for (size_t j = row > 0 ? row - 1 : 0; j <= row + 1 && j < cells->n_y; j++)
            if (add_cell(p, from, k, neighbours__cell(cells, i, j), start, &n) != BF_OK)
                return BF_ENOMEM;
    *ret_n = n;
    return BF_OK;
}

// Room for n parts. The places where parts stood are read only after a build, so they need not stay.
static bf_status reserve(pairs *p, size_t n)
{
    if (p->cells == NULL && (p->cells = memory_alloc(1, sizeof *p->cells)) == NULL)
        return BF_ENOMEM;
    if (p->start != NULL && p->n == n)
        return BF_OK;
    memory_free(p->start);
    memory_free(p->x_built);
    memory_free(p->y_built);
    p->start = memory_alloc(n + 1, sizeof *p->start);
    p->x_built = memory_alloc(n, sizeof *p->x_built);
    p->y_built = memory_alloc(n, sizeof *p->y_built);
    p->n = n;
    if (p->start != NULL && p->x_built != NULL && p->y_built != NULL)
        return BF_OK;
    memory_free(p->start);
    p->start = NULL;
    return BF_ENOMEM;
}

static bf_status list_parts(pairs *p, const source *from)
{
    size_t total = 0;

    for (size_t k = 0; k < from->n; k++) {
        size_t n = 0;
        if (total > UINT32_MAX)
            return BF_ENOMEM;
        p->start[k] = (uint32_t)total;
        if (p->cells->cell_of[k] != UINT32_MAX && list_part(p, from, k, total, &n) != BF_OK)
            return BF_ENOMEM;
        total += n;
    }
    p->start[from->n] = (uint32_t)total;
    return total > UINT32_MAX ? BF_ENOMEM : BF_OK;
}

bf_status neighbours_build(pairs *p, size_t n, const double *x, const double *y,
                           const double *reach, double reach0, const uint8_t *is_gone,
                           bf_error *err)
{
    const source from = { n, x, y, reach, reach0 };

    if (reserve(p, n) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the neighbours of %zu parts", n);
    bf_status status = neighbours__sort(p->cells, n, x, y, 1, is_gone,
                                        2.0 * largest_reach(&from, is_gone) + p->skin, err);
    if (status != BF_OK)
        return status;
    if (list_parts(p, &from) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the neighbours of %zu parts", n);
    if (n > 0) {
        memcpy(p->x_built, x, n * sizeof *x);
        memcpy(p->y_built, y, n * sizeof *y);
    }
    p->n_builds++;
    return BF_OK;
}

bool neighbours_are_stale(const pairs *p, const double *x, const double *y, const uint8_t *is_gone)
{
    const double most = 0.25 * p->skin * p->skin;

    for (size_t k = 0; k < p->n; k++) {
        double dx = x[k] - p->x_built[k], dy = y[k] - p->y_built[k];
        if ((is_gone == NULL || is_gone[k] == 0) && !(dx * dx + dy * dy <= most))
            return true;
    }
    return false;
}

void neighbours_fini(pairs *p)
{
    if (p == NULL)
        return;
    memory_free(p->start);
    memory_free(p->neighbour);
    memory_free(p->x_built);
    memory_free(p->y_built);
    neighbours__cells_fini(p->cells);
    memory_free(p->cells);
    *p = (pairs){ 0 };
}
