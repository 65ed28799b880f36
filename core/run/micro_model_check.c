#include "core/run/micro_model_priv.h"
#include "core/run/run_priv.h"

#include <math.h>

// Let the solver itself refuse what it cannot take, with the first part alone: that costs little.
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
    else if (probe(def, &err) != BF_OK || run_micro__check_count(s, def->dt, &err) != BF_OK)
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
    // A part reaches to where its Gaussian has fallen to 2^-53, see density.h.
    double reached =
        2.0 * M_PI * 53.0 * M_LN2 / (s->macro.initial_mollifier * s->macro.cell * s->macro.cell);
    double work = n * n_parts * fmin(reached, (double)grid_cells(&grid));

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

void run__check_micro(const scene *s, bf_faults *faults)
{
    run_micro__setup setup;
    bf_error err;

    if (run_micro__init_setup(s, 1, &setup, &err) != BF_OK) {
        faults_add_error(faults, &err);
        return;
    }
    check_step(s, &setup.def, faults);
    check_results(s, faults);
    if (placement_check_plates(s, &setup.placement, faults) != BF_OK) {
        (void)bf_fail(&err, BF_ENOMEM, "/initial", "no memory for %zu parts", setup.placement.n);
        faults_add_error(faults, &err);
    }
    run_micro__fini_setup(&setup);
}
