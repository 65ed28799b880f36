#include "core/micro/neighbours_priv.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

enum { SPARE_CELLS = 64 }; // grids may have 4 cells a part and these

typedef struct bounds {
    double x_min, x_max, y_min, y_max;
} bounds;

static bounds measure_bounds(size_t n, const double *x, const double *y, size_t stride,
                             const uint8_t *skip)
{
    bounds b = { INFINITY, -INFINITY, INFINITY, -INFINITY };

    for (size_t k = 0; k < n; k++) {
        if (skip != NULL && skip[k] != 0)
            continue;
        b.x_min = fmin(b.x_min, x[k * stride]);
        b.x_max = fmax(b.x_max, x[k * stride]);
        b.y_min = fmin(b.y_min, y[k * stride]);
        b.y_max = fmax(b.y_max, y[k * stride]);
    }
    return b;
}

// Cells that a length takes, at least 1 and not more than most (what is not finite: most).
static double count_along(double length, double edge, double most)
{
    double n = floor(length / edge) + 1.0;

    return n < most ? fmax(n, 1.0) : most;
}

static void lay_out(neighbours_cells *cells, bounds b, size_t n, double edge)
{
    const double most = 4.0 * (double)n + SPARE_CELLS;
    const double extent = fmax(b.x_max - b.x_min, 0.0) + fmax(b.y_max - b.y_min, 0.0);

    // A little more, so that rounding cannot put parts within an edge two cells apart.
    edge = edge * (1.0 + 1e-9) + 1e-15 * extent;
    double n_x = count_along(b.x_max - b.x_min, edge, most);
    double n_y = count_along(b.y_max - b.y_min, edge, most);

    while (n_x * n_y > most) {
        edge *= 1.25;
        n_x = count_along(b.x_max - b.x_min, edge, most);
        n_y = count_along(b.y_max - b.y_min, edge, most);
        if (!isfinite(edge))
            n_x = n_y = 1.0;
    }
    cells->x_min = isfinite(b.x_min) ? b.x_min : 0.0;
    cells->y_min = isfinite(b.y_min) ? b.y_min : 0.0;
    cells->per_edge = 1.0 / edge;
    cells->n_x = (size_t)n_x;
    cells->n_y = (size_t)n_y;
}

static size_t clamp_cell(double at, size_t n)
{
    if (!(at >= 1.0))
        return 0;
    return at < (double)n ? (size_t)at : n - 1;
}

size_t neighbours__column(const neighbours_cells *cells, double x)
{
    return clamp_cell((x - cells->x_min) * cells->per_edge, cells->n_x);
}

size_t neighbours__row(const neighbours_cells *cells, double y)
{
    return clamp_cell((y - cells->y_min) * cells->per_edge, cells->n_y);
}

static bf_status reserve(neighbours_cells *cells, size_t n)
{
    size_t n_cells = cells->n_x * cells->n_y;

    if (memory_reserve(&cells->first, &cells->first_capacity, n_cells + 1, sizeof *cells->first) !=
            0 ||
        memory_reserve(&cells->order, &cells->order_capacity, n, sizeof *cells->order) != 0 ||
        memory_reserve(&cells->cell_of, &cells->cell_capacity, n, sizeof *cells->cell_of) != 0)
        return BF_ENOMEM;
    memset(cells->first, 0, (n_cells + 1) * sizeof *cells->first);
    return BF_OK;
}

bf_status neighbours__sort(neighbours_cells *cells, size_t n, const double *x, const double *y,
                           size_t stride, const uint8_t *skip, double edge, bf_error *err)
{
    cells->n_live = 0;
    lay_out(cells, measure_bounds(n, x, y, stride, skip), n, edge);
    if (reserve(cells, n) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the cells of %zu parts", n);
    for (size_t k = 0; k < n; k++) {
        cells->cell_of[k] = UINT32_MAX;
        if (skip != NULL && skip[k] != 0)
            continue;
        size_t cell = neighbours__cell(cells, neighbours__column(cells, x[k * stride]),
                                       neighbours__row(cells, y[k * stride]));
        cells->cell_of[k] = (uint32_t)cell;
        cells->first[cell + 1]++;
        cells->n_live++;
    }
    for (size_t cell = 0; cell < cells->n_x * cells->n_y; cell++)
        cells->first[cell + 1] += cells->first[cell];
    // Filling from the end counts each cell's end down to its beginning.
    for (size_t k = n; k-- > 0;)
        if (cells->cell_of[k] != UINT32_MAX)
            cells->order[--cells->first[cells->cell_of[k] + 1]] = (uint32_t)k;
    memmove(cells->first, cells->first + 1, cells->n_x * cells->n_y * sizeof *cells->first);
    cells->first[cells->n_x * cells->n_y] = (uint32_t)cells->n_live;
    return BF_OK;
}

void neighbours__cells_fini(neighbours_cells *cells)
{
    if (cells == NULL)
        return;
    memory_free(cells->first);
    memory_free(cells->order);
    memory_free(cells->cell_of);
    *cells = (neighbours_cells){ 0 };
}
