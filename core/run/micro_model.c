// The microscopic model's run_backend: scenario to solver, parts to counts and density.

#include "core/base/faults.h"
#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/run/run_priv.h"
#include "core/scene/belt_speeds.h"
#include "core/scene/counter.h"
#include "core/scene/density.h"
#include "core/scene/shape.h"

#include <math.h>
#include <string.h>

// Steps of so many parts take some 10 ms on a slow processor, more where bodies move in space.
enum { PARTS_ADVANCED_PLANAR = 200000, PARTS_ADVANCED_SPATIAL = 10000 };

static const double longest_tick = 0.1; // s, where belts hardly move

typedef struct micro_run {
    micro_solver *solver;
    const scene *scene;
    double packing; // parts/m2 at density 1
    bf_grid grid;
    double *rho;       // of the last snapshot
    scene_pose *poses; // of the parts in the domain then
    size_t n_poses_max;
} micro_run;

static void set_kinds(const scene *s, run__micro_setup *setup)
{
    for (size_t k = 0; k < s->n_cargo; k++)
        setup->kinds[k] = (micro_kind){ .shape = s->cargo[k].shape,
                                        .material = s->cargo[k].material,
                                        .mass = s->cargo[k].mass,
                                        .spin_radius = s->cargo[k].spin_friction_radius };
    setup->def.n_kinds = s->n_cargo;
    setup->def.kinds = setup->kinds;
}

static void set_parameters(const scene_micro *micro, micro_def *def)
{
    static const micro_integrator integrators[] = {
        [SCENE_VERLET] = MICRO_VERLET, [SCENE_IMPLICIT] = MICRO_IMPLICIT
    };
    static const micro_path paths[] = { [SCENE_PATH_AUTO] = MICRO_PATH_AUTO,
                                        [SCENE_PATH_PLANAR] = MICRO_PATH_PLANAR,
                                        [SCENE_PATH_SPATIAL] = MICRO_PATH_SPATIAL };

    memcpy(def->contact, micro->contact, sizeof def->contact);
    def->conveyor = micro->conveyor;
    def->handling = micro->handling;
    def->modulus_reduction = micro->modulus_reduction;
    def->damping = micro->damping;
    def->gravity = micro->gravity;
    def->dt = micro->step;
    def->tension = micro->tension;
    def->integrator = integrators[micro->integrator];
    def->path = paths[micro->path];
}

static void set_surroundings(const scene *s, micro_def *def)
{
    def->domain = s->domain;
    memcpy(def->edges, s->edges, sizeof def->edges);
    def->n_belts = s->n_belts;
    def->belts = s->belts;
    def->n_obstacles = s->n_obstacles;
    def->obstacles = s->obstacles;
    def->n_actions = s->n_actions;
    def->actions = s->actions;
}

// The step that "auto" stands for: the paper's, where that is stable, or the implicit integrator's own.
static double choose_step(const micro_def *def)
{
    return def->integrator == MICRO_VERLET
               ? fmin(1e-5, fmin(micro_dt_stable(def), micro_dt_plates(def)))
               : micro_dt_chosen(def);
}

bf_status run__micro_init_setup(const scene *s, int n_threads, run__micro_setup *setup,
                                bf_error *err)
{
    *setup = (run__micro_setup){ .def = micro_def_default() };
    bf_status status = placement_of(s, &setup->placement, err);
    if (status != BF_OK)
        return status;
    set_kinds(s, setup);
    set_surroundings(s, &setup->def);
    set_parameters(&s->micro, &setup->def);
    setup->def.n_parts = setup->placement.n;
    setup->def.poses = setup->placement.poses;
    setup->def.part_kinds = setup->placement.kinds;
    setup->def.n_threads = n_threads;
    if (setup->def.dt == 0.0)
        setup->def.dt = scene_fit_step(s, choose_step(&setup->def), false);
    return BF_OK;
}

void run__micro_fini_setup(run__micro_setup *setup)
{
    if (setup == NULL)
        return;
    placement_fini(&setup->placement);
    *setup = (run__micro_setup){ .def = { .n_parts = 0 } };
}

