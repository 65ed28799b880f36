#include "core/run/sink_cells.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/macro/closed_lines.h"

#include <math.h>

// A closed line is its obstacle's path moved by SCENE_TOLERANCE, so a centre on the path is that far from the line: with rounding
// within ON_LINE of it. The sink's outline may lie on the path as well: BESIDE away a point is clearly on one side of that.
#define ON_LINE (1.5 * SCENE_TOLERANCE)
#define BESIDE  (2.0 * SCENE_TOLERANCE)

// Where sinks are looked up for a cell, from its centre.
static const vec2 offsets[SINK_CELLS_SIDES] = { [SINK_CELLS_EAST] = { BESIDE, 0.0 },
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
    return grid_clamp(ceil((x - lower) / d - 0.5), n);
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

double sink_cells_steps(const scene *s)
{
    const bf_grid g = scene_grid(s);
    const double n1 = (double)g.n1, n2 = (double)g.n2;
    double steps = 0.0;

    // sink_visit_cells(): each row with each side.
    for (size_t k = 0; k < s->n_sinks; k++)
        steps += n2 * (double)s->sinks[k].n_points;
    // mark_line(): each row that a piece crosses, and the columns beside it there.
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        for (size_t m = 0; closed_lines_has(s, o) && m + 1 < o->n_points; m++) {
            const vec2 along = vec2_sub(o->path[m + 1], o->path[m]);
            steps += fmin(fabs(along.x) / g.d1, n1) + fmin(fabs(along.y) / g.d2, n2);
        }
    }
    return steps;
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
        moved.lower1 += offsets[v.side].x;
        moved.lower2 += offsets[v.side].y;
        if (cells->has[v.side])
            status = sink_visit_cells(sink, &moved, visit_side, &v);
    }
    return status;
}
