// The rules of the static field and of shut lines, point by point.
//
// Watertight: a link between cell centres is shut if it touches the line, so that no way along links
// leads across a line that ends at walls or is closed. But where a cell centre lies on the line itself
// all its links touch it, and the cell would be cut off. Therefore the links look at the line moved
// downstream by the tolerance, as one piece with its corners: cell centres on the line lie upstream of
// it, as in the rules of the regions, and the moved line is as tight as the line is.

#include "core/scene/velocity_field.h"

#include "core/scene/geometry.h"
#include "core/scene/velocity_field_priv.h"

#include <math.h>

/// Nearer than this a link touches a line, m: well above rounding, well below the move.
#define TOUCH (0.1 * SCENE_TOLERANCE)

/// A sine below this, between belt and line, is rounding: they are parallel.
#define PARALLEL 1e-12

field__segment velocity_field__segment_of(const scene_obstacle *obstacle, size_t k)
{
    scene_point to = geometry_subtract(obstacle->path[k + 1], obstacle->path[k]);
    double length = geometry_length(to);

    return (field__segment){ obstacle, obstacle->path[k], geometry_scale(to, 1.0 / length),
                             length };
}

void velocity_field__levels(const scene_obstacle *obstacle, double ret_levels[3])
{
    bool is_sealed = obstacle->treatment == SCENE_SEALED;

    ret_levels[0] = obstacle->treatment == SCENE_FIELD ? -obstacle->thickness : 0.0;
    ret_levels[1] = is_sealed ? obstacle->band : 0.0;
    ret_levels[2] = ret_levels[1] + obstacle->slide_width;
}

/// Unit normal on the upstream side for a belt velocity; t turned left where there is none.
static scene_point find_upstream(const field__segment *segment, scene_point belt)
{
    scene_point left = geometry_turn_left(segment->along);
    bool is_downstream = geometry_dot(left, belt) > PARALLEL * geometry_length(belt);

    return is_downstream ? geometry_scale(left, -1.0) : left;
}

static scene_point find_belt_velocity(const scene *s, scene_point at)
{
    for (size_t k = s->n_belts; k-- > 0;) {
        const scene_belt *belt = &s->belts[k];
        if (belt->n_points == 0 ||
            geometry_polygon_holds(belt->polygon, belt->n_points, at, SCENE_TOLERANCE))
            return belt->velocity;
    }
    return (scene_point){ 0.0, 0.0 };
}

scene_point velocity_field_upstream(const scene *s, const scene_obstacle *obstacle, size_t k)
{
    field__segment segment = velocity_field__segment_of(obstacle, k);
    scene_point middle =
        geometry_add(segment.start, geometry_scale(segment.along, 0.5 * segment.length));

    return find_upstream(&segment, find_belt_velocity(s, middle));
}

field__verdict velocity_field__begin(const scene *s, scene_point at)
{
    scene_point belt = find_belt_velocity(s, at);
    return (field__verdict){ FIELD__FREE, belt, belt };
}

static field__region find_region(const field__segment *segment, scene_point upstream,
                                 scene_point at)
{
    scene_point to = geometry_subtract(at, segment->start);
    double a = geometry_dot(to, segment->along), d = geometry_dot(to, upstream), level[3];

    if (a < -SCENE_TOLERANCE || a > segment->length + SCENE_TOLERANCE)
        return FIELD__FREE;
    velocity_field__levels(segment->obstacle, level);
    if (d < level[0] - SCENE_TOLERANCE || d > level[2] + SCENE_TOLERANCE)
        return FIELD__FREE;
    return d < level[1] - SCENE_TOLERANCE ? FIELD__OUTWARD : FIELD__SLIDE;
}

void velocity_field__consider(field__verdict *verdict, const field__segment *segment,
                              scene_point at)
{
    scene_point belt = verdict->belt, upstream = find_upstream(segment, belt);
    field__region region = find_region(segment, upstream, at);

    if (region <= verdict->region)
        return;
    verdict->region = region;
    verdict->velocity = region == FIELD__OUTWARD
                            ? geometry_scale(upstream, geometry_length(belt))
                            : geometry_scale(segment->along, geometry_dot(belt, segment->along));
}

scene_point velocity_field_at(const scene *s, scene_point at)
{
    field__verdict verdict = velocity_field__begin(s, at);

    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points; m++) {
            field__segment segment = velocity_field__segment_of(&s->obstacles[k], m);
            velocity_field__consider(&verdict, &segment, at);
        }
    }
    return verdict.velocity;
}

bool velocity_field__is_shutting(const scene_obstacle *obstacle)
{
    return obstacle->treatment != SCENE_FIELD;
}

scene_point velocity_field__shift(const scene *s, const scene_obstacle *obstacle)
{
    scene_point sum = { 0.0, 0.0 }, first = { 0.0, 0.0 };
    double length = 0.0;

    for (size_t k = 0; k + 1 < obstacle->n_points; k++) {
        field__segment segment = velocity_field__segment_of(obstacle, k);
        scene_point upstream = velocity_field_upstream(s, obstacle, k);
        first = k == 0 ? upstream : first;
        sum = geometry_add(sum, geometry_scale(upstream, segment.length));
        length += segment.length;
    }
    double size = geometry_length(sum);
    // Pieces that face all ways, like those of a closed path, have no common upstream side.
    scene_point upstream = size > 1e-6 * length ? geometry_scale(sum, 1.0 / size) : first;
    return geometry_scale(upstream, -SCENE_TOLERANCE);
}

field__line velocity_field__line_of(const field__segment *segment, scene_point shift)
{
    scene_point start = geometry_add(segment->start, shift);
    scene_point before = geometry_scale(segment->along, -SCENE_TOLERANCE);
    scene_point to = geometry_scale(segment->along, segment->length + SCENE_TOLERANCE);

    return (field__line){ geometry_add(start, before), geometry_add(start, to) };
}

bool velocity_field__crosses(const field__line *line, scene_point from, scene_point to)
{
    return geometry_segments_touch(from, to, line->start, line->end, TOUCH);
}

bool velocity_field_is_shut(const scene *s, scene_point from, scene_point to)
{
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *obstacle = &s->obstacles[k];
        if (!velocity_field__is_shutting(obstacle))
            continue;
        scene_point shift = velocity_field__shift(s, obstacle);
        for (size_t m = 0; m + 1 < obstacle->n_points; m++) {
            field__segment segment = velocity_field__segment_of(obstacle, m);
            field__line line = velocity_field__line_of(&segment, shift);
            if (velocity_field__crosses(&line, from, to))
                return true;
        }
    }
    return false;
}
