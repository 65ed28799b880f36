// The microscopic model as a run sees it: scenario to solver, parts to counts and density.

#include "core/base/faults.h"
#include "core/base/memory.h"
#include "core/run/counter.h"
#include "core/run/micro_model_priv.h"
#include "core/run/run_priv.h"
#include "core/scene/density.h"

#include <math.h>
#include <string.h>

// Steps of so many parts take some 10 ms on a slow processor, more where bodies move in space.
enum { PARTS_ADVANCED_PLANAR = 200000, PARTS_ADVANCED_SPATIAL = 10000 };

typedef struct micro_run {
    micro_solver *solver;
    const scene *scene;
    double packing; // parts/m2 at density 1
    bf_grid grid;
    double *rho;       // of the last snapshot
    scene_pose *poses; // of the parts in the domain then
} micro_run;

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

static bf_status fill_run(const scene *s, int n_threads, micro_run *run, bf_error *err)
{
    run_micro__setup setup;

    run->scene = s;
    run->packing = scene_packing_density(s);
    run->grid = scene_grid(s);
    run->rho = memory_alloc(grid_cells(&run->grid), sizeof *run->rho);
    run->poses = memory_alloc(scene_parts(s), sizeof *run->poses);
    if (run->rho == NULL || run->poses == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the density of the parts");
    bf_status status = run_micro__init_setup(s, n_threads, &setup, err);
    if (status == BF_OK)
        status = micro_create(&setup.def, &run->solver, err);
    run_micro__fini_setup(&setup);
    return status;
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
                       .n_advance = n_advance + 1 };
}

static bf_status create_run(const scene *s, int n_threads, void **ret_solver, run_plan *ret_plan,
                            bf_error *err)
{
    bf_faults faults = { 0 };
    micro_run *run = NULL;

    run__check_micro(s, &faults);
    bf_status status = faults_status(&faults, err);
    if (status != BF_OK)
        return status;
    if ((run = memory_alloc(1, sizeof *run)) == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a run");
    if ((status = fill_run(s, n_threads, run, err)) != BF_OK) {
        destroy_run(run);
        return status;
    }
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
    run_load load = { 0 };

    for (size_t k = 0; k < micro_parts(run->solver); k++)
        load.parts += micro_is_gone(run->solver, k) ? 0.0 : 1.0;
    return load;
}

// The density (18) of the parts in the domain, so that both models can be compared cell by cell.
static bf_status take_snapshot(void *solver, float *ret_rho, run_load *ret_load, bf_error *err)
{
    micro_run *run = solver;
    const size_t n_cells = grid_cells(&run->grid);
    double peak = 0.0;
    size_t n = 0;

    for (size_t k = 0; k < micro_parts(run->solver); k++) {
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
    *ret_load = (run_load){ .parts = (double)n, .peak = peak };
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

static void copy_parts(const void *solver, double *ret_rows)
{
    const micro_run *run = solver;
    const bool is_planar = micro_is_planar(run->solver);
    const size_t n_values = is_planar ? FRAME_VALUES_PLANAR : FRAME_VALUES_SPATIAL;

    for (size_t k = 0; k < micro_parts(run->solver); k++) {
        double *row = ret_rows + k * n_values;
        const micro_part part = micro_part_of(run->solver, k);
        if (!part.is_gone)
            fill_row(&part, is_planar, row);
        for (size_t v = 0; v < n_values && part.is_gone; v++)
            row[v] = NAN;
    }
}

static void tell_end(const void *solver, frame_end *end)
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
    .check_scenario = run__check_micro,
    .create = create_run,
    .destroy = destroy_run,
    .advance = advance_run,
    .count = count_parts,
    .measure = measure_run,
    .snapshot = take_snapshot,
    .parts = copy_parts,
    .tell_end = tell_end,
    .save = save_run,
    .load = load_run,
    .digest = digest_run,
};
