#include "core/advice/review_plates.h"

#include "core/scene/placement.h"
#include "core/scene/plate_range.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdio.h>

enum { LINE_POINTS = 101 }; ///< of a feed's line that are looked at

/// Most steps, of a few nanoseconds each, in which belts and plates are looked for.
#define STEPS_MAX 3e7

typedef struct plates {
    const scene *s;
    surroundings around;
    scene_placement placement;
    double steps_of_lookup; ///< to find the belt under a point
    double steps;           ///< so far; beyond STEPS_MAX nothing is found any more
} plates;

/// A plate and the direction of the belt under it.
typedef struct plate {
    const scene_obstacle *obstacle;
    vec2 belt; ///< unit vector
} plate;

static double steps_of_lookup(const scene *s)
{
    double steps = 1.0;

    for (size_t k = 0; k < s->n_sections; k++)
        steps += 1.0 + (double)s->belts[k].n_points;
    return steps;
}

static vec2 direction_of(plates *p, vec2 at)
{
    const vec2 v = surroundings_velocity_under(&p->around, at);
    const double speed = vec2_length(v);

    p->steps += p->steps_of_lookup;
    return speed > 0.0 ? vec2_scale(v, 1.0 / speed) : v;
}

static bool is_beyond(const plates *p, vec2 at)
{
    return surroundings_is_outside(&p->around, at);
}

/// True if a plate lies on the line from a place along the belt, ahead of it or back from it.
static void find_around(plates *p, const plate *of, vec2 at, bool *ret_ahead, bool *ret_back)
{
    for (size_t k = 0; k + 1 < of->obstacle->n_points; k++) {
        const vec2 start = of->obstacle->path[k];
        const vec2 piece = vec2_sub(of->obstacle->path[k + 1], start), to = vec2_sub(at, start);
        const double sine = vec2_cross(of->belt, piece);
        if (fabs(sine) <= SURROUNDINGS_GUIDE_SINE * vec2_length(piece))
            continue;
        const double place = vec2_cross(of->belt, to) / sine, back = vec2_cross(to, piece) / sine;
        if (place < 0.0 || place > 1.0)
            continue;
        // The belt there is the one that the plate is looked at for. Plates go on beyond open sides.
        const vec2 crossing = vec2_sub(at, vec2_scale(of->belt, back));
        const vec2 own = direction_of(p, crossing);
        if (!is_beyond(p, crossing) && !(vec2_dot(own, of->belt) > 1.0 - SURROUNDINGS_GUIDE_SINE))
            continue;
        *(back > 0.0 ? ret_back : ret_ahead) = true;
    }
}

static bool is_behind(plates *p, const scene_obstacle *obstacle, vec2 at)
{
    const plate of = { obstacle, direction_of(p, at) };
    bool is_ahead = false, is_back = false;

    p->steps += (double)obstacle->n_points;
    if (p->steps <= STEPS_MAX && vec2_length(of.belt) > 0.0)
        find_around(p, &of, at, &is_ahead, &is_back);
    return is_back && !is_ahead;
}

/// A place for people, in whole tenths of a millimetre: a foot that an angle gives is only nearly at 0.
static vec2 rounded(vec2 at)
{
    return (vec2){ round(at.x * 1e4) / 1e4 + 0.0, round(at.y * 1e4) / 1e4 + 0.0 };
}

/// Write why cargo at a place is behind a plate.
static void explain_foot(plates *p, const scene_obstacle *obstacle, vec2 at, char *ret_text,
                         size_t size)
{
    // The foot is the end that lies upstream, at which cargo gets behind the plate.
    const vec2 first = obstacle->path[0], last = obstacle->path[obstacle->n_points - 1];
    const bool ends_upstream = vec2_dot(vec2_sub(last, first), direction_of(p, at)) < 0.0;
    const vec2 foot = ends_upstream ? last : first, said = rounded(foot);
    const bool is_off =
        is_beyond(p, foot) || surroundings_belt_at(&p->around, foot) == p->around.n_belts;

    snprintf(ret_text, size, "its foot %s, at (%.3g, %.3g) m",
             is_off ? "lies off the belt" : "stands too far upstream", said.x, said.y);
}

static void review_parts(plates *p, size_t k, review_warnings *ret_warnings)
{
    const scene_obstacle *obstacle = &p->s->obstacles[k];
    char why[128];
    size_t n_behind = 0;
    vec2 found = { 0.0, 0.0 };

    for (size_t i = 0; i < p->placement.n; i++) {
        const vec2 at = { p->placement.poses[i].x, p->placement.poses[i].y };
        if (!is_behind(p, obstacle, at))
            continue;
        found = at;
        n_behind++;
    }
    if (n_behind == 0 || p->steps > STEPS_MAX)
        return;
    explain_foot(p, obstacle, found, why, sizeof why);
    review_explain(review_add(ret_warnings, "Cargo starts behind a deflector", "/obstacles/%zu", k),
                   "%zu of %zu parts start behind '%s', which does not hold them back: %s.",
                   n_behind, p->placement.n, obstacle->id, why);
}

