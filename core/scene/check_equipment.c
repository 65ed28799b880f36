// The checks of belts, obstacles, photo eyes and actions.

#include "core/base/polygon.h"
#include "core/scene/belt.h"
#include "core/scene/belt_path.h"
#include "core/scene/belt_range.h"
#include "core/scene/plate_range.h"
#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// Largest angle of a turn, rad: far from any sensible value, so that later arithmetic is safe.
#define ANGLE_MAX 1e6

static const bf_range turn_range = { -ANGLE_MAX, ANGLE_MAX, false, false, 0.0 };
static const bf_range flag_range = { 0.0, 1.0, false, false, 0.0 };

enum {
    ARC_SAMPLES = 181, ///< angles of an arc at which other belts are looked for
    ARC_SAMPLES_ACROSS =
        9, ///< radii, from just inside the inner border to just outside the outer one
};

static const number_rule arc_rules[] = {
    RULE("/arc/inner_radius_m", scene_belt, arc.inner_radius, scene_range_length),
    RULE("/arc/outer_radius_m", scene_belt, arc.outer_radius, scene_range_length),
};

/// Note what is wrong with an arc; pointer is that of the belt.
static void check_arc(const scene_belt *belt, const char *pointer, bf_faults *faults)
{
    const scene_arc *arc = &belt->arc;
    const double angle = belt_arc_angle(arc);
    const size_t n_before = faults->n;
    char at[BF_POINTER_SIZE + 2 * ROOM_FOR_INDEX];

    scene__check_numbers(belt, pointer, arc_rules, sizeof arc_rules / sizeof *arc_rules, faults);
    snprintf(at, sizeof at, "%s/arc/centre_m", pointer);
    if (!scene__is_place(belt->centre))
        faults_add(faults, at, "must be numbers within %g m", SCENE_LENGTH_MAX);
    snprintf(at, sizeof at, "%s/arc/outer_radius_m", pointer);
    if (faults->n == n_before && !(arc->outer_radius - arc->inner_radius >= SCENE_LENGTH_MIN))
        faults_add(faults, at, "must be greater than inner_radius_m");
    snprintf(at, sizeof at, "%s/arc/reference_radius_m", pointer);
    if (faults->n == n_before &&
        !(arc->reference_radius >= arc->inner_radius && arc->reference_radius <= arc->outer_radius))
        faults_add(faults, at, "must be between inner_radius_m and outer_radius_m");
    snprintf(at, sizeof at, "%s/arc/to_deg", pointer);
    if (!(angle >= BELT_ARC_LEAST))
        faults_add(faults, at, "must differ from from_deg by at least 1 degree");
    else if (!(angle <= BELT_ARC_MOST))
        faults_add(faults, at,
                   "is more than a whole turn from from_deg: the arc would lie on itself");
}

/// Bounds of the places under a belt or section with an outline.
static scene_rect bounds_of(const scene_belt *belt)
{
    const double outer = belt->arc.outer_radius;
    const vec2 centre = belt->centre;

    if (!belt->arc.is_given)
        return scene_rect_around(belt->polygon, belt->n_points);
    return (scene_rect){ centre.x - outer, centre.x + outer, centre.y - outer, centre.y + outer };
}

/// The others that may lie within a margin of a belt or section with an outline: the indices of *ret_n. Returns the steps to look
/// for a place on each of them.
static double find_near(const scene *s, size_t belt, double margin, size_t *ret_near, size_t *ret_n)
{
    const scene_rect own = bounds_of(&s->belts[belt]);
    double steps = 0.0;

    *ret_n = 0;
    for (size_t k = 0; k < s->n_sections; k++) {
        const scene_belt *other = &s->belts[k];
        const scene_rect at = other->n_points > 0 ? bounds_of(other) : own;
        if (k == belt || at.x_min > own.x_max + margin || at.x_max < own.x_min - margin ||
            at.y_min > own.y_max + margin || at.y_max < own.y_min - margin)
            continue;
        ret_near[(*ret_n)++] = k;
        steps += 1.0 + (other->arc.is_given ? 0.0 : (double)other->n_points);
    }
    return steps;
}

