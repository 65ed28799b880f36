#include "core/scene/surroundings.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"

#include <float.h>
#include <math.h>
#include <string.h>

/// A sine below this, between belt and plate, is rounding: they are parallel.
#define PARALLEL 1e-12

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

vec2 surroundings_upstream(vec2 along, vec2 belt)
{
    vec2 left = vec2_turn_left(along);
    bool is_downstream = vec2_dot(left, belt) > PARALLEL * vec2_length(belt);

    return is_downstream ? vec2_scale(left, -1.0) : left;
}

surroundings_piece surroundings_piece_of(const surroundings *around, const scene_obstacle *obstacle,
                                         size_t k)
{
    vec2 start = obstacle->path[k], end = obstacle->path[k + 1], to = vec2_sub(end, start);
    double length = vec2_length(to);
    vec2 along = vec2_scale(to, 1.0 / length);

    size_t belt = surroundings_belt_at(around, vec2_add(start, vec2_scale(to, 0.5)));
    vec2 upstream = surroundings_upstream(along, surroundings_velocity_of(around, belt));
    return (surroundings_piece){ start, end, along, upstream, length, obstacle->thickness };
}

void surroundings_piece_corners(const surroundings_piece *piece, vec2 ret_corners[4])
{
    const vec2 through = vec2_scale(piece->upstream, -piece->thickness);
    const bool is_left = vec2_cross(piece->along, piece->upstream) > 0.0;

    ret_corners[0] = is_left ? piece->end : piece->start;
    ret_corners[1] = is_left ? piece->start : piece->end;
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
