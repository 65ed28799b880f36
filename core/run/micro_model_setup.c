#include "core/run/micro_model_priv.h"

#include <math.h>
#include <string.h>

static void set_kinds(const scene *s, run_micro__setup *setup)
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
}

bf_status run_micro__check_count(const scene *s, double dt, bf_error *err)
{
    double n = ceil(s->duration / dt);

    if (n <= SCENE_STEPS_MAX)
        return BF_OK;
    return bf_fail(err, BF_ELIMIT, s->micro.step > 0.0 ? "/micro/step_s" : "/duration_s",
                   "%.10g steps of the microscopic model, the limit is %.10g", n, SCENE_STEPS_MAX);
}

// The step that "auto" stands for: the paper's, where that is stable, or the implicit integrator's own.
static double choose_step(const micro_def *def)
{
    return def->integrator == MICRO_VERLET ? fmin(1e-5, micro_dt_stable(def))
                                           : micro_dt_chosen(def);
}

bf_status run_micro__init_setup(const scene *s, int n_threads, run_micro__setup *setup,
                                bf_error *err)
{
    *setup = (run_micro__setup){ .def = micro_def_default() };
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

void run_micro__fini_setup(run_micro__setup *setup)
{
    if (setup == NULL)
        return;
    placement_fini(&setup->placement);
    *setup = (run_micro__setup){ .def = { .n_parts = 0 } };
}
