#include "core/scene/belt_path.h"

#include "core/base/memory.h"
#include "core/scene/belt.h"
#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// An inner corner of a path.
typedef struct corner {
    vec2 before;  ///< unit vector of the way to it
    vec2 after;   ///< and of that from it
    double angle; ///< by which the path turns, counter-clockwise, rad; 0: it goes straight on
    double cut;   ///< of the ways on both sides, up to where the arc begins and ends, m
} corner;

static vec2 direction(vec2 from, vec2 to)
{
    const vec2 way = vec2_sub(to, from);
    vec2 unit = vec2_scale(way, 1.0 / vec2_length(way));

    // Along an axis: what rounding makes of that would have its borders held on the grid.
    if (fabs(unit.x) < BELT_PATH_STRAIGHT)
        unit = (vec2){ 0.0, copysign(1.0, unit.y) };
    if (fabs(unit.y) < BELT_PATH_STRAIGHT)
        unit = (vec2){ copysign(1.0, unit.x), 0.0 };
    return unit;
}

/// Point k of a path, of its ends too, at which it does not turn.
static corner corner_of(const scene_belt_path *path, size_t k)
{
    const bool is_start = k == 0, is_end = k + 1 == path->n_points;
    corner c = { .angle = 0.0 };

    if (!is_start)
        c.before = direction(path->points[k - 1], path->points[k]);
    if (!is_end)
        c.after = direction(path->points[k], path->points[k + 1]);
    if (is_start || is_end)
        return c;
    const double angle = atan2(vec2_cross(c.before, c.after), vec2_dot(c.before, c.after));
    if (fabs(angle) < BELT_PATH_STRAIGHT)
        return c;
    c.angle = angle;
    c.cut = path->radii[k - 1] * tan(0.5 * fabs(angle));
    return c;
}

void belt_path_check(const scene_belt *belt, const char *pointer, bf_faults *faults)
{
    const scene_belt_path *path = &belt->path;
    const size_t n_before = faults->n;
    char at[BF_POINTER_SIZE + 2 * ROOM_FOR_INDEX];

    snprintf(at, sizeof at, "%s/path/width_m", pointer);
    range_check(&scene_range_length, path->width, at, faults);
    snprintf(at, sizeof at, "%s/path/points_m", pointer);
    if (path->n_points < 2 || path->n_points > SCENE_PATH_MAX)
        faults_add(faults, at, "must have 2 to %d points, not %zu", SCENE_PATH_MAX, path->n_points);
    else
        (void)scene__check_points(path->points, path->n_points, at, false, faults);
    snprintf(at, sizeof at, "%s/path/radius_m", pointer);
    if (faults->n == n_before && path->n_radii != path->n_points - 2)
        faults_add(faults, at, "must have a radius for each of the %zu inner points, not %zu",
                   path->n_points - 2, path->n_radii);
    if (faults->n > n_before)
        return;
    for (size_t k = 0; k < path->n_radii; k++) {
        const corner c = corner_of(path, k + 1);
        snprintf(at, sizeof at, "%s/path/radius_m/%zu", pointer, k);
        range_check(&scene_range_length, path->radii[k], at, faults);
        if (!(path->radii[k] - 0.5 * path->width >= SCENE_LENGTH_MIN))
            faults_add(faults, at, "must be greater than half of width_m, %.10g m",
                       0.5 * path->width);
        snprintf(at, sizeof at, "%s/path/points_m/%zu", pointer, k + 1);
        if (c.angle != 0.0 && fabs(c.angle) < BELT_ARC_LEAST)
            faults_add(faults, at, "turns the path by less than 1 degree");
        if (fabs(c.angle) > M_PI - BELT_ARC_LEAST)
            faults_add(faults, at, "turns the path back by more than 179 degrees");
    }
    for (size_t k = 1; k < path->n_points && faults->n == n_before; k++) {
        const double length = vec2_length(vec2_sub(path->points[k], path->points[k - 1]));
        const double needed = corner_of(path, k - 1).cut + corner_of(path, k).cut;
        snprintf(at, sizeof at, "%s/path/points_m/%zu", pointer, k);
        if (!(needed <= length + SCENE_TOLERANCE))
            faults_add(faults, at,
                       "is %.6g m from the point before it, and the arcs of the corners there need "
                       "%.6g m",
                       length, needed);
    }
}

static bool is_sound(const scene_belt *belt)
{
    bf_faults faults = { .n = 0 };

    belt_path_check(belt, "", &faults);
    return faults.n == 0 && isfinite(vec2_length(belt->velocity));
}

/// Make a section a straight from one place of the centre line to another.
static bf_status make_leg(scene_belt *section, vec2 start, vec2 along, double length)
{
    const scene_leg leg = { true, start, along, length, section->path.width };
    const vec2 aside = vec2_scale(vec2_turn_left(along), 0.5 * leg.width);
    const vec2 end = vec2_add(start, vec2_scale(along, length));

    section->leg = leg;
    if (section->path.n_points == 0) // the belt itself has the direction of its first leg
        section->velocity = vec2_scale(along, vec2_length(section->velocity));
    section->polygon = memory_alloc(4, sizeof *section->polygon);
    if (section->polygon == NULL)
        return BF_ENOMEM;
    section->n_points = 4;
    section->polygon[0] = vec2_sub(start, aside);
    section->polygon[1] = vec2_sub(end, aside);
    section->polygon[2] = vec2_add(end, aside);
    section->polygon[3] = vec2_add(start, aside);
    return BF_OK;
}

