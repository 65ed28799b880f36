// How fast this machine is: small scenarios, one for each kind of solver, in which cargo comes to a plate and jams.

#include "core/advice/prediction.h"
#include "core/base/memory.h"

#include <math.h>

/// How the scenario of a kind differs from the others.
typedef struct variant {
    run_model model;
    scene_closure closure;
    scene_scheme scheme;
    scene_integrator integrator;
    scene_path path;
    double duration;    // s, for some 10 ms of CPU time
    double reference_s; // CPU time of its last three quarters on the machine of the costs
} variant;

static const variant variants[PREDICTION_KIND_COUNT] = {
    [PREDICTION_ROE] = { .model = RUN_MACRO, .duration = 1.0, .reference_s = 1.06e-3 },
    [PREDICTION_MUSCL] = { .model = RUN_MACRO,
                           .scheme = SCENE_SCHEME_MUSCL,
                           .duration = 0.3,
                           .reference_s = 1.51e-3 },
    [PREDICTION_CONGESTED] = { .model = RUN_MACRO,
                               .closure = SCENE_CONGESTED,
                               .duration = 1.0,
                               .reference_s = 2.44e-3 },
    [PREDICTION_PLANAR_VERLET] = { .model = RUN_MICRO, .duration = 0.1, .reference_s = 4.00e-3 },
    [PREDICTION_PLANAR_IMPLICIT] = { .model = RUN_MICRO,
                                     .integrator = SCENE_IMPLICIT,
                                     .duration = 1.5,
                                     .reference_s = 7.64e-3 },
    [PREDICTION_SPATIAL_VERLET] = { .model = RUN_MICRO,
                                    .path = SCENE_PATH_SPATIAL,
                                    .duration = 0.01,
                                    .reference_s = 13.2e-3 },
    [PREDICTION_SPATIAL_IMPLICIT] = { .model = RUN_MICRO,
                                      .integrator = SCENE_IMPLICIT,
                                      .path = SCENE_PATH_SPATIAL,
                                      .duration = 0.1,
                                      .reference_s = 61.4e-3 },
};

// A plate at 60 degrees.
static bf_status add_plate(scene *s, bf_error *err)
{
    s->obstacles = memory_alloc(1, sizeof *s->obstacles);
    vec2 *path = memory_alloc(2, sizeof *path);
    if (s->obstacles == NULL || path == NULL) {
        memory_free(path);
        return bf_fail(err, BF_ENOMEM, "", "no memory for a plate");
    }
    scene_obstacle_init(s->obstacles);
    s->n_obstacles = 1;
    path[0] = (vec2){ 0.25, 0.0 };
    path[1] = (vec2){ 0.25 + 0.25 / sqrt(3.0), 0.25 };
    s->obstacles[0].path = path;
    s->obstacles[0].n_points = 2;
    return BF_OK;
}

static bf_status make_scene(const variant *v, scene *s, bf_error *err)
{
    bf_faults faults = { 0 };

    scene_init(s);
    s->duration = v->duration;
    s->domain = (scene_rect){ 0.0, 0.6, 0.0, 0.36 };
    s->initial.type = SCENE_INITIAL_HEXAGONAL;
    s->initial.n_rows = 8;
    s->initial.n_columns = 6;
    s->initial.first = (vec2){ 0.1, 0.06 };
    s->initial.spacing = 0.0245;
    s->output.curve_every = s->output.snapshot_every = 0.25 * v->duration;
    s->macro.cell = 0.01;
    s->macro.step = 0.0;
    s->macro.closure = v->closure;
    s->macro.scheme = v->scheme;
    s->micro.integrator = v->integrator;
    s->micro.path = v->path;
    bf_status status = add_plate(s, err);
    if (status == BF_OK)
        status = scene_resolve(s, err);
    if (status == BF_OK) {
        scene_check(s, &faults);
        run_check(s, v->model, &faults);
        status = faults_status(&faults, err);
    }
    return status;
}

/// The time of a run from its first quarter on: what comes before depends on how the process gets its memory.
typedef struct stopwatch {
    double (*cpu_s)(void);
    double begin_s, end_s; // by the clock; begin_s NAN: not yet
} stopwatch;

static bf_status on_frame(void *context, const frame *f, bf_error *err)
{
    stopwatch *w = context;

    (void)err;
    if (f->type == FRAME_SNAPSHOT && isnan(w->begin_s) && f->snapshot.t > 0.0)
        w->begin_s = w->cpu_s();
    if (f->type == FRAME_END)
        w->end_s = w->cpu_s();
    return BF_OK;
}

static bf_status solve(const scene *s, run_model model, stopwatch *watch, bf_error *err)
{
    const run_sink sink = { .context = watch, .on_frame = on_frame };
    run *r = NULL;

    bf_status status = run_create(s, model, 1, &r, err);
    if (status == BF_OK)
        status = run_execute(r, &sink, err);
    run_destroy(r);
    return status;
}

bf_status prediction_measure(prediction_kind kind, double (*cpu_s)(void), double least_s,
                             double *ret_factor, bf_error *err)
{
    const variant *v = &variants[kind];
    const double first = cpu_s();
    double best = INFINITY;
    scene s;

    bf_status status = make_scene(v, &s, err);
    do {
        stopwatch watch = { .cpu_s = cpu_s, .begin_s = (double)NAN };
        if (status == BF_OK)
            status = solve(&s, v->model, &watch, err);
        best = fmin(best, watch.end_s - watch.begin_s);
    } while (status == BF_OK && cpu_s() < first + least_s);
    scene_fini(&s);
    if (status == BF_OK)
        *ret_factor = best / v->reference_s;
    return status;
}