/// A belt or section that covers a place on an arc or a straight of a path, or beside one of its borders, as well; SCENE_BELTS_MAX: there is none.
/// Adds its steps to *steps, and looks for nothing beyond SCENE_CHECK_STEPS_MAX.
static size_t find_overlapped(const scene *s, size_t belt, double *steps, vec2 *ret_at)
{
    const scene_belt *of = &s->belts[belt];
    const scene_arc *arc = &of->arc;
    const double low = belt_lane_low(of), width = belt_lane_high(of) - low;
    // Cargo may come over the side of a straight along an axis: no stairs are held there.
    const double margin = 0.01 * width, aside = belt_has_lanes(of) ? margin : -margin;
    const double end = arc->is_given ? margin / arc->inner_radius : margin;
    const double first = arc->is_given ? fmin(arc->from, arc->to) : 0.0;
    const double length = (arc->is_given ? belt_arc_angle(arc) : of->leg.length) - 2.0 * end;
    size_t near[SCENE_BELTS_MAX], n_near = 0;

    *steps += ARC_SAMPLES * ARC_SAMPLES_ACROSS *
              find_near(s, belt, margin + SCENE_TOLERANCE, near, &n_near);
    if (*steps > SCENE_CHECK_STEPS_MAX)
        return SCENE_BELTS_MAX;
    for (int i = 0; i < ARC_SAMPLES && length > 0.0; i++) {
        const double along = first + end + length * i / (ARC_SAMPLES - 1.0);
        for (int k = 0; k < ARC_SAMPLES_ACROSS; k++) {
            const double q = low - aside + (width + 2.0 * aside) * k / (ARC_SAMPLES_ACROSS - 1.0);
            const vec2 start = vec2_add(of->leg.start, vec2_scale(of->leg.along, along));
            *ret_at = arc->is_given ? vec2_add(of->centre, (vec2){ q * cos(along), q * sin(along) })
                                    : vec2_sub(start, vec2_scale(vec2_turn_left(of->leg.along), q));
            for (size_t m = 0; m < n_near; m++)
                if (belt_holds(&s->belts[near[m]], *ret_at))
                    return near[m];
        }
    }
    return SCENE_BELTS_MAX;
}

/// Note arcs and paths that another belt overlaps, or lies along: only at its ends cargo comes to an arc and leaves it.
static void check_overlaps(const scene *s, bf_faults *faults)
{
    const size_t n_before = faults->n;
    double steps = 0.0;
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_sections; k++) {
        const scene_belt *section = &s->belts[k];
        const size_t of = scene_belt_of(s, k);
        const bool is_path = s->belts[of].path.n_points > 0;
        vec2 at = { 0.0, 0.0 };
        const size_t other = section->arc.is_given || section->leg.is_given
                                 ? find_overlapped(s, k, &steps, &at)
                                 : SCENE_BELTS_MAX;
        snprintf(pointer, sizeof pointer, "/belts/%zu/%s", of, is_path ? "path" : "arc");
        if (other == SCENE_BELTS_MAX || (of != k && faults->n > n_before))
            continue;
        if (scene_belt_of(s, other) == of)
            faults_add(faults, pointer, "crosses itself, or lies along itself, at (%.4g, %.4g) m",
                       at.x, at.y);
        else
            faults_add(faults, pointer,
                       "the belt '%s' overlaps it or lies along it at (%.4g, %.4g) m: belts must "
                       "meet %s at its ends",
                       s->belts[other].id, at.x, at.y, is_path ? "a path" : "an arc");
    }
    if (steps > SCENE_CHECK_STEPS_MAX)
        faults_add_limit(faults, "/belts",
                         "outlines near curves and paths have too many points to check whether "
                         "they overlap: %.3g steps, the limit is %.3g",
                         steps, SCENE_CHECK_STEPS_MAX);
}

// Ids of failures name figures and seed their draws, so they are unique in the scenario.
static void check_failures(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE + 2 * ROOM_FOR_INDEX];
    const scene_failure *all[SCENE_ALL_FAILURES_MAX];
    size_t n = 0;

    for (size_t k = 0; k < s->n_belts; k++) {
        for (size_t i = 0; i < s->belts[k].stops.n_failures; i++, n++) {
            const scene_failure *f = &s->belts[k].stops.failures[i];
            size_t m = 0;
            snprintf(pointer, sizeof pointer, "/belts/%zu/failures/%zu/id", k, i);
            if (n == SCENE_ALL_FAILURES_MAX) {
                faults_add_limit(faults, pointer, "is of more than %d kinds of failures of belts",
                                 SCENE_ALL_FAILURES_MAX);
                return;
            }
            while (m < n && strcmp(all[m]->id, f->id) != 0)
                m++;
            if (!scene_is_id(f->id))
                faults_add(faults, pointer, ID_TEXT, SCENE_ID_SIZE - 1);
            else if (m < n)
                faults_add(faults, pointer, "'%s' is the id of another kind of failure, too",
                           f->id);
            all[n] = f;
        }
    }
}

