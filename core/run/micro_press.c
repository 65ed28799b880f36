#include "core/run/micro_press.h"

#include "core/base/polygon.h"
#include "core/micro/hardness.h"
#include "core/scene/mix.h"
#include "core/scene/plate_range.h"

#include <math.h>
#include <stdio.h>

static const char no_way_out[] =
    "the plate moves into cargo that has no way out: let it move slower or less far";

// How far a place is from obstacle k: from its path, or where that may come to, m.
static double distance_of(const scene *s, size_t k, vec2 at)
{
    const scene_obstacle *o = &s->obstacles[k];
    const plate_range places = plate_range_of(s->obstacles, k, s->n_actions, s->actions);
    double nearest = HUGE_VAL;

    for (size_t m = 1; m < o->n_points; m++)
        nearest = fmin(nearest, polygon_segment_distance(at, o->path[m - 1], o->path[m]));
    nearest -= o->thickness;
    return places.moves
               ? fmin(nearest, plate_range_distance(&places, o->pivot, at) - plate_range_radius(o))
               : nearest;
}

// The obstacle nearest to a place within a range; with only_moving, of those that move. n_obstacles: none.
static size_t find_plate(const scene *s, vec2 at, double range, bool only_moving)
{
    size_t found = s->n_obstacles;

    for (size_t k = 0; k < s->n_obstacles; k++) {
        const double distance = distance_of(s, k, at);
        if (distance > range || (only_moving && !scene_obstacle_moves(&s->obstacles[k])))
            continue;
        range = distance;
        found = k;
    }
    return found;
}

// What moves obstacle k: its own motion, or else actions or when it is there.
static void point_at(const scene *s, size_t k, char pointer[BF_POINTER_SIZE])
{
    (void)snprintf(pointer, BF_POINTER_SIZE, "/obstacles/%zu%s", k,
                   s->obstacles[k].turn.n_times > 0 ? "/motion" : "");
}

// Whether a belt and a plate or wall can lock a part with sides between them: each presses it onto the other by its friction,
// which grows without bound where the product of both is above 1.
static bool can_wedge(const scene *s)
{
    const scene_contact *contact = s->micro.contact;
    double belts = 0.0;
    bool has_sides = false;

    for (size_t k = 0; k < s->n_belts; k++)
        belts = fmax(belts, s->belts[k].friction > 0.0 ? s->belts[k].friction
                                                       : contact[SCENE_CONVEYOR_CARGO].friction);
    for (size_t k = 0; k < s->n_cargo; k++)
        has_sides = has_sides || s->cargo[k].shape.type != SCENE_CYLINDER;
    return has_sides && belts * contact[SCENE_HANDLING_CARGO].friction > 1.0;
}

bf_status micro_press_fail(const scene *s, const micro_press *press, double t, bf_error *err)
{
    const size_t at = find_plate(s, press->at, mix_radii_of(s).largest, false);
    const scene_obstacle *plate = at < s->n_obstacles ? &s->obstacles[at] : NULL;
    const bool is_between_parts = press->other != UINT64_MAX;
    const char *change;
    char into[SCENE_ID_SIZE + 32] = "a wall", pointer[BF_POINTER_SIZE] = "/micro/modulus_reduction";

    if (is_between_parts)
        snprintf(into, sizeof into, "part %llu", (unsigned long long)press->other);
    else if (plate != NULL)
        snprintf(into, sizeof into, "the plate '%s'", plate->id);
    if (plate != NULL && scene_obstacle_moves(plate)) {
        point_at(s, at, pointer);
        change = no_way_out;
    } else if (s->micro.modulus_reduction > 0.0) {
        change =
            "parts are too soft for what presses on them: leave modulus_reduction out, or make "
            "it smaller";
    } else if (mix_mass_ratio(s) > hardness_masses_most) {
        snprintf(pointer, sizeof pointer, "/cargo");
        change =
            "the masses of the kinds differ so much that light parts are squeezed by heavy ones "
            "faster than contacts follow: give them masses that are more alike";
    } else if (!is_between_parts && can_wedge(s)) {
        snprintf(pointer, sizeof pointer, "/contacts/handling_cargo/friction");
        change = "belt and plate wedge the part, since the product of their frictions is above 1: "
                 "give one of them a smaller friction";
    } else {
        change = "parts are pressed harder than their materials bear: a shorter step_s or a larger "
                 "young_modulus_pa may help";
    }
    return bf_fail(err, BF_ENUMERIC, pointer,
                   "part %llu is pressed into %s by %.3g %% of a radius at (%.4g, %.4g) m after "
                   "%.4g s, more than overlap_limit, %.3g %%: %s",
                   (unsigned long long)press->part, into, 100.0 * press->overlap, press->at.x,
                   press->at.y, t, 100.0 * s->micro.overlap_limit, change);
}

bf_status micro_press_fail_thrown(const scene *s, const micro_thrown *thrown, double t,
                                  bf_error *err)
{
    const double range = 3.0 * mix_radii_of(s).largest; // a diameter from its edge
    const size_t at = find_plate(s, thrown->at, range, true);
    char pointer[BF_POINTER_SIZE];

    if (at == s->n_obstacles)
        return BF_ENUMERIC;
    point_at(s, at, pointer);
    return bf_fail(err, BF_ENUMERIC, pointer,
                   "part %llu was squeezed out by the plate '%s' with %.3g m/s at (%.4g, %.4g) m "
                   "after %.4g s: %s, or leave no room "
                   "behind it that a part slips into",
                   (unsigned long long)thrown->part, s->obstacles[at].id, thrown->speed,
                   thrown->at.x, thrown->at.y, t, no_way_out);
}
