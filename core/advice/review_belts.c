#include "core/advice/review_belts.h"

#include "core/base/polygon.h"
#include "core/scene/belt_path.h"
#include "core/scene/belt_range.h"
#include "core/scene/mix.h"
#include "core/scene/placement.h"
#include "core/scene/surroundings.h"

#include <math.h>

enum {
    BORDER_POINTS = 101, ///< of a border that are looked at
};

/// Sine of the angle to a border from which on a belt runs towards it, 1 degree: corners of oblique belts are rounded.
#define TOWARDS_SINE 0.0175

/// How far beyond a border a place is off the belt, m.
#define JUST_BEYOND 1e-6

/// Most steps, of a few nanoseconds each, in which belts and plates are looked for.
#define STEPS_MAX 3e7

typedef struct borders {
    const scene *s;
    surroundings around;
    double radius;         ///< of the smallest part, m
    double steps_of_place; ///< to look at a place
    double steps;          ///< so far; beyond STEPS_MAX nothing is found any more
} borders;

static double steps_of_place(const scene *s)
{
    double steps = 1.0;

    for (size_t k = 0; k < s->n_sections; k++)
        steps += 1.0 + (double)s->belts[k].n_points;
    for (size_t k = 0; k < s->n_obstacles; k++)
        steps += 10.0 * (double)s->obstacles[k].n_points;
    return steps;
}

static bool is_in_domain(const borders *b, vec2 at)
{
    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (surroundings_excess(&b->around, (scene_side)side, at) > -SCENE_TOLERANCE)
            return false;
    }
    return true;
}

static bool is_off(const borders *b, vec2 at)
{
    return surroundings_belt_at(&b->around, at) == b->around.n_belts;
}

/// True if a plate stands across a way.
static bool is_held(const borders *b, vec2 from, vec2 to)
{
    for (size_t k = 0; k < b->s->n_obstacles; k++) {
        const scene_obstacle *o = &b->s->obstacles[k];
        for (size_t m = 0; m + 1 < o->n_points; m++) {
            if (polygon_segments_touch(from, to, o->path[m], o->path[m + 1], SCENE_TOLERANCE))
                return true;
        }
    }
    return false;
}

/// True if a belt carries cargo over a point of its border, along a unit vector, to where nothing carries it on.
static bool leaves_at(const borders *b, size_t belt, vec2 at, vec2 out, vec2 way)
{
    const vec2 beyond = vec2_add(at, vec2_scale(out, JUST_BEYOND));
    const vec2 before = vec2_sub(at, vec2_scale(out, JUST_BEYOND));

    return surroundings_belt_at(&b->around, before) == belt && is_in_domain(b, beyond) &&
           is_off(b, beyond) &&
           !is_held(b, vec2_sub(at, vec2_scale(way, 2.0 * b->radius)),
                    vec2_add(at, vec2_scale(way, b->radius)));
}

/// Returns true if something was said of the side from one corner of a belt to the next.
static bool review_side(borders *b, size_t belt, size_t corner, double turn,
                        review_warnings *ret_warnings)
{
    const scene_belt *of = &b->s->belts[belt];
    const vec2 start = of->polygon[corner], end = of->polygon[(corner + 1) % of->n_points];
    const vec2 along = vec2_sub(end, start);
    const vec2 out = vec2_scale(vec2_turn_left(along), -turn / vec2_length(along));
    const vec2 velocity = belt_velocity(of, vec2_scale(vec2_add(start, end), 0.5));
    vec2 way = vec2_scale(velocity, 1.0 / vec2_length(velocity));

    if (belt_range_may_reverse(of) && vec2_dot(way, out) < 0.0)
        way = vec2_scale(way, -1.0);
    if (!(vec2_dot(way, out) > TOWARDS_SINE))
        return false;
    for (int k = 0; k < BORDER_POINTS && b->steps <= STEPS_MAX; k++) {
        const vec2 at = vec2_add(start, vec2_scale(along, (k + 0.5) / BORDER_POINTS));
        b->steps += b->steps_of_place;
        if (!leaves_at(b, belt, at, out, way))
            continue;
        const size_t path_of = scene_belt_of(b->s, belt);
        review_explain(
            review_add(ret_warnings, "Cargo leaves the belts", "/belts/%zu/%s", path_of,
                       b->s->belts[path_of].path.n_points > 0 ? "path" : "polygon_m"),
            "The belt '%s' carries cargo over its border at (%.4g, %.4g) m to where no belt is: it "
            "falls there, and counts as fallen, not as throughput. Gaps narrower than the radius "
            "of the smallest part are bridged.",
            of->id, at.x, at.y);
        return true;
    }
    return false;
}

static bf_status review_parts(borders *b, review_warnings *ret_warnings, bf_error *err)
{
    scene_placement placed;
    size_t n_off = 0, first = 0;

    const bf_status status = placement_of(b->s, &placed, err);
    if (status != BF_OK)
        return status;
    for (size_t k = placed.n; k-- > 0 && b->steps <= STEPS_MAX;) {
        b->steps += b->steps_of_place;
        if (!is_off(b, (vec2){ placed.poses[k].x, placed.poses[k].y }))
            continue;
        first = k;
        n_off++;
    }
    if (n_off > 0 && b->steps <= STEPS_MAX) {
        review_explain(
            review_add(ret_warnings, "Cargo starts off every belt", "/initial"),
            "%zu of %zu parts start where no belt is, the first one at (%.4g, %.4g) m: they "
            "fall at once.",
            n_off, placed.n, placed.poses[first].x, placed.poses[first].y);
    }
    placement_fini(&placed);
    return BF_OK;
}

static bool is_outside(const scene *s, const scene_belt *section)
{
    if (section->n_points == 0)
        return false;
    const scene_rect of = scene_rect_around(section->polygon, section->n_points);
    return of.x_min >= s->domain.x_max || of.x_max <= s->domain.x_min ||
           of.y_min >= s->domain.y_max || of.y_max <= s->domain.y_min;
}

void review_belts_outside(const scene *s, review_warnings *ret_warnings)
{
    for (size_t k = 0; k < s->n_belts; k++) {
        bool is_one_inside = false;
        for (size_t m = 0; m < s->n_sections && !is_one_inside; m++)
            is_one_inside = scene_belt_of(s, m) == k && !is_outside(s, &s->belts[m]);
        if (is_one_inside)
            continue;
        review_explain(
            review_add(ret_warnings, "A belt lies outside of the domain", "/belts/%zu", k),
            "The belt '%s' carries nothing: the domain is %.6g m to %.6g m by %.6g m to "
            "%.6g m.",
            s->belts[k].id, s->domain.x_min, s->domain.x_max, s->domain.y_min, s->domain.y_max);
    }
}

bf_status review_belts(const scene *s, review_warnings *ret_warnings, bf_error *err)
{
    borders b = { .s = s,
                  .around = surroundings_of(s),
                  .radius = mix_radii_of(s).smallest,
                  .steps_of_place = steps_of_place(s) };

    if (!s->may_drop)
        return BF_OK;
    for (size_t k = 0; k < s->n_sections; k++) {
        const scene_belt *belt = &s->belts[k];
        const double turn =
            belt->n_points > 0 ? copysign(1.0, polygon_area(belt->polygon, belt->n_points)) : 0.0;
        bool is_said = false;
        for (size_t m = 0; m < belt->n_points && !is_said; m++)
            is_said = review_side(&b, k, m, turn, ret_warnings);
    }
    return review_parts(&b, ret_warnings, err);
}