void scene__check_belts(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (s->n_belts < 1 || s->n_belts > SCENE_BELTS_MAX) {
        faults_add_limit(faults, "/belts", "%zu belts, the limits are 1 and %d", s->n_belts,
                         SCENE_BELTS_MAX);
        return;
    }
    size_t n_sections = s->n_belts;
    for (size_t k = 0; k < s->n_belts; k++)
        n_sections += s->belts[k].path.n_points > 2 ? 2 * s->belts[k].path.n_points - 4 : 0;
    if (!scene__check_count(n_sections, SCENE_BELTS_MAX, "/belts", "belts and sections of paths",
                            faults))
        return;
    bool are_sound = true;
    for (size_t k = 0; k < s->n_belts; k++) {
        const scene_belt *belt = &s->belts[k];
        const size_t n_before = faults->n;
        scene__check_id(s->belts, sizeof *s->belts, "belts", k, faults);
        snprintf(pointer, sizeof pointer, "/belts/%zu/velocity_m_s", k);
        if (!(belt_largest_speed(belt) <= SCENE_SPEED_MAX))
            faults_add(faults, pointer, "must be a velocity of at most %g m/s", SCENE_SPEED_MAX);
        snprintf(pointer, sizeof pointer, "/belts/%zu/friction", k);
        if (belt->friction != 0.0) // 0 stands for that of contacts
            range_check(&scene_range_belt_friction, belt->friction, pointer, faults);
        if (belt->friction != 0.0 && s->micro.contact[SCENE_CONVEYOR_CARGO].friction == 0.0)
            faults_add(
                faults, pointer,
                "needs a friction above 0 in contacts/conveyor_cargo, which other belts have");
        snprintf(pointer, sizeof pointer, "/belts/%zu/incline_deg", k);
        if (!(fabs(belt->incline) <= SCENE_INCLINE_MAX))
            faults_add(faults, pointer, "must be between -45 and 45 degrees");
        else if (belt->incline != 0.0 && (belt->arc.is_given || belt->path.n_points > 0))
            faults_add(faults, pointer, "must be 0: paths and curves are level");
        else if (belt->incline != 0.0 && vec2_length(belt->velocity) == 0.0)
            faults_add(faults, pointer, "needs a velocity_m_s, in whose direction the belt rises");
        snprintf(pointer, sizeof pointer, "/belts/%zu", k);
        belt_range_check(belt, pointer, faults);
        snprintf(pointer, sizeof pointer, "/belts/%zu/polygon_m", k);
        if (belt->n_points != 0 && !belt->arc.is_given && belt->path.n_points == 0)
            (void)scene__check_polygon(belt->polygon, belt->n_points, pointer, faults);
        snprintf(pointer, sizeof pointer, "/belts/%zu", k);
        if (belt->path.n_points > 0)
            belt_path_check(belt, pointer, faults);
        else if (belt->arc.is_given)
            check_arc(belt, pointer, faults);
        are_sound = are_sound && faults->n == n_before;
    }
    if (are_sound)
        check_overlaps(s, faults);
    check_failures(s, faults);
}

static const number_rule obstacle_rules[] = {
    RULE("/thickness_m", scene_obstacle, thickness, scene_range_length),
    RULE("/band_m", scene_obstacle, band, scene_range_length),
    RULE("/slide_width_m", scene_obstacle, slide_width, scene_range_length),
};

/// Note what is wrong with the shifts of an obstacle; pointer is that of its motion.
static void check_shifts(const scene_obstacle *o, const char *pointer, bf_faults *faults)
{
    const size_t n_before = faults->n;
    char at[2 * BF_POINTER_SIZE];

    snprintf(at, sizeof at, "%s/shift_m", pointer);
    if (o->n_shifts > 0 && o->n_shifts != o->turn.n_times)
        faults_add(faults, at, "has %zu items, but t_s has %zu", o->n_shifts, o->turn.n_times);
    for (size_t k = 0; k < o->n_shifts && faults->n == n_before; k++) {
        snprintf(at, sizeof at, "%s/shift_m/%zu", pointer, k);
        if (!scene__is_place(o->shifts[k]))
            faults_add(faults, at, "must be numbers within %g m", SCENE_LENGTH_MAX);
    }
}

