// Rejects invalid definitions.

#include "core/micro/micro_priv.h"
#include "core/scene/belt_speeds.h"
#include "core/scene/plate_motion.h"

#include <math.h>
#include <stdio.h>

enum { MOST_THREADS = 1024 };

static bool is_positive(double x)
{
    return isfinite(x) && x > 0.0;
}

static bool is_no_less_than(double x, double least)
{
    return isfinite(x) && x >= least;
}

static bf_status check_number(bool is_good, double value, const char *pointer, bf_error *err)
{
    return is_good ? BF_OK : bf_fail(err, BF_EINPUT, pointer, "%g is out of range", value);
}

static bf_status check_material(const scene_material *m, const char *pointer, bf_error *err)
{
    if (is_positive(m->young_modulus) && is_no_less_than(m->poisson_ratio, 0.0) &&
        m->poisson_ratio < 0.5)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, pointer, "E = %g Pa, nu = %g is no material", m->young_modulus,
                   m->poisson_ratio);
}

static bf_status check_contacts(const micro_def *def, bf_error *err)
{
    static const char *const pointers[SCENE_PAIR_COUNT] = {
        [SCENE_CARGO_CARGO] = "/contacts/cargo_cargo",
        [SCENE_CONVEYOR_CARGO] = "/contacts/conveyor_cargo",
        [SCENE_HANDLING_CARGO] = "/contacts/handling_cargo",
    };

    for (int pair = 0; pair < SCENE_PAIR_COUNT; pair++) {
        const scene_contact *c = &def->contact[pair];
        if (!is_positive(c->length) || !is_no_less_than(c->damping, 0.0) ||
            !is_no_less_than(c->friction, 0.0) || !is_positive(c->tanh_linear) ||
            !is_positive(c->tanh_spin))
            return bf_fail(err, BF_EINPUT, pointers[pair], "a number is out of range");
    }
    return BF_OK;
}

static bf_status check_kinds(const micro_def *def, bf_error *err)
{
    bf_status status = BF_OK;

    if (def->n_kinds < 1 || def->kinds == NULL)
        return bf_fail(err, BF_EINPUT, "/cargo", "there is no kind of part");
    for (size_t k = 0; k < def->n_kinds && status == BF_OK; k++) {
        const micro_kind *kind = &def->kinds[k];
        status = check_material(&kind->material, "/cargo/material", err);
        if (status == BF_OK)
            status = check_number(is_positive(kind->mass), kind->mass, "/cargo/mass_kg", err);
        if (status == BF_OK)
            status = check_number(is_no_less_than(kind->spin_radius, 0.0), kind->spin_radius,
                                  "/micro/spin_friction_radius_m", err);
        if (status == BF_OK && kind->shape.type >= SCENE_SHAPE_COUNT)
            status = bf_fail(err, BF_EINPUT, "/cargo/shape", "unknown shape");
        if (status == BF_OK && kind->shape.type == SCENE_CYLINDER &&
            (!is_positive(kind->shape.radius) || !is_positive(kind->shape.height)))
            status = bf_fail(err, BF_EINPUT, "/cargo/shape", "radius and height must be positive");
        if (status == BF_OK && def->path == MICRO_PATH_PLANAR && kind->shape.type != SCENE_CYLINDER)
            status = bf_fail(err, BF_EINPUT, "/micro/path", "planar is for cylinders");
    }
    return status;
}

bool micro__is_inside(const scene_rect *d, const scene_pose *pose)
{
    return pose->x >= d->x_min && pose->x <= d->x_max && pose->y >= d->y_min &&
           pose->y <= d->y_max && isfinite(pose->heading);
}

static bf_status check_parts(const micro_def *def, bf_error *err)
{
    if (def->n_parts > SCENE_PARTS_MAX)
        return bf_fail(err, BF_ELIMIT, "/initial", "%zu parts, the limit is %d", def->n_parts,
                       SCENE_PARTS_MAX);
    if (def->n_parts_expected > SCENE_PARTS_MAX)
        return bf_fail(err, BF_ELIMIT, "/feeds", "%zu parts, the limit is %d",
                       def->n_parts_expected, SCENE_PARTS_MAX);
    if (def->n_parts > 0 && def->poses == NULL)
        return bf_fail(err, BF_EINPUT, "/initial", "the parts have no places");
    for (size_t k = 0; k < def->n_parts; k++) {
        if (!micro__is_inside(&def->domain, &def->poses[k]))
            return bf_fail(err, BF_EINPUT, "/initial",
                           "part %zu at (%g, %g) m is outside the domain", k, def->poses[k].x,
                           def->poses[k].y);
        if (def->part_kinds != NULL && def->part_kinds[k] >= def->n_kinds)
            return bf_fail(err, BF_EINPUT, "/cargo", "part %zu is of kind %u of %zu", k,
                           (unsigned)def->part_kinds[k], def->n_kinds);
    }
    return BF_OK;
}

static bool is_point(vec2 p)
{
    return fabs(p.x) <= SCENE_LENGTH_MAX && fabs(p.y) <= SCENE_LENGTH_MAX;
}