/// Make a section the arc of a corner at a place.
static bf_status make_arc(scene_belt *section, const corner *c, vec2 at, double radius,
                          bf_error *err)
{
    const double sign = copysign(1.0, c->angle), half = 0.5 * section->path.width;
    const vec2 start = vec2_sub(at, vec2_scale(c->before, c->cut));
    const vec2 inward = vec2_scale(vec2_turn_left(c->before), sign);

    section->centre = vec2_add(start, vec2_scale(inward, radius));
    section->arc = (scene_arc){ .is_given = true,
                                .inner_radius = radius - half,
                                .outer_radius = radius + half,
                                .from = atan2(-inward.y, -inward.x),
                                .reference_radius = radius };
    section->arc.to = section->arc.from + c->angle;
    return belt_resolve_arc(section, err);
}

/// The next section of a belt: itself, or one more.
static scene_belt *begin_section(scene *s, size_t belt, bool *is_first)
{
    scene_belt *of = &s->belts[belt];

    if (*is_first) {
        *is_first = false;
        return of;
    }
    scene_belt *section = &s->belts[s->n_sections++];
    *section = (scene_belt){ .velocity = of->velocity,
                             .path.width = of->path.width,
                             .arc.reference_radius = NAN,
                             .of = belt };
    of->n_more++;
    return section;
}

static bf_status lay_out(scene *s, size_t belt, bf_error *err)
{
    const scene_belt_path *path = &s->belts[belt].path;
    vec2 start = path->points[0];
    bool is_first = true;
    bf_status status = BF_OK;

    s->belts[belt].first_section = s->n_sections;
    for (size_t k = 1; k < path->n_points && status == BF_OK; k++) {
        const corner c = corner_of(path, k);
        const vec2 end = vec2_sub(path->points[k], vec2_scale(c.before, c.cut));
        const double length = vec2_dot(vec2_sub(end, start), c.before);
        if (k + 1 < path->n_points && c.angle == 0.0)
            continue; // a leg goes on
        if (length > SCENE_LENGTH_MIN)
            status = make_leg(begin_section(s, belt, &is_first), start, c.before, length);
        if (status == BF_OK && c.angle != 0.0)
            status = make_arc(begin_section(s, belt, &is_first), &c, path->points[k],
                              path->radii[k - 1], err);
        start = vec2_add(path->points[k], vec2_scale(c.after, c.cut));
    }
    return status == BF_OK ? BF_OK : bf_fail(err, status, "/belts", "no memory for a path");
}

bf_status belt_path_lay_out(scene *s, bf_error *err)
{
    size_t n = s->n_belts;
    bf_status status = BF_OK;

    for (size_t k = s->n_belts; k < s->n_sections; k++)
        memory_free(s->belts[k].polygon);
    s->n_sections = s->n_belts;
    for (size_t k = 0; k < s->n_belts; k++)
        n += s->belts[k].path.n_points > 2 ? 2 * s->belts[k].path.n_points - 4 : 0;
    if (n > s->n_belts && n <= SCENE_BELTS_MAX) {
        scene_belt *belts = memory_alloc(n, sizeof *belts);
        if (belts == NULL)
            return bf_fail(err, BF_ENOMEM, "/belts", "no memory for paths");
        memcpy(belts, s->belts, s->n_belts * sizeof *belts);
        memory_free(s->belts);
        s->belts = belts;
    }
    for (size_t k = 0; k < s->n_belts && status == BF_OK && n <= SCENE_BELTS_MAX; k++) {
        scene_belt *belt = &s->belts[k];
        if (belt->path.n_points == 0 || !is_sound(belt))
            continue;
        memory_free(belt->polygon);
        belt->polygon = NULL;
        belt->n_points = belt->n_more = 0;
        belt->turn = 0.0;
        belt->arc = (scene_arc){ .reference_radius = NAN };
        belt->leg = (scene_leg){ .is_given = false };
        // A resolved belt resolves to itself: what has the direction already keeps its bits.
        const vec2 along = corner_of(&belt->path, 0).after, v = belt->velocity;
        if (!(fabs(vec2_cross(along, v)) <= 1e-12 * vec2_length(v) && vec2_dot(along, v) >= 0.0))
            belt->velocity = vec2_scale(along, vec2_length(v));
        status = lay_out(s, k, err);
    }
    return status;
}

void belt_path_hand_on(scene *s)
{
    for (size_t k = s->n_belts; k < s->n_sections; k++) {
        const scene_belt own = s->belts[k];
        scene_belt *section = &s->belts[k];
        *section = s->belts[own.of];
        section->velocity = own.velocity;
        section->turn = own.turn;
        section->centre = own.centre;
        section->arc = own.arc;
        section->path = (scene_belt_path){ .width = own.path.width };
        section->leg = own.leg;
        section->of = own.of;
        section->first_section = section->n_more = 0;
        section->n_points = own.n_points;
        section->polygon = own.polygon;
    }
}