/// Note what is wrong with how an obstacle moves; pointer is that of the obstacle.
static void check_motion(const scene_obstacle *o, const char *pointer, bf_faults *faults)
{
    const size_t n_before = faults->n;
    char at[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    snprintf(at, sizeof at, "%s/motion/pivot_m", pointer);
    // The start of a path, its default, is reported there.
    if (!scene__is_place(o->pivot) && o->n_points > 0 && scene__is_place(o->path[0]))
        faults_add(faults, at, "must be numbers within %g m", SCENE_LENGTH_MAX);
    snprintf(at, sizeof at, "%s/motion", pointer);
    scene__check_series(&o->turn, at, "turn_deg", &turn_range, faults);
    check_shifts(o, at, faults);
    snprintf(at, sizeof at, "%s/motion/repeat_s", pointer);
    if (faults->n == n_before && o->turn.n_times > 0 &&
        plate_range_largest_speed(o, 0, 0, NULL) == INFINITY)
        faults_add(faults, at, "leaves no time to move from the last place to the first one");
    snprintf(at, sizeof at, "%s/present", pointer);
    scene__check_series(&o->presence, at, "value", &flag_range, faults);
}

void scene__check_obstacles(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (!scene__check_count(s->n_obstacles, SCENE_OBSTACLES_MAX, "/obstacles", "obstacles", faults))
        return;
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *obstacle = &s->obstacles[k];
        scene__check_id(s->obstacles, sizeof *s->obstacles, "obstacles", k, faults);
        char of_path[BF_POINTER_SIZE];
        size_t n = obstacle->n_points;
        // Two points may have been given in another form than a path.
        bool whole = n == 2;
        snprintf(of_path, sizeof of_path, "/obstacles/%zu%s", k, whole ? "" : "/path_m");
        if (n < 2 || n > SCENE_POINTS_MAX)
            faults_add(faults, of_path, "must have 2 to %d points, not %zu", SCENE_POINTS_MAX, n);
        else
            (void)scene__check_points(obstacle->path, n, of_path, whole, faults);
        snprintf(pointer, sizeof pointer, "/obstacles/%zu", k);
        scene__check_numbers(obstacle, pointer, obstacle_rules,
                             sizeof obstacle_rules / sizeof *obstacle_rules, faults);
        check_motion(obstacle, pointer, faults);
        snprintf(pointer, sizeof pointer, "/obstacles/%zu/force_limit_n", k);
        if (obstacle->force_limit != 0.0) // 0 stands for "auto"
            range_check(&scene_range_force_limit, obstacle->force_limit, pointer, faults);
        snprintf(pointer, sizeof pointer, "/obstacles/%zu/treatment", k);
        if ((unsigned)obstacle->treatment >= SCENE_TREATMENT_COUNT)
            faults_add(faults, pointer, "is not a treatment");
    }
}

static const number_rule eye_rules[] = {
    RULE("/block_time_s", scene_photo_eye, block_time, scene_range_instant),
    RULE("/clear_time_s", scene_photo_eye, clear_time, scene_range_instant),
};

void scene__check_photo_eyes(const scene *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    if (!scene__check_count(s->n_eyes, SCENE_EYES_MAX, "/photo_eyes", "photo eyes", faults))
        return;
    for (size_t k = 0; k < s->n_eyes; k++) {
        scene__check_id(s->eyes, sizeof *s->eyes, "photo_eyes", k, faults);
        snprintf(pointer, sizeof pointer, "/photo_eyes/%zu", k);
        scene__check_numbers(&s->eyes[k], pointer, eye_rules, sizeof eye_rules / sizeof *eye_rules,
                             faults);
        snprintf(pointer, sizeof pointer, "/photo_eyes/%zu/density_ratio", k);
        if (s->eyes[k].density_ratio != 0.0) // 0 stands for "auto"
            range_check(&scene_range_ratio, s->eyes[k].density_ratio, pointer, faults);
        snprintf(pointer, sizeof pointer, "/photo_eyes/%zu/line_m", k);
        // A beam may end beyond the domain, where its housing stands.
        const vec2 lower = { s->domain.x_min, s->domain.y_min },
                   upper = { s->domain.x_max, s->domain.y_max };
        vec2 start = s->eyes[k].line[0], end = s->eyes[k].line[1];
        if (scene__check_points(s->eyes[k].line, 2, pointer, false, faults) &&
            !polygon_clip_segment(&start, &end, lower, upper))
            faults_add(faults, pointer, "lies outside of the domain");
    }
}

