#include "core/macro/closed_lines.h"

#include "core/base/polygon.h"
#include "core/scene/belt_range.h"

#include <math.h>

bool closed_lines_has(const scene *s, const scene_obstacle *obstacle)
{
    return s->macro.closure == SCENE_CONGESTED || obstacle->treatment != SCENE_FIELD;
}

/// How far the line is moved for the links.
static vec2 shift_of(const surroundings *around, const scene_obstacle *obstacle)
{
    // The line is the same whatever happens: cargo beside it is then still on its side.
    const bool moves = scene_obstacle_moves(obstacle) ||
                       belt_range_may_reverse_any(around->n_belts, around->belts);
    vec2 sum = { 0.0, 0.0 }, first = { 0.0, 0.0 };
    double length = 0.0;

    for (size_t k = 0; k + 1 < obstacle->n_points; k++) {
        surroundings_piece piece = surroundings_piece_of(around, obstacle, k);
        vec2 normal = moves ? vec2_turn_left(piece.along) : piece.upstream;
        first = k == 0 ? normal : first;
        sum = vec2_add(sum, vec2_scale(normal, piece.length));
        length += piece.length;
    }
    double size = vec2_length(sum);
    // Pieces with normals in all directions, like those of a closed path, have no common upstream side.
    vec2 upstream = size > 1e-6 * length ? vec2_scale(sum, 1.0 / size) : first;
    return vec2_scale(upstream, -SCENE_TOLERANCE);
}

bool closed_lines_visit_one(const surroundings *around, const scene_obstacle *obstacle,
                            closed_lines_fn *visit, void *context)
{
    vec2 shift = shift_of(around, obstacle);

    for (size_t m = 0; m + 1 < obstacle->n_points; m++) {
        surroundings_piece piece = surroundings_piece_of(around, obstacle, m);
        vec2 start = vec2_add(piece.start, shift);
        vec2 before = vec2_scale(piece.along, -SCENE_TOLERANCE);
        vec2 to = vec2_scale(piece.along, piece.length + SCENE_TOLERANCE);
        closed_line l = { vec2_add(start, before), vec2_add(start, to) };
        if (visit(context, &l))
            return true;
    }
    return false;
}

bool closed_lines_visit(const scene *s, closed_lines_fn *visit, void *context)
{
    const surroundings around = surroundings_of(s);

    for (size_t k = 0; k < s->n_obstacles; k++)
        if (closed_lines_has(s, &s->obstacles[k]) &&
            closed_lines_visit_one(&around, &s->obstacles[k], visit, context))
            return true;
    return false;
}

bool closed_line_crosses(const closed_line *l, vec2 from, vec2 to)
{
    return polygon_segments_touch(from, to, l->start, l->end, CLOSED_LINES_TOUCH);
}

bool closed_lines_clip(vec2 a, vec2 b, double low, double high, double *ret_low, double *ret_high)
{
    double from = 0.0, to = 1.0;

    if (fmax(a.y, b.y) < low || fmin(a.y, b.y) > high)
        return false;
    if (a.y != b.y) {
        double at_low = (low - a.y) / (b.y - a.y), at_high = (high - a.y) / (b.y - a.y);
        from = fmin(fmax(fmin(at_low, at_high), 0.0), 1.0);
        to = fmax(fmin(fmax(at_low, at_high), 1.0), 0.0);
    }
    double x_from = a.x + from * (b.x - a.x), x_to = a.x + to * (b.x - a.x);
    *ret_low = fmin(x_from, x_to);
    *ret_high = fmax(x_from, x_to);
    return true;
}
