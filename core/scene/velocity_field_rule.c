// The rules of the static field and of shut lines, point by point.
//
// Watertight: a link between cell centres is shut if it touches the line, so that no way along links
// leads across a line that ends at walls or is closed. But where a cell centre lies on the line itself
// all its links touch it, and the cell would be cut off. Therefore the links look at the line moved
// downstream by the tolerance, as one piece with its corners: cell centres on the line lie upstream of
// it, as in the rules of the regions, and the moved line is as tight as the line is.

#include "core/scene/velocity_field.h"

#include "core/base/polygon.h"
#include "core/scene/velocity_field_priv.h"

#include <math.h>

/// Nearer than this a link touches a line, m: well above rounding, well below the move.
#define TOUCH (0.1 * SCENE_TOLERANCE)

/// A sine below this, between belt and line, is rounding: they are parallel.
#define PARALLEL 1e-12

field__segment velocity_field__segment_of(const scene_obstacle *obstacle, size_t k)
{
    vec2 to = vec2_sub(obstacle->path[k + 1], obstacle->path[k]);
    double length = vec2_length(to);

    return (field__segment){ obstacle, obstacle->path[k], vec2_scale(to, 1.0 / length), length };
}

void velocity_field__levels(const scene_obstacle *obstacle, double ret_levels[3])
{
    bool is_sealed = obstacle->treatment == SCENE_SEALED;

    ret_levels[0] = obstacle->treatment == SCENE_FIELD ? -obstacle->thickness : 0.0;
    ret_levels[1] = is_sealed ? obstacle->band : 0.0;
    ret_levels[2] = ret_levels[1] + obstacle->slide_width;
}

/// Unit normal on the upstream side for a belt velocity; t turned left where there is none.
static vec2 find_upstream(const field__segment *segment, vec2 belt)
{
    vec2 left = vec2_turn_left(segment->along);
    bool is_downstream = vec2_dot(left, belt) > PARALLEL * vec2_length(belt);

    return is_downstream ? vec2_scale(left, -1.0) : left;
}

static vec2 find_belt_velocity(const scene *s, vec2 at)
{
    for (size_t k = s->n_belts; k-- > 0;) {
        const scene_belt *belt = &s->belts[k];
        if (belt->n_points == 0 ||
            polygon_holds(belt->polygon, belt->n_points, at, SCENE_TOLERANCE))
            return belt->velocity;
    }
    return (vec2){ 0.0, 0.0 };
}

vec2 velocity_field_upstream(const scene *s, const scene_obstacle *obstacle, size_t k)
{
    field__segment segment = velocity_field__segment_of(obstacle, k);
    vec2 middle = vec2_add(segment.start, vec2_scale(segment.along, 0.5 * segment.length));

    return find_upstream(&segment, find_belt_velocity(s, middle));
}

field__verdict velocity_field__begin(const scene *s, vec2 at)
{
    vec2 belt = find_belt_velocity(s, at);
    return (field__verdict){ FIELD__FREE, belt, belt };
}

static field__region find_region(const field__segment *segment, vec2 upstream, vec2 at)
{
    vec2 to = vec2_sub(at, segment->start);
    double a = vec2_dot(to, segment->along), d = vec2_dot(to, upstream), level[3];

    if (a < -SCENE_TOLERANCE || a > segment->length + SCENE_TOLERANCE)
        return FIELD__FREE;
    velocity_field__levels(segment->obstacle, level);
    if (d < level[0] - SCENE_TOLERANCE || d > level[2] + SCENE_TOLERANCE)
        return FIELD__FREE;
    return d < level[1] - SCENE_TOLERANCE ? FIELD__OUTWARD : FIELD__SLIDE;
}

void velocity_field__consider(field__verdict *verdict, const field__segment *segment, vec2 at)
{
    vec2 belt = verdict->belt, upstream = find_upstream(segment, belt);
    field__region region = find_region(segment, upstream, at);

    if (region <= verdict->region)
        return;
    verdict->region = region;
    verdict->velocity = region == FIELD__OUTWARD
                            ? vec2_scale(upstream, vec2_length(belt))
                            : vec2_scale(segment->along, vec2_dot(belt, segment->along));
}

vec2 velocity_field_at(const scene *s, vec2 at)
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

vec2 velocity_field__shift(const scene *s, const scene_obstacle *obstacle)
{
    vec2 sum = { 0.0, 0.0 }, first = { 0.0, 0.0 };
    double length = 0.0;

    for (size_t k = 0; k + 1 < obstacle->n_points; k++) {
        field__segment segment = velocity_field__segment_of(obstacle, k);
        vec2 upstream = velocity_field_upstream(s, obstacle, k);
        first = k == 0 ? upstream : first;
        sum = vec2_add(sum, vec2_scale(upstream, segment.length));
        length += segment.length;
    }
    double size = vec2_length(sum);
    // Pieces that face all ways, like those of a closed path, have no common upstream side.
    vec2 upstream = size > 1e-6 * length ? vec2_scale(sum, 1.0 / size) : first;
    return vec2_scale(upstream, -SCENE_TOLERANCE);
}

field__line velocity_field__line_of(const field__segment *segment, vec2 shift)
{
    vec2 start = vec2_add(segment->start, shift);
    vec2 before = vec2_scale(segment->along, -SCENE_TOLERANCE);
    vec2 to = vec2_scale(segment->along, segment->length + SCENE_TOLERANCE);

    return (field__line){ vec2_add(start, before), vec2_add(start, to) };
}

bool velocity_field__crosses(const field__line *line, vec2 from, vec2 to)
{
    return polygon_segments_touch(from, to, line->start, line->end, TOUCH);
}

bool velocity_field_is_shut(const scene *s, vec2 from, vec2 to)
{
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *obstacle = &s->obstacles[k];
        if (!velocity_field__is_shutting(obstacle))
            continue;
        vec2 shift = velocity_field__shift(s, obstacle);
        for (size_t m = 0; m + 1 < obstacle->n_points; m++) {
            field__segment segment = velocity_field__segment_of(obstacle, m);
            field__line line = velocity_field__line_of(&segment, shift);
            if (velocity_field__crosses(&line, from, to))
                return true;
        }
    }
    return false;
}