/// A feed on a line inside may deliver behind a plate on purpose: then all of its line is there.
static void review_feed(plates *p, size_t k, const scene_feed *feed, review_warnings *ret_warnings)
{
    const scene_obstacle *obstacle = &p->s->obstacles[k];
    char why[128];
    size_t n_behind = 0;
    vec2 found = { 0.0, 0.0 };

    for (int i = 0; i < LINE_POINTS; i++) {
        const double place = (i + 0.5) / LINE_POINTS;
        const vec2 line = vec2_sub(feed->line[1], feed->line[0]);
        const vec2 at = vec2_add(feed->line[0], vec2_scale(line, place));
        if (!is_behind(p, obstacle, at))
            continue;
        found = at;
        n_behind++;
    }
    if (n_behind == 0 || (n_behind == LINE_POINTS && !feed->is_edge) || p->steps > STEPS_MAX)
        return;
    explain_foot(p, obstacle, found, why, sizeof why);
    review_explain(
        review_add(ret_warnings, "Cargo enters behind a deflector", "/obstacles/%zu", k),
        "%zu %% of the line of the feed '%s' lie behind '%s', which does not hold back what "
        "enters there: %s.",
        (100 * n_behind + LINE_POINTS / 2) / LINE_POINTS, feed->id, obstacle->id, why);
}

/// True if the belt runs over the open side beyond which a place lies.
static bool leaves_there(const plates *p, vec2 at, vec2 belt)
{
    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        const vec2 inward = surroundings_side(&p->around, (scene_side)side).inward;
        if (p->around.edges[side] == SCENE_EDGE_OUTFLOW &&
            surroundings_excess(&p->around, (scene_side)side, at) > SCENE_TOLERANCE &&
            vec2_dot(inward, belt) < -SURROUNDINGS_GUIDE_SINE)
            return true;
    }
    return false;
}

/// Warn of the piece at an end of a plate if it leads cargo beyond the end of the belt.
static bool review_end(plates *p, size_t k, vec2 before, vec2 end, review_warnings *ret_warnings)
{
    const vec2 belt = direction_of(p, before), piece = vec2_sub(end, before);

    if (is_beyond(p, before) || vec2_dot(piece, belt) <= 0.0 ||
        fabs(vec2_cross(piece, belt)) <= SURROUNDINGS_GUIDE_SINE * vec2_length(piece) ||
        !leaves_there(p, end, belt))
        return false;
    const vec2 said = rounded(end);
    review_explain(
        review_add(ret_warnings, "A deflector ends off the belt", "/obstacles/%zu", k),
        "'%s' leads cargo to its end at (%.3g, %.3g) m, which lies off the belt: cargo passes "
        "it where the belt ends.",
        p->s->obstacles[k].id, said.x, said.y);
    return true;
}

/// Warn of a plate that is shifted so far that no part of it comes within its own length of the domain, at pointer.
static bool review_shift(const plates *p, size_t k, vec2 shift, const char *pointer,
                         review_warnings *ret_warnings)
{
    const scene_obstacle *o = &p->s->obstacles[k];
    const double radius = plate_range_radius(o);
    const scene_rect *d = &p->s->domain;
    const vec2 pivot = vec2_add(o->pivot, shift);
    const vec2 to = { fmax(fmax(d->x_min - pivot.x, pivot.x - d->x_max), 0.0),
                      fmax(fmax(d->y_min - pivot.y, pivot.y - d->y_max), 0.0) };

    if (vec2_length(to) <= 2.0 * radius)
        return false;
    review_explain(
        review_add(ret_warnings, "A plate is shifted far off the line", "%s", pointer),
        "'%s' is shifted by (%.3g, %.3g) m, to where it is %.3g m off the domain: nothing is "
        "there that it could hold or push.",
        o->id, shift.x, shift.y, vec2_length(to));
    return true;
}

static void review_plate(plates *p, size_t k, review_warnings *ret_warnings)
{
    const scene_obstacle *obstacle = &p->s->obstacles[k];
    const size_t n = obstacle->n_points;

    const scene_obstacle *o = &p->s->obstacles[k];
    char pointer[BF_POINTER_SIZE];
    bool is_said = false;
    for (size_t m = 0; m < o->n_shifts && !is_said; m++) {
        snprintf(pointer, sizeof pointer, "/obstacles/%zu/motion/shift_m/%zu", k, m);
        is_said = review_shift(p, k, o->shifts[m], pointer, ret_warnings);
    }
    for (size_t m = 0; m < p->s->n_actions && !is_said; m++) {
        const scene_action *a = &p->s->actions[m];
        snprintf(pointer, sizeof pointer, "/actions/%zu/do/shift_m", m);
        is_said = a->type == SCENE_ACTION_SHIFT && a->target == k &&
                  review_shift(p, k, a->shift, pointer, ret_warnings);
    }
    if (scene_obstacle_moves(obstacle))
        return;
    review_parts(p, k, ret_warnings);
    for (size_t i = 0; i < p->s->n_feeds; i++)
        review_feed(p, k, &p->s->feeds[i], ret_warnings);
    if (!review_end(p, k, obstacle->path[1], obstacle->path[0], ret_warnings))
        review_end(p, k, obstacle->path[n - 2], obstacle->path[n - 1], ret_warnings);
}

bf_status review_plates(const scene *s, review_warnings *ret_warnings, bf_error *err)
{
    plates p = { .s = s, .around = surroundings_of(s), .steps_of_lookup = steps_of_lookup(s) };

    if (s->n_obstacles == 0)
        return BF_OK;
    const bf_status status = placement_of(s, &p.placement, err);
    if (status != BF_OK)
        return status;
    for (size_t k = 0; k < s->n_obstacles; k++)
        review_plate(&p, k, ret_warnings);
    placement_fini(&p.placement);
    return BF_OK;
}
