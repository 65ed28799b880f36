#include "core/scene/surroundings.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"

#include <float.h>
#include <math.h>
#include <string.h>

surroundings surroundings_of(const scene *s)
{
    surroundings around = { .domain = s->domain, .n_belts = s->n_belts, .belts = s->belts };

    memcpy(around.edges, s->edges, sizeof around.edges);
    return around;
}

bf_status surroundings_copy(const surroundings *from, surroundings *ret_copy, bf_error *err)
{
    scene_belt *belts = memory_alloc(from->n_belts, sizeof *belts);

    *ret_copy = *from;
    ret_copy->n_belts = 0;
    ret_copy->belts = belts;
    for (size_t k = 0; belts != NULL && k < from->n_belts; k++) {
        const size_t n_points = from->belts[k].n_points;
        belts[k] = from->belts[k];
        belts[k].speed_schedule = (scene_speed_schedule){ .n_times = 0 };
        belts[k].polygon = memory_alloc(n_points, sizeof *belts[k].polygon);
        if (belts[k].polygon == NULL)
            break;
        if (n_points > 0)
            memcpy(belts[k].polygon, from->belts[k].polygon, n_points * sizeof *belts[k].polygon);
        ret_copy->n_belts++;
    }
    if (belts != NULL && ret_copy->n_belts == from->n_belts)
        return BF_OK;
    surroundings_fini(ret_copy);
    return bf_fail(err, BF_ENOMEM, "/belts", "no memory for the belts");
}

void surroundings_fini(surroundings *copy)
{
    for (size_t k = 0; k < copy->n_belts; k++)
        memory_free(copy->belts[k].polygon);
    memory_free((void *)copy->belts);
    *copy = (surroundings){ .n_belts = 0 };
}

size_t surroundings_belt_at(const surroundings *around, vec2 at)
{
    for (size_t k = around->n_belts; k-- > 0;) {
        const scene_belt *belt = &around->belts[k];
        if (belt->n_points == 0 ||
            polygon_holds(belt->polygon, belt->n_points, at, SCENE_TOLERANCE))
            return k;
    }
    return around->n_belts;
}

double surroundings_border_distance(const surroundings *around, vec2 at)
{
    double nearest = DBL_MAX;

    for (size_t k = 0; k < around->n_belts; k++) {
        const scene_belt *belt = &around->belts[k];
        for (size_t m = 0; m < belt->n_points; m++)
            nearest =
                fmin(nearest, polygon_segment_distance(at, belt->polygon[m],
                                                       belt->polygon[(m + 1) % belt->n_points]));
    }
    return nearest;
}

bool surroundings_is_guide(vec2 along, vec2 belt)
{
    return fabs(vec2_cross(along, belt)) <= SURROUNDINGS_GUIDE_SINE * vec2_length(belt);
}

vec2 surroundings_upstream(vec2 along, vec2 belt)
{
    vec2 left = vec2_turn_left(along);
    bool is_downstream = !surroundings_is_guide(along, belt) && vec2_dot(left, belt) > 0.0;

    return is_downstream ? vec2_scale(left, -1.0) : left;
}

/// A straight piece of a path.
typedef struct stretch {
    vec2 along;    ///< unit tangent
    double length; ///< m
    vec2 belt;     ///< velocity of the belt in its middle, m/s
} stretch;

static stretch stretch_of(const surroundings *around, vec2 start, vec2 end)
{
    const vec2 to = vec2_sub(end, start);
    const double length = vec2_length(to);
    const size_t belt = surroundings_belt_at(around, vec2_add(start, vec2_scale(to, 0.5)));

    return (stretch){ vec2_scale(to, 1.0 / length), length,
                      surroundings_velocity_of(around, belt) };
}

/// The side of piece k of a path: 1 if the left one is upstream, -1 if the right one is, 0 of a guide.
static int side_of(const surroundings *around, const scene_obstacle *obstacle, size_t k)
{
    const stretch piece = stretch_of(around, obstacle->path[k], obstacle->path[k + 1]);

    if (surroundings_is_guide(piece.along, piece.belt))
        return 0;
    return vec2_cross(piece.along, piece.belt) > 0.0 ? -1 : 1;
}

/// The side that a guide between two points of a path takes from the other pieces; 0: it is centred.
static int find_side(const surroundings *around, const scene_obstacle *obstacle, size_t first,
                     size_t last)
{
    int side = 0;

    for (size_t k = 1; k <= SURROUNDINGS_JOINED && side == 0; k++) {
        if (k <= first)
            side = side_of(around, obstacle, first - k);
        if (side == 0 && last + k < obstacle->n_points)
            side = side_of(around, obstacle, last + k - 1);
    }
    return side;
}

surroundings_piece surroundings_span_of(const surroundings *around, const scene_obstacle *obstacle,
                                        size_t first, size_t last)
{
    const vec2 start = obstacle->path[first], end = obstacle->path[last];
    const stretch way = stretch_of(around, start, end);
    surroundings_piece piece = { .start = start,
                                 .end = end,
                                 .along = way.along,
                                 .upstream = surroundings_upstream(way.along, way.belt),
                                 .length = way.length,
                                 .thickness = obstacle->thickness };

    if (!surroundings_is_guide(way.along, way.belt))
        return piece;
    const int side = find_side(around, obstacle, first, last);
    if (side < 0)
        piece.upstream = vec2_scale(piece.upstream, -1.0);
    if (side == 0)
        piece.lift = 0.5 * piece.thickness;
    return piece;
}

surroundings_piece surroundings_piece_of(const surroundings *around, const scene_obstacle *obstacle,
                                         size_t k)
{
    return surroundings_span_of(around, obstacle, k, k + 1);
}

void surroundings_piece_corners(const surroundings_piece *piece, vec2 ret_corners[4])
{
    const vec2 up = vec2_scale(piece->upstream, piece->lift);
    const vec2 through = vec2_scale(piece->upstream, -piece->thickness);
    const bool is_left = vec2_cross(piece->along, piece->upstream) > 0.0;

    ret_corners[0] = vec2_add(is_left ? piece->end : piece->start, up);
    ret_corners[1] = vec2_add(is_left ? piece->start : piece->end, up);
    ret_corners[2] = vec2_add(ret_corners[1], through);
    ret_corners[3] = vec2_add(ret_corners[0], through);
}

surroundings_line surroundings_side(const surroundings *around, scene_side side)
{
    const scene_rect *d = &around->domain;

    switch (side) {
    case SCENE_WEST:
        return (surroundings_line){ { d->x_min, d->y_min }, { 1.0, 0.0 } };
    case SCENE_EAST:
        return (surroundings_line){ { d->x_max, d->y_min }, { -1.0, 0.0 } };
    case SCENE_SOUTH:
        return (surroundings_line){ { d->x_min, d->y_min }, { 0.0, 1.0 } };
    default:
        return (surroundings_line){ { d->x_min, d->y_max }, { 0.0, -1.0 } };
    }
}
