#include "core/scene/belt.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/belt_range.h"

#include <float.h>

double belt_largest_speed(const scene_belt *belt)
{
    double largest = belt->turn == 0.0 || belt->n_points == 0 ? vec2_length(belt->velocity) : 0.0;

    for (size_t k = 0; belt->turn != 0.0 && k < belt->n_points; k++)
        largest = fmax(largest, vec2_length(belt_velocity(belt, belt->polygon[k])));
    return largest;
}

bool belt_are_forward(size_t n_belts, const scene_belt *belts)
{
    bool are = true;

    for (size_t k = 0; k < n_belts; k++)
        are = are && belts[k].velocity.y == 0.0 && belts[k].velocity.x >= 0.0 &&
              belts[k].turn == 0.0 && belts[k].incline == 0.0 && !belt_range_may_reverse(&belts[k]);
    return are;
}

bool belt_arc_spans(const scene_arc *arc, vec2 from_centre, double margin)
{
    const double after = vec2_cross(arc->rays[0], from_centre),
                 before = vec2_cross(from_centre, arc->rays[1]);

    if (belt_arc_angle(arc) <= M_PI)
        return after >= -margin && before >= -margin;
    // What is left out of more than half a turn is less than one.
    return belt_arc_angle(arc) >= 2.0 * M_PI - 1e-9 || after >= -margin || before >= -margin;
}

bool belt_lanes_span(const scene_belt *belt, vec2 at, double margin)
{
    const bool is_section = belt->path.width > 0.0;
    const double beyond = is_section ? fmax(margin, SCENE_TOLERANCE) : SCENE_TOLERANCE;

    if (belt->arc.is_given)
        return belt_arc_spans(&belt->arc, vec2_sub(at, belt->centre), beyond);
    const double along = vec2_dot(vec2_sub(at, belt->leg.start), belt->leg.along);
    return along >= -beyond && along <= belt->leg.length + beyond;
}

bool belt_holds(const scene_belt *belt, vec2 at)
{
    const scene_arc *arc = &belt->arc;

    if (!arc->is_given)
        return belt->n_points == 0 ||
               polygon_holds(belt->polygon, belt->n_points, at, SCENE_TOLERANCE);
    const vec2 from_centre = vec2_sub(at, belt->centre);
    const double radius = vec2_length(from_centre);
    return radius >= arc->inner_radius - SCENE_TOLERANCE &&
           radius <= arc->outer_radius + SCENE_TOLERANCE &&
           belt_arc_spans(arc, from_centre, SCENE_TOLERANCE);
}

double belt_border_distance(const scene_belt *belt, vec2 at)
{
    const scene_arc *arc = &belt->arc;
    const vec2 from_centre = vec2_sub(at, belt->centre);
    double nearest = DBL_MAX;

    for (size_t m = 0; !arc->is_given && m < belt->n_points; m++)
        nearest = fmin(nearest, polygon_segment_distance(at, belt->polygon[m],
                                                         belt->polygon[(m + 1) % belt->n_points]));
    if (!arc->is_given)
        return nearest;
    // Beside the ends the nearest place of a circle is one of its ends.
    for (int k = 0; k < 2; k++)
        nearest =
            fmin(nearest,
                 polygon_segment_distance(from_centre, vec2_scale(arc->rays[k], arc->inner_radius),
                                          vec2_scale(arc->rays[k], arc->outer_radius)));
    if (!belt_arc_spans(arc, from_centre, SCENE_TOLERANCE))
        return nearest;
    const double radius = vec2_length(from_centre);
    return fmin(nearest, fmin(fabs(radius - arc->inner_radius), fabs(radius - arc->outer_radius)));
}

bool belt_arc_is_far(const scene_belt *belt, vec2 at, double distance)
{
    // A chord is nearer to the centre than its circle by 1 - cos(BELT_ARC_STEP/2) of the radius.
    const double slack = 0.125 * BELT_ARC_STEP * BELT_ARC_STEP * belt->arc.outer_radius;

    return belt->arc.is_given && belt_border_distance(belt, at) > distance + slack;
}

// True if the members of an arc are within their limits.
static bool is_sound(const scene_belt *belt)
{
    const scene_arc *arc = &belt->arc;
    const double angle = belt_arc_angle(arc);

    return fabs(belt->centre.x) <= SCENE_LENGTH_MAX && fabs(belt->centre.y) <= SCENE_LENGTH_MAX &&
           arc->inner_radius >= SCENE_LENGTH_MIN && arc->outer_radius <= SCENE_LENGTH_MAX &&
           arc->outer_radius - arc->inner_radius >= SCENE_LENGTH_MIN && angle >= BELT_ARC_LEAST &&
           angle <= BELT_ARC_MOST && isfinite(vec2_length(belt->velocity)) &&
           arc->reference_radius >= arc->inner_radius && arc->reference_radius <= arc->outer_radius;
}

bf_status belt_resolve_arc(scene_belt *belt, bf_error *err)
{
    scene_arc *arc = &belt->arc;

    if (arc->is_given && isnan(arc->reference_radius))
        arc->reference_radius = 0.5 * (arc->inner_radius + arc->outer_radius);
    if (!arc->is_given || !is_sound(belt))
        return BF_OK;
    const double low = fmin(arc->from, arc->to), angle = belt_arc_angle(arc);
    const size_t n = (size_t)ceil(angle / BELT_ARC_STEP);
    vec2 *polygon = memory_alloc(2 * (n + 1), sizeof *polygon);
    if (polygon == NULL)
        return bf_fail(err, BF_ENOMEM, "/belts", "no memory for the outline of an arc");
    // Chords lie within the arc: the inner ones touch its circle in their middle.
    const double inner = arc->inner_radius / cos(0.5 * angle / (double)n);
    for (size_t k = 0; k <= n; k++) {
        const double at = low + angle * (double)k / (double)n;
        const vec2 ray = { cos(at), sin(at) };
        polygon[k] = vec2_add(belt->centre, vec2_scale(ray, arc->outer_radius));
        polygon[2 * n + 1 - k] = vec2_add(belt->centre, vec2_scale(ray, inner));
    }
    arc->rays[0] = (vec2){ cos(low), sin(low) };
    arc->rays[1] = (vec2){ cos(low + angle), sin(low + angle) };
    memory_free(belt->polygon);
    belt->polygon = polygon;
    belt->n_points = 2 * (n + 1);
    belt->turn = copysign(vec2_length(belt->velocity) / arc->reference_radius, arc->to - arc->from);
    return BF_OK;
}