static bf_status check_domain(const micro_def *def, bf_error *err)
{
    const scene_rect *d = &def->domain;

    if (!is_point((vec2){ d->x_min, d->y_min }) || !is_point((vec2){ d->x_max, d->y_max }) ||
        !(d->x_min < d->x_max) || !(d->y_min < d->y_max))
        return bf_fail(err, BF_EINPUT, "/domain", "the domain must have a finite area");
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        if (def->edges[side] >= SCENE_EDGE_COUNT)
            return bf_fail(err, BF_EINPUT, "/edges", "unknown kind of edge");
    return BF_OK;
}

static bool is_speed_good(const scene_belt *belt)
{
    bf_faults faults = { .n = 0 };

    if (belt->speed_schedule.n_times > 0)
        belt_speeds_check(belt, "", &faults);
    return faults.n == 0;
}

static bool is_belt(const scene_belt *belt)
{
    bool is_good = isfinite(belt->velocity.x) && isfinite(belt->velocity.y) &&
                   (belt->n_points == 0 || belt->n_points >= 3) && is_speed_good(belt);

    for (size_t k = 0; k < belt->n_points && is_good; k++)
        is_good = is_point(belt->polygon[k]);
    return is_good;
}

static bool is_obstacle(const scene_obstacle *obstacle)
{
    bool is_good = obstacle->n_points >= 2 && is_positive(obstacle->thickness);

    for (size_t k = 0; k < obstacle->n_points && is_good; k++) {
        const vec2 *p = &obstacle->path[k];
        is_good = is_point(*p) && (k == 0 || p->x != p[-1].x || p->y != p[-1].y);
    }
    return is_good;
}

static bf_status check_scene(const micro_def *def, bf_error *err)
{
    char pointer[BF_POINTER_SIZE];

    if (def->n_belts > SCENE_BELTS_MAX)
        return bf_fail(err, BF_ELIMIT, "/belts", "%zu belts, the limit is %d", def->n_belts,
                       SCENE_BELTS_MAX);
    for (size_t k = 0; k < def->n_belts; k++) {
        if (is_belt(&def->belts[k]))
            continue;
        snprintf(pointer, sizeof pointer, "/belts/%zu", k);
        return bf_fail(err, BF_EINPUT, pointer, "a number of the belt is out of range");
    }
    for (size_t k = 0; k < def->n_obstacles; k++) {
        if (is_obstacle(&def->obstacles[k]))
            continue;
        snprintf(pointer, sizeof pointer, "/obstacles/%zu", k);
        return bf_fail(err, BF_EINPUT, pointer, "a number of the obstacle is out of range");
    }
    return check_number(isfinite(def->start_velocity.x) && isfinite(def->start_velocity.y),
                        def->start_velocity.x, "/initial", err);
}

static bf_status check_parameters(const micro_def *def, bf_error *err)
{
    const struct {
        bool is_good;
        double value;
        const char *pointer;
    } numbers[] = {
        { is_no_less_than(def->modulus_reduction, 1.0), def->modulus_reduction,
          "/micro/modulus_reduction" },
        { def->overlap_limit > 0.0, def->overlap_limit, "/micro/overlap_limit" },
        { is_no_less_than(def->damping, 0.0), def->damping, "/micro/damping_per_s" },
        { is_no_less_than(def->gravity, 0.0), def->gravity, "/micro/gravity_m_s2" },
        { is_no_less_than(def->wall_friction, 0.0), def->wall_friction, "/contacts/wall_friction" },
        { def->integrator < MICRO_INTEGRATOR_COUNT, def->integrator, "/micro/integrator" },
        { def->path < MICRO_PATH_COUNT, def->path, "/micro/path" },
        { def->n_threads >= 1 && def->n_threads <= MOST_THREADS, def->n_threads, "" },
    };
    bf_status status = BF_OK;

    for (size_t k = 0; k < sizeof numbers / sizeof *numbers && status == BF_OK; k++)
        status = check_number(numbers[k].is_good, numbers[k].value, numbers[k].pointer, err);
    return status;
}

double micro__plate_speed(const micro_def *def, size_t *ret_obstacle)
{
    double largest = 0.0;

    *ret_obstacle = 0;
    for (size_t k = 0; k < def->n_obstacles; k++) {
        const double speed =
            plate_motion_largest_speed(def->obstacles, k, def->n_actions, def->actions);
        if (speed > largest)
            *ret_obstacle = k;
        largest = fmax(largest, speed);
    }
    return largest;
}

bf_status micro__check(const micro_def *def, bf_error *err)
{
    bf_status (*const checks[])(const micro_def *, bf_error *) = {
        check_parameters, check_contacts, check_domain, check_scene, check_kinds, check_parts,
    };
    bf_status status = BF_OK;

    if (def->cookie != MICRO__COOKIE)
        return bf_fail(err, BF_EINPUT, "", "the definition is not from micro_def_default()");
    for (size_t k = 0; k < sizeof checks / sizeof *checks && status == BF_OK; k++)
        status = checks[k](def, err);
    if (status == BF_OK)
        status = check_material(&def->conveyor, "/materials/conveyor", err);
    if (status == BF_OK)
        status = check_material(&def->handling, "/materials/handling", err);
    return status;
}