/// A kind of target of actions.
typedef struct target_rule {
    const char *name;      ///< of the member that names the target
    const char *value;     ///< and of that with the value
    const bf_range *range; ///< of the value; NULL: it is a shift
} target_rule;

static const target_rule targets[SCENE_ACTION_COUNT] = {
    [SCENE_ACTION_BELT] = { "belt", "factor", &scene_range_speed_factor },
    [SCENE_ACTION_TURN] = { "obstacle", "turn_deg", &turn_range },
    [SCENE_ACTION_PRESENCE] = { "obstacle", "present", &flag_range },
    [SCENE_ACTION_FEED] = { "feed", "hold", &flag_range },
    [SCENE_ACTION_SHIFT] = { "obstacle", "shift_m", NULL },
};

static size_t count_targets(const scene *s, scene_action_type type)
{
    if (type == SCENE_ACTION_BELT)
        return s->n_belts;
    return type == SCENE_ACTION_FEED ? s->n_feeds : s->n_obstacles;
}

static void check_command(const scene *s, const scene_action *a, const char *pointer,
                          bf_faults *faults)
{
    const target_rule *rule = &targets[a->type];
    const size_t n_before = faults->n;
    char at[2 * BF_POINTER_SIZE];

    snprintf(at, sizeof at, "%s/do/%s", pointer, rule->name);
    if (a->target >= count_targets(s, a->type)) {
        faults_add(faults, at, "must be the id of one in the scenario");
        return;
    }
    snprintf(at, sizeof at, "%s/do/%s", pointer, rule->value);
    if (rule->range != NULL)
        range_check(rule->range, a->value, at, faults);
    else if (!scene__is_place(a->shift))
        faults_add(faults, at, "must be numbers within %g m", SCENE_LENGTH_MAX);
    if (faults->n > n_before || a->type != SCENE_ACTION_BELT)
        return;
    const double speed = belt_largest_speed(&s->belts[a->target]);
    // A speed that is too large by itself is reported at the belt.
    if (speed <= SCENE_SPEED_MAX && speed * fabs(a->value) > SCENE_SPEED_MAX)
        faults_add(faults, at, "makes the belt move at %g m/s, the limit is %g",
                   speed * fabs(a->value), SCENE_SPEED_MAX);
}

void scene__check_actions(const scene *s, bf_faults *faults)
{
    static const number_rule rules[] = {
        RULE("/delay_s", scene_action, delay, scene_range_instant),
        RULE("/do/over_s", scene_action, over, scene_range_time),
    };
    char pointer[BF_POINTER_SIZE], at[2 * BF_POINTER_SIZE];

    if (!scene__check_count(s->n_actions, SCENE_ACTIONS_MAX, "/actions", "actions", faults))
        return;
    for (size_t k = 0; k < s->n_actions; k++) {
        const scene_action *a = &s->actions[k];
        snprintf(pointer, sizeof pointer, "/actions/%zu", k);
        scene__check_numbers(a, pointer, rules, sizeof rules / sizeof *rules, faults);
        snprintf(at, sizeof at, "%s/when/photo_eye", pointer);
        if (a->eye >= s->n_eyes)
            faults_add(faults, at, "must be the id of one in the scenario");
        snprintf(at, sizeof at, "%s/when/kind", pointer);
        if (a->kind != SCENE_KIND_ANY && a->kind >= s->n_cargo)
            faults_add(faults, at, "must be the id of a kind of cargo in the scenario");
        else if (a->kind != SCENE_KIND_ANY && a->eye < s->n_eyes &&
                 s->eyes[a->eye].density_ratio != 0.0)
            faults_add(faults, at, "an eye that sees a density (density_ratio) sees no parts");
        snprintf(at, sizeof at, "%s/do", pointer);
        if ((unsigned)a->type < SCENE_ACTION_COUNT)
            check_command(s, a, pointer, faults);
        else
            faults_add(faults, at, "is not an action");
    }
}
