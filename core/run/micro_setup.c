#include "core/run/micro_setup.h"

#include "core/base/faults.h"
#include "core/base/memory.h"
#include "core/feed/arrivals.h"
#include "core/micro/hardness.h"
#include "core/run/run_priv.h"
#include "core/scene/density.h"
#include "core/scene/mix.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <string.h>

static void set_parameters(const scene_micro *micro, micro_def *def)
{
    static const micro_integrator integrators[] = {
        [SCENE_VERLET] = MICRO_VERLET,
        [SCENE_IMPLICIT] = MICRO_IMPLICIT,
        [SCENE_INTEGRATOR_AUTO] = MICRO_IMPLICIT,
    };
    static const micro_path paths[] = { [SCENE_PATH_AUTO] = MICRO_PATH_AUTO,
                                        [SCENE_PATH_PLANAR] = MICRO_PATH_PLANAR,
                                        [SCENE_PATH_SPATIAL] = MICRO_PATH_SPATIAL };

    memcpy(def->contact, micro->contact, sizeof def->contact);
    def->wall_friction = micro->wall_friction;
    def->conveyor = micro->conveyor;
    def->handling = micro->handling;
    def->hardens = micro->modulus_reduction == 0.0;
    if (!def->hardens)
        def->modulus_reduction = micro->modulus_reduction;
    def->overlap_limit = micro->overlap_limit;
    def->damping = micro->damping;
    def->gravity = micro->gravity;
    def->dt = micro->step;
    def->tension = micro->tension;
    def->integrator = integrators[micro->integrator];
    def->path = paths[micro->path];
}

// Nothing leaves over a side with a feed: the domain and its belts go on behind it, for a part and a wall.
static void extend_side(surroundings *around, scene_side side, double by)
{
    const double signs[SCENE_SIDE_COUNT] = { -by, by, -by, by };
    double *const ends[SCENE_SIDE_COUNT] = { &around->domain.x_min, &around->domain.x_max,
                                             &around->domain.y_min, &around->domain.y_max };
    const vec2 outward = vec2_scale(surroundings_side(around, side).inward, -by);

    // Corners of belts that lie on the side are moved with it.
    for (size_t k = 0; k < around->n_belts; k++) {
        const scene_belt *belt = &around->belts[k];
        for (size_t i = 0; i < belt->n_points; i++)
            if (fabs(surroundings_excess(around, side, belt->polygon[i])) <= SCENE_TOLERANCE)
                belt->polygon[i] = vec2_add(belt->polygon[i], outward);
    }
    *ends[side] += signs[side];
    around->edges[side] = SCENE_EDGE_WALL;
}

static bf_status make_inlets(const scene *s, surroundings *ret_inlets, bf_error *err)
{
    const surroundings around = surroundings_of(s);
    bool is_any = false;

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        is_any |= scene_is_fed(s, (scene_side)side);
    if (!is_any)
        return BF_OK;
    bf_status status = surroundings_copy(&around, ret_inlets, err);
    scene_belt *belts = (scene_belt *)ret_inlets->belts;
    for (size_t k = 0; k < ret_inlets->n_belts; k++) { // borrowed
        belts[k].speed_schedule = s->belts[k].speed_schedule;
        belts[k].stops = s->belts[k].stops;
    }
    for (int side = 0; side < SCENE_SIDE_COUNT && status == BF_OK; side++)
        if (scene_is_fed(s, (scene_side)side))
            extend_side(ret_inlets, (scene_side)side, 2.0 * mix_radii_of(s).largest);
    return status;
}

static bf_status set_surroundings(const scene *s, micro_setup *setup, bf_error *err)
{
    const bf_status status = make_inlets(s, &setup->inlets, err);
    const bool has_inlets = setup->inlets.n_belts > 0;
    const surroundings around = has_inlets ? setup->inlets : surroundings_of(s);
    micro_def *def = &setup->def;

    def->domain = around.domain;
    memcpy(def->edges, around.edges, sizeof def->edges);
    def->n_belts = around.n_belts;
    def->belts = around.belts;
    def->n_obstacles = s->n_obstacles;
    def->obstacles = s->obstacles;
    def->n_actions = s->n_actions;
    def->actions = s->actions;
    return status;
}

// Parts that may be in the domain at the same time: those at the start and of the feeds, at most what fits.
static bf_status set_expected(const scene *s, micro_def *def, bf_error *err)
{
    const scene_rect *d = &s->domain;
    const double fits = (d->x_max - d->x_min) * (d->y_max - d->y_min) * scene_packing_density(s);
    double n_fed = 0.0;

    if (s->n_feeds == 0)
        return BF_OK;
    const bf_status status = feed_offered(s, 0.0, s->duration, &n_fed, err);
    def->n_parts_expected =
        (size_t)fmax(fmin((double)def->n_parts + n_fed, fmin(fits, SCENE_PARTS_MAX)), 1.0);
    return status;
}

