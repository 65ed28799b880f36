#include "core/scene/sink.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"

#include <math.h>
#include <stdlib.h>

bool sink_takes(const scene_sink *sink, size_t kind)
{
    bool takes = sink->n_kinds == 0;

    for (size_t k = 0; k < sink->n_kinds; k++)
        takes = takes || sink->kinds[k] == kind;
    return takes;
}

static int compare_numbers(const void *left, const void *right)
{
    const double *a = left, *b = right;

    return (*a > *b) - (*a < *b);
}

// Where the outline crosses the line at y, rising. Returns how often: an even number, as corners on the line count as above it.
static size_t find_crossings(const scene_sink *sink, double y, double *ret_x)
{
    size_t n = 0;

    for (size_t k = 0; k < sink->n_points; k++) {
        const vec2 a = sink->polygon[k], b = sink->polygon[(k + 1) % sink->n_points];
        if ((a.y < y) != (b.y < y))
            ret_x[n++] = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    }
    qsort(ret_x, n, sizeof *ret_x, compare_numbers);
    return n;
}

// The first of n columns whose centre is not west of x.
static size_t column_from(const bf_grid *g, double x)
{
    return (size_t)fmin(fmax(ceil((x - g->lower1) / g->d1 - 0.5), 0.0), (double)g->n1);
}

bf_status sink_visit_cells(const scene_sink *sink, const bf_grid *grid, sink_visit *visit,
                           void *context)
{
    double *x = memory_alloc(sink->n_points, sizeof *x);
    bool goes_on = true;

    if (x == NULL)
        return BF_ENOMEM;
    for (size_t j = 0; j < grid->n2 && goes_on; j++) {
        const size_t n = find_crossings(sink, grid_x2(grid, j), x);
        for (size_t k = 0; k + 1 < n && goes_on; k += 2) {
            const size_t first = column_from(grid, x[k]), last = column_from(grid, x[k + 1]);
            goes_on = first >= last || visit(context, j, first, last);
        }
    }
    memory_free(x);
    return BF_OK;
}

size_t sink_at(const scene *s, vec2 at, size_t kind)
{
    for (size_t k = s->n_sinks; k-- > 0;)
        if (sink_takes(&s->sinks[k], kind) &&
            polygon_holds(s->sinks[k].polygon, s->sinks[k].n_points, at, 0.0))
            return k;
    return s->n_sinks;
}