static bf_status check_count(const scene *s, double dt, bf_error *err)
{
    double n = ceil(s->duration / dt);

    if (n <= SCENE_STEPS_MAX)
        return BF_OK;
    return bf_fail(err, BF_ELIMIT, s->micro.step > 0.0 ? "/micro/step_s" : "/duration_s",
                   "%.10g steps of the microscopic model, the limit is %.10g", n, SCENE_STEPS_MAX);
}

// The solver's own checks, applied to the first part alone, which is cheap.
static bf_status probe(const micro_def *def, bf_error *err)
{
    micro_def first = *def;
    micro_solver *solver = NULL;

    first.n_parts = 1;
    bf_status status = micro_create(&first, &solver, err);
    if (status == BF_OK)
        micro_destroy(solver);
    return status;
}

static void check_step(const scene *s, const micro_def *def, bf_faults *faults)
{
    double stable = micro_dt_stable(def);
    bf_error err;

    if (def->dt > stable * (1.0 + RUN__STABLE_SLACK))
        faults_add(faults, "/micro/step_s",
                   "a step of %.10g s is unstable: the largest stable one is %.10g s", def->dt,
                   stable);
    else if (s->micro.step > s->duration)
        faults_add(faults, "/duration_s", "%.10g s are less than one step of %.10g s", s->duration,
                   s->micro.step);
    else if (probe(def, &err) != BF_OK || check_count(s, def->dt, &err) != BF_OK)
        faults_add_error(faults, &err);
}

static bool is_planar(const scene *s)
{
    bool are_cylinders = true;

    for (size_t k = 0; k < s->n_cargo; k++)
        are_cylinders = are_cylinders && s->cargo[k].shape.type == SCENE_CYLINDER;
    return are_cylinders && s->micro.path != SCENE_PATH_SPATIAL;
}

