#include "core/run/sink_cells.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/macro/closed_lines.h"

#include <math.h>

// A closed line lies beside its obstacle's by SCENE_TOLERANCE: as far from centres on that, and farther from the place for them.
#define ON_LINE (1.5 * SCENE_TOLERANCE)
#define BESIDE  (2.0 * SCENE_TOLERANCE)

static const vec2 places[SINK_CELLS_SIDES] = { [SINK_CELLS_EAST] = { BESIDE, 0.0 },
                                               [SINK_CELLS_WEST] = { -BESIDE, 0.0 },
                                               [SINK_CELLS_NORTH] = { 0.0, BESIDE },
                                               [SINK_CELLS_SOUTH] = { 0.0, -BESIDE } };

static sink_cells_side side_of(vec2 from_line)
{
    if (fabs(from_line.x) > fabs(from_line.y))
        return from_line.x > 0.0 ? SINK_CELLS_EAST : SINK_CELLS_WEST;
    return from_line.y > 0.0 ? SINK_CELLS_NORTH : SINK_CELLS_SOUTH;
}

// The first of n rows or columns whose centre is not below x.
static size_t first_from(double lower, double d, size_t n, double x)
{
    return (size_t)fmin(fmax(ceil((x - lower) / d - 0.5), 0.0), (double)n);
}

static bool mark_line(void *context, const closed_line *l)
{
    sink_cells *cells = context;
    const bf_grid *g = &cells->grid;
    const double y_min = fmin(l->start.y, l->end.y) - ON_LINE,
                 y_max = fmax(l->start.y, l->end.y) + ON_LINE;
    const size_t end_row = first_from(g->lower2, g->d2, g->n2, y_max);

    for (size_t j = first_from(g->lower2, g->d2, g->n2, y_min); j < end_row; j++) {
        const double y = grid_x2(g, j);
        double low, high;
        if (!closed_lines_clip(l->start, l->end, y - ON_LINE, y + ON_LINE, &low, &high))
            continue;
        const size_t end = first_from(g->lower1, g->d1, g->n1, high + ON_LINE);
        for (size_t i = first_from(g->lower1, g->d1, g->n1, low - ON_LINE); i < end; i++) {
            const vec2 centre = { grid_x1(g, i), y };
            const vec2 from_line =
                vec2_sub(centre, polygon_segment_nearest(centre, l->start, l->end));
            if (vec2_length(from_line) > ON_LINE)
                continue;
            const sink_cells_side side = side_of(from_line);
            cells->sides[j * g->n1 + i] = (uint8_t)side;
            cells->has[side] = true;
        }
    }
    return false;
}

bf_status sink_cells_init(const scene *s, sink_cells *ret_cells)
{
    *ret_cells = (sink_cells){ .grid = scene_grid(s), .has = { [SINK_CELLS_CENTRE] = true } };
    ret_cells->sides = memory_alloc(grid_cells(&ret_cells->grid), sizeof *ret_cells->sides);
    if (ret_cells->sides == NULL)
        return BF_ENOMEM;
    (void)closed_lines_visit(s, mark_line, ret_cells);
    return BF_OK;
}

void sink_cells_fini(sink_cells *cells)
{
    memory_free(cells->sides);
    *cells = (sink_cells){ 0 };
}

// A visit of the cells on one side of lines.
typedef struct side_visit {
    const sink_cells *cells;
    sink_cells_side side;
    sink_visit *visit;
    void *context;
    bool goes_on;
} side_visit;

static bool visit_side(void *context, size_t j, size_t first, size_t last)
{
    side_visit *v = context;
    const uint8_t *sides = v->cells->sides + j * v->cells->grid.n1;
    size_t end;

    for (size_t begin = first; begin < last && v->goes_on; begin = end) {
        for (end = begin + 1; end < last && sides[end] == sides[begin];)
            end++;
        if (sides[begin] == v->side)
            v->goes_on = v->visit(v->context, j, begin, end);
    }
    return v->goes_on;
}

bf_status sink_cells_visit(const sink_cells *cells, const scene_sink *sink, sink_visit *visit,
                           void *context)
{
    side_visit v = { .cells = cells, .visit = visit, .context = context, .goes_on = true };
    bf_status status = BF_OK;

    for (v.side = SINK_CELLS_CENTRE; v.side < SINK_CELLS_SIDES && v.goes_on && status == BF_OK;
         v.side++) {
        bf_grid moved = cells->grid;
        moved.lower1 += places[v.side].x;
        moved.lower2 += places[v.side].y;
        if (cells->has[v.side])
            status = sink_visit_cells(sink, &moved, visit_side, &v);
    }
    return status;
}
