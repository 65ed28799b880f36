#include "core/micro/neighbours.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

enum { SPARE_CELLS = 64 }; // grids may have 4 cells a part and these

// Cells that a length takes, at least 1 and not more than most (what is not finite: most).
static double count_along(double length, double edge, double most)
{
    double n = floor(length / edge) + 1.0;

    return n < most ? fmax(n, 1.0) : most;
}

// Cells of an edge or, where these would be too many, of a longer one, over all parts that are not skipped.
static void lay_out(neighbours_cells *cells, size_t n, const neighbours_parts *parts,
                    const uint8_t *skip, double edge)
{
    const double most = 4.0 * (double)n + SPARE_CELLS;
    double x_min = INFINITY, x_max = -INFINITY, y_min = INFINITY, y_max = -INFINITY;

    for (size_t k = 0; k < n; k++) {
        if (skip != NULL && skip[k] != 0)
            continue;
        x_min = fmin(x_min, parts->x[k * parts->stride]);
        x_max = fmax(x_max, parts->x[k * parts->stride]);
        y_min = fmin(y_min, parts->y[k * parts->stride]);
        y_max = fmax(y_max, parts->y[k * parts->stride]);
    }
    // A little more, so that rounding cannot put parts within an edge two cells apart.
    edge = edge * (1.0 + 1e-9) + 1e-15 * (fmax(x_max - x_min, 0.0) + fmax(y_max - y_min, 0.0));
    double n_x = count_along(x_max - x_min, edge, most);
    double n_y = count_along(y_max - y_min, edge, most);
    while (n_x * n_y > most) {
        edge *= 1.25;
        n_x = count_along(x_max - x_min, edge, most);
        n_y = count_along(y_max - y_min, edge, most);
        if (!isfinite(edge))
            n_x = n_y = 1.0;
    }
    cells->x_min = isfinite(x_min) ? x_min : 0.0;
    cells->y_min = isfinite(y_min) ? y_min : 0.0;
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

size_t neighbours_column(const neighbours_cells *cells, double x)
{
    return clamp_cell((x - cells->x_min) * cells->per_edge, cells->n_x);
}

size_t neighbours_row(const neighbours_cells *cells, double y)
{
    return clamp_cell((y - cells->y_min) * cells->per_edge, cells->n_y);
}

bf_status neighbours_sort(neighbours_cells *cells, size_t n, const neighbours_parts *parts,
                          const uint8_t *skip, double edge, bf_error *err)
{
    cells->n_live = 0;
    lay_out(cells, n, parts, skip, edge);
    const size_t n_cells = cells->n_x * cells->n_y;
    if (memory_reserve(&cells->first, &cells->first_capacity, n_cells + 1, sizeof *cells->first) !=
            0 ||
        memory_reserve(&cells->order, &cells->order_capacity, n, sizeof *cells->order) != 0 ||
        memory_reserve(&cells->cell_of, &cells->cell_capacity, n, sizeof *cells->cell_of) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the cells of %zu parts", n);
    memset(cells->first, 0, (n_cells + 1) * sizeof *cells->first);
    for (size_t k = 0; k < n; k++) {
        cells->cell_of[k] = UINT32_MAX;
        if (skip != NULL && skip[k] != 0)
            continue;
        size_t cell = neighbours_cell(cells, neighbours_column(cells, parts->x[k * parts->stride]),
                                      neighbours_row(cells, parts->y[k * parts->stride]));
        cells->cell_of[k] = (uint32_t)cell;
        cells->first[cell + 1]++;
        cells->n_live++;
    }
    for (size_t cell = 0; cell < n_cells; cell++)
        cells->first[cell + 1] += cells->first[cell];
    // Filling from the end counts each cell's end down to its beginning.
    for (size_t k = n; k-- > 0;)
        if (cells->cell_of[k] != UINT32_MAX)
            cells->order[--cells->first[cells->cell_of[k] + 1]] = (uint32_t)k;
    memmove(cells->first, cells->first + 1, n_cells * sizeof *cells->first);
    cells->first[n_cells] = (uint32_t)cells->n_live;
    return BF_OK;
}

void neighbours_cells_fini(neighbours_cells *cells)
{
    if (cells == NULL)
        return;
    memory_free(cells->first);
    memory_free(cells->order);
    memory_free(cells->cell_of);
    *cells = (neighbours_cells){ 0 };
}

static double radius_of(const neighbours_parts *parts, size_t k)
{
    return parts->radius[k * parts->radius_stride];
}

static uint32_t id_of(const neighbours_parts *parts, uint32_t k)
{
    return parts->id != NULL ? parts->id[k] : k;
}

static bool is_near(const neighbours_parts *parts, double skin, size_t k, size_t other)
{
    double dx = parts->x[other * parts->stride] - parts->x[k * parts->stride];
    double dy = parts->y[other * parts->stride] - parts->y[k * parts->stride];
    double range = radius_of(parts, k) + radius_of(parts, other) + skin;

    return dx * dx + dy * dy < range * range && other != k;
}

size_t neighbours_find(const neighbours_cells *cells, const neighbours_parts *parts, double skin,
                       size_t k, uint32_t *ret, size_t step, size_t room)
{
    const size_t column = neighbours_column(cells, parts->x[k * parts->stride]);
    const size_t row = neighbours_row(cells, parts->y[k * parts->stride]);
    size_t n = 0;

    for (size_t i = column > 0 ? column - 1 : 0; i <= column + 1 && i < cells->n_x; i++)
        for (size_t j = row > 0 ? row - 1 : 0; j <= row + 1 && j < cells->n_y; j++) {
            const size_t cell = neighbours_cell(cells, i, j);
            for (uint32_t at = cells->first[cell]; at < cells->first[cell + 1]; at++) {
                uint32_t other = parts->order != NULL ? parts->order[at] : at;
                if (!is_near(parts, skin, k, other))
                    continue;
                if (n == room)
                    return SIZE_MAX;
                // Those that were found are sorted by their ids.
                const uint32_t id = id_of(parts, other);
                uint32_t *place = ret + n++ * step;
                for (; place != ret && id_of(parts, *(place - step)) > id; place -= step)
                    *place = *(place - step);
                *place = other;
            }
        }
    return n;
}

// Room for n parts. The places where parts stood are read only after a build, so they need not stay.
static bf_status reserve_parts(neighbours_list *list, size_t n)
{
    if (list->start != NULL && n <= list->parts_capacity)
        return BF_OK;
    memory_free(list->start);
    memory_free(list->x_built);
    memory_free(list->y_built);
    list->start = memory_alloc(n + 1, sizeof *list->start);
    list->x_built = memory_alloc(n, sizeof *list->x_built);
    list->y_built = memory_alloc(n, sizeof *list->y_built);
    list->parts_capacity = n;
    if (list->start != NULL && list->x_built != NULL && list->y_built != NULL)
        return BF_OK;
    memory_free(list->start);
    list->start = NULL;
    return BF_ENOMEM;
}

static bf_status list_parts(neighbours_list *list, const neighbours_parts *parts)
{
    size_t total = 0;

    if (memory_reserve(&list->neighbour, &list->capacity, list->n, sizeof *list->neighbour) != 0)
        return BF_ENOMEM;
    for (size_t k = 0; k < list->n; k++) {
        size_t n;
        if (total > UINT32_MAX)
            return BF_ENOMEM;
        list->start[k] = (uint32_t)total;
        if (list->cells.cell_of[k] == UINT32_MAX)
            continue;
        while ((n = neighbours_find(&list->cells, parts, list->skin, k, list->neighbour + total, 1,
                                    list->capacity - total)) == SIZE_MAX)
            if (memory_reserve(&list->neighbour, &list->capacity, list->capacity + 1,
                               sizeof *list->neighbour) != 0)
                return BF_ENOMEM;
        list->x_built[k] = parts->x[k * parts->stride];
        list->y_built[k] = parts->y[k * parts->stride];
        total += n;
    }
    list->start[list->n] = (uint32_t)total;
    return total > UINT32_MAX ? BF_ENOMEM : BF_OK;
}

bf_status neighbours_build(neighbours_list *list, size_t n, neighbours_parts parts,
                           const uint8_t *is_gone, bf_error *err)
{
    double largest = 0.0; // radius

    if (reserve_parts(list, n) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the neighbours of %zu parts", n);
    list->n = n;
    for (size_t k = 0; k < n; k++)
        if (is_gone == NULL || is_gone[k] == 0)
            largest = fmax(largest, radius_of(&parts, k));
    bf_status status =
        neighbours_sort(&list->cells, n, &parts, is_gone, 2.0 * largest + list->skin, err);
    if (status != BF_OK)
        return status;
    parts.order = list->cells.order;
    if (list_parts(list, &parts) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the neighbours of %zu parts", n);
    list->n_builds++;
    return BF_OK;
}

void neighbours_fini(neighbours_list *list)
{
    if (list == NULL)
        return;
    memory_free(list->start);
    memory_free(list->neighbour);
    memory_free(list->x_built);
    memory_free(list->y_built);
    neighbours_cells_fini(&list->cells);
    *list = (neighbours_list){ 0 };
}