static void check_results(const scene *s, bf_faults *faults)
{
    const bf_grid grid = scene_grid(s);
    double n = floor(s->duration / s->output.snapshot_every) + 2.0,
           n_parts = (double)scene_parts(s);
    double bytes = n * n_parts * (is_planar(s) ? FRAME_VALUES_PLANAR : FRAME_VALUES_SPATIAL) *
                   (double)sizeof(double);
    // A part counts for the cells up to where its Gaussian has fallen to 2^-53, see density.h.
    double n_cells =
        2.0 * M_PI * 53.0 * M_LN2 / (s->macro.initial_mollifier * s->macro.cell * s->macro.cell);
    double work = n * n_parts * fmin(n_cells, (double)grid_cells(&grid));

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

static void check_setup(const scene *s, const run__micro_setup *setup, bf_faults *faults)
{
    bf_error err;

    check_step(s, &setup->def, faults);
    check_results(s, faults);
    if (placement_check_plates(s, &setup->placement, faults) != BF_OK) {
        (void)bf_fail(&err, BF_ENOMEM, "/initial", "no memory for %zu parts", setup->placement.n);
        faults_add_error(faults, &err);
    }
}

static void check_scenario(const scene *s, bf_faults *faults)
{
    run__micro_setup setup;
    bf_error err;

    if (run__micro_init_setup(s, 1, &setup, &err) != BF_OK) {
        faults_add_error(faults, &err);
        return;
    }
    check_setup(s, &setup, faults);
    run__micro_fini_setup(&setup);
}

static void destroy_run(void *solver)
{
    micro_run *run = solver;

    if (run == NULL)
        return;
    micro_destroy(run->solver);
    memory_free(run->rho);
    memory_free(run->poses);
    memory_free(run);
}

static bf_status fill_run(const scene *s, const micro_def *def, micro_run *run, bf_error *err)
{
    run->scene = s;
    run->packing = scene_packing_density(s);
    run->grid = scene_grid(s);
    run->rho = memory_alloc(grid_cells(&run->grid), sizeof *run->rho);
    if (run->rho == NULL ||
        memory_reserve(&run->poses, &run->n_poses_max, def->n_parts, sizeof *run->poses) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the density of the parts");
    return micro_create(def, &run->solver, err);
}

// The smallest distance from the centre of a part of any kind to its border, seen from above.
static double smallest_radius(const scene *s)
{
    double smallest = INFINITY;

    for (size_t k = 0; k < s->n_cargo; k++) {
        const shape_footprint f = shape_footprint_of(&s->cargo[k].shape);
        const vec2 centre = { 0.0, 0.0 };
        if (f.n_corners == 0)
            smallest = fmin(smallest, f.bounding_radius);
        for (size_t i = 0; i < f.n_corners; i++)
            smallest = fmin(smallest, polygon_segment_distance(centre, f.corners[i],
                                                               f.corners[(i + 1) % f.n_corners]));
    }
    return smallest;
}

// In a tick no belt moves by more than a quarter of a part's radius, so that few parts of a feed come late and
// photo eyes see every part.
static uint64_t choose_tick(const scene *s, double dt)
{
    double speed = 0.0;

    for (size_t k = 0; k < s->n_belts; k++)
        speed = fmax(speed, vec2_length(s->belts[k].velocity) * belt_speeds_largest(&s->belts[k]));
    const double most = fmin(longest_tick, 0.25 * smallest_radius(s) / speed);
    return (uint64_t)fmax(floor(most / dt), 1.0);
}

static run_plan plan_of(const micro_run *run)
{
    const size_t n_parts = micro_parts(run->solver);
    const bool is_planar = micro_is_planar(run->solver);
    const size_t n_advance =
        (is_planar ? PARTS_ADVANCED_PLANAR : PARTS_ADVANCED_SPATIAL) / (n_parts + 1);
    const double dt = micro_dt(run->solver);

    return (run_plan){ .dt = dt,
                       .n_steps = run__steps_until(run->scene->duration, dt),
                       .grid = run->grid,
                       .n_parts = n_parts,
                       .n_values = is_planar ? FRAME_VALUES_PLANAR : FRAME_VALUES_SPATIAL,
                       .n_advance = n_advance + 1,
                       .n_tick = choose_tick(run->scene, dt) };
}

static bf_status create_checked(const scene *s, const run__micro_setup *setup, micro_run **ret_run,
                                bf_error *err)
{
    bf_faults faults = { 0 };

    check_setup(s, setup, &faults);
    bf_status status = faults_status(&faults, err);
    if (status != BF_OK)
        return status;
    micro_run *run = memory_alloc(1, sizeof *run);
    if (run == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a run");
    if ((status = fill_run(s, &setup->def, run, err)) != BF_OK)
        destroy_run(run);
    else
        *ret_run = run;
    return status;
}

static bf_status create_run(const scene *s, int n_threads, void **ret_solver, run_plan *ret_plan,
                            bf_error *err)
{
    run__micro_setup setup;
    micro_run *run = NULL;

    bf_status status = run__micro_init_setup(s, n_threads, &setup, err);
    if (status != BF_OK)
        return status;
    status = create_checked(s, &setup, &run, err);
    run__micro_fini_setup(&setup);
    if (status != BF_OK)
        return status;
    *ret_plan = plan_of(run);
    *ret_solver = run;
    return BF_OK;
}

static bf_status advance_run(void *solver, uint64_t n, bf_error *err)
{
    micro_run *run = solver;

    return micro_advance(run->solver, n, err);
}

static void count_parts(const void *solver, double *ret_parts)
{
    const micro_run *run = solver;
    const scene *s = run->scene;

    for (size_t c = 0; c < s->n_counters; c++)
        ret_parts[c] = 0.0;
    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        const micro_part part = micro_part_of(run->solver, k);
        const vec2 at = { part.x[0], part.x[1] };
        for (size_t c = 0; c < s->n_counters && !part.is_gone; c++)
            ret_parts[c] += counter_holds(&s->counters[c], at) ? 1.0 : 0.0;
    }
}

static run_load measure_run(const void *solver)
{
    const micro_run *run = solver;
    run_load load = { .n_rows = micro_parts(run->solver) };

    for (size_t k = 0; k < load.n_rows; k++)
        load.parts += micro_is_gone(run->solver, k) ? 0.0 : 1.0;
    return load;
}

// The density (18) of the parts in the domain, so that both models can be compared cell by cell.
static bf_status take_snapshot(void *solver, float *ret_rho, run_load *ret_load, bf_error *err)
{
    micro_run *run = solver;
    const size_t n_cells = grid_cells(&run->grid), n_rows = micro_parts(run->solver);
    double peak = 0.0;
    size_t n = 0;

    if (memory_reserve(&run->poses, &run->n_poses_max, n_rows, sizeof *run->poses) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", n_rows);
    for (size_t k = 0; k < n_rows; k++) {
        const micro_part part = micro_part_of(run->solver, k);
        if (!part.is_gone)
            run->poses[n++] = (scene_pose){ part.x[0], part.x[1], 0.0 };
    }
    bf_status status =
        density_from_parts(&run->grid, run->packing, run->scene->macro.initial_mollifier,
                           run->poses, n, run->rho, err);
    if (status != BF_OK)
        return status;
    for (size_t c = 0; c < n_cells; c++) {
        ret_rho[c] = (float)run->rho[c];
        peak = fmax(peak, run->rho[c]);
    }
    *ret_load = (run_load){ .parts = (double)n, .peak = peak, .n_rows = n_rows };
    return BF_OK;
}

static void fill_row(const micro_part *part, bool is_planar, double *ret_row)
{
    if (is_planar) {
        const double row[FRAME_VALUES_PLANAR] = { part->x[0], part->x[1], part->heading,
                                                  part->v[0], part->v[1], part->w[2] };
        memcpy(ret_row, row, sizeof row);
        return;
    }
    memcpy(ret_row, part->x, sizeof part->x);
    memcpy(ret_row + 3, part->q, sizeof part->q);
    memcpy(ret_row + 7, part->v, sizeof part->v);
    memcpy(ret_row + 10, part->w, sizeof part->w);
}

static void copy_parts(const void *solver, const run_parts *ret_parts)
{
    const micro_run *run = solver;
    const bool is_planar = micro_is_planar(run->solver);
    const size_t n_values = is_planar ? FRAME_VALUES_PLANAR : FRAME_VALUES_SPATIAL;

    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        double *row = ret_parts->rows + k * n_values;
        const micro_part part = micro_part_of(run->solver, k);
        if (!part.is_gone)
            fill_row(&part, is_planar, row);
        for (size_t v = 0; v < n_values && part.is_gone; v++)
            row[v] = NAN;
    }
}

static void fill_end(const void *solver, frame_end *end)
{
    const micro_run *run = solver;
    const micro_totals totals = micro_measure(run->solver);

    end->n_parts_left = micro_parts(run->solver) - totals.n_parts;
    end->n_contacts = totals.n_contacts;
    end->kinetic_energy = totals.kinetic_energy;
    end->largest_overlap = totals.largest_overlap;
    end->overlap_share = totals.overlap_share;
}

static bf_status save_run(const void *solver, bf_buffer *out, bf_error *err)
{
    const micro_run *run = solver;

    return micro_save(run->solver, out, err);
}

static bf_status load_run(void *solver, const void *bytes, size_t n, bf_error *err)
{
    micro_run *run = solver;

    return micro_load(run->solver, bytes, n, err);
}

static uint64_t digest_run(const void *solver)
{
    const micro_run *run = solver;

    return micro_digest(run->solver);
}

const run_backend run__micro = {
    .check_scenario = check_scenario,
    .create = create_run,
    .destroy = destroy_run,
    .advance = advance_run,
    .count = count_parts,
    .measure = measure_run,
    .snapshot = take_snapshot,
    .parts = copy_parts,
    .fill_end = fill_end,
    .save = save_run,
    .load = load_run,
    .digest = digest_run,
};