bf_status micro_setup_init(const scene *s, bf_world *w, int n_threads, micro_setup *setup,
                           bf_error *err)
{
    *setup = (micro_setup){ .def = micro_def_default() };
    bf_status status = placement_of(s, &setup->placement, err);
    if (status != BF_OK)
        return status;
    for (size_t k = 0; k < s->n_cargo; k++)
        setup->kinds[k] = (micro_kind){ .shape = s->cargo[k].shape,
                                        .material = s->cargo[k].material,
                                        .mass = s->cargo[k].mass,
                                        .spin_radius = s->cargo[k].spin_friction_radius };
    setup->def.n_kinds = s->n_cargo;
    setup->def.kinds = setup->kinds;
    set_parameters(&s->micro, &setup->def);
    setup->def.n_parts = setup->placement.n;
    setup->def.poses = setup->placement.poses;
    setup->def.part_kinds = setup->placement.kinds;
    setup->def.world = w;
    setup->def.n_threads = n_threads;
    if ((status = set_surroundings(s, setup, err)) != BF_OK ||
        (status = set_expected(s, &setup->def, err)) != BF_OK) {
        micro_setup_fini(setup);
        return status;
    }
    if (setup->def.hardens)
        setup->def.modulus_reduction = hardness_reduction(&setup->def);
    if (setup->def.dt > 0.0)
        return BF_OK;
    // "auto" is the paper's, where that is stable, or the implicit integrator's own.
    const double step =
        setup->def.integrator == MICRO_VERLET
            ? fmin(1e-5, fmin(micro_dt_stable(&setup->def), micro_dt_plates(&setup->def)))
            : micro_dt_chosen(&setup->def);
    setup->def.dt = scene_fit_step(s, step, false);
    return BF_OK;
}

void micro_setup_fini(micro_setup *setup)
{
    if (setup == NULL)
        return;
    placement_fini(&setup->placement);
    surroundings_fini(&setup->inlets);
    *setup = (micro_setup){ .def = { .n_parts = 0 } };
}

// The solver's own checks, applied to the first part alone, which is cheap.
static bf_status probe(const micro_def *def, bf_error *err)
{
    micro_def first = *def;
    micro_solver *solver = NULL;

    first.n_parts = def->n_parts > 0 ? 1 : 0;
    bf_status status = micro_create(&first, &solver, err);
    if (status == BF_OK)
        micro_destroy(solver);
    return status;
}

static void check_step(const scene *s, const micro_def *def, bf_faults *faults)
{
    const double stable = micro_dt_stable(def), n = ceil(s->duration / def->dt);
    bf_error err;

    if (def->dt > stable * (1.0 + RUN__STABLE_SLACK))
        faults_add(faults, "/micro/step_s",
                   "a step of %.10g s is unstable: the largest stable one is %.10g s", def->dt,
                   stable);
    else if (s->micro.step > s->duration)
        faults_add(faults, "/duration_s", "%.10g s are less than one step of %.10g s", s->duration,
                   s->micro.step);
    else if (probe(def, &err) != BF_OK)
        faults_add_error(faults, &err);
    else if (!(n <= SCENE_STEPS_MAX))
        faults_add_limit(faults, s->micro.step > 0.0 ? "/micro/step_s" : "/duration_s",
                         "%.10g steps of the microscopic model, the limit is %.10g", n,
                         SCENE_STEPS_MAX);
}

static bool is_planar(const scene *s)
{
    bool are_cylinders = true;

    for (size_t k = 0; k < s->n_cargo; k++)
        are_cylinders = are_cylinders && s->cargo[k].shape.type == SCENE_CYLINDER;
    return are_cylinders && s->micro.path != SCENE_PATH_SPATIAL;
}

static void check_results(const scene *s, const micro_def *def, bf_faults *faults)
{
    const bf_grid grid = scene_grid(s);
    const double n = scene_snapshots(s),
                 n_parts = (double)(s->n_feeds > 0 ? def->n_parts_expected : def->n_parts);
    const int n_values = (is_planar(s) ? FRAME_VALUES_PLANAR : FRAME_VALUES_SPATIAL) +
                         (s->n_feeds > 0 ? FRAME_VALUES_FED : 0);
    double bytes = n * n_parts * n_values * (double)sizeof(double);
    double work =
        n * n_parts *
        density_cells(s->macro.initial_mollifier, grid.d1 * grid.d2, (double)grid_cells(&grid));

    if (!(bytes <= SCENE_SNAPSHOT_BYTES_MAX))
        faults_add_limit(faults, "/output/snapshot_every_s",
                         "%.10g bytes of parts, the limit is %.10g", bytes,
                         SCENE_SNAPSHOT_BYTES_MAX);
    if (!(work <= SCENE_DENSITY_WORK_MAX))
        faults_add_limit(
            faults, "/output/snapshot_every_s",
            "%.10g values to sum up for the densities of the parts, the limit is %.10g", work,
            SCENE_DENSITY_WORK_MAX);
}

void micro_setup_check(const scene *s, const micro_setup *setup, bf_faults *faults)
{
    bf_error err;

    check_step(s, &setup->def, faults);
    check_results(s, &setup->def, faults);
    if (placement_check_plates(s, &setup->placement, faults) != BF_OK) {
        (void)bf_fail(&err, BF_ENOMEM, "/initial", "no memory for %zu parts", setup->placement.n);
        faults_add_error(faults, &err);
    }
}

void micro_setup_check_scenario(const scene *s, bf_faults *faults)
{
    micro_setup setup = { .def = { .n_parts = 0 } };
    bf_world w;
    bf_error err;

    if (world_init(&w, s, &err) == BF_OK && micro_setup_init(s, &w, 1, &setup, &err) == BF_OK)
        micro_setup_check(s, &setup, faults);
    else
        faults_add_error(faults, &err);
    micro_setup_fini(&setup);
    world_fini(&w);
}
