// Runs of both models on belts whose speed changes: what they report, and that a stop in a ramp changes nothing.

#include "core/run/run.h"

#include "core/base/memory.h"
#include "core/observe/figure.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SOLVERS = 5 };

static const struct {
    run_model model;
    scene_path path;
    scene_integrator integrator;
    double step; // of the microscopic model, s
} solvers[SOLVERS] = {
    { RUN_MACRO, SCENE_PATH_AUTO, SCENE_VERLET, 1e-5 },
    { RUN_MICRO, SCENE_PATH_PLANAR, SCENE_VERLET, 2e-5 },
    { RUN_MICRO, SCENE_PATH_PLANAR, SCENE_IMPLICIT, 1e-3 },
    { RUN_MICRO, SCENE_PATH_SPATIAL, SCENE_VERLET, 2e-5 },
    { RUN_MICRO, SCENE_PATH_SPATIAL, SCENE_IMPLICIT, 5e-4 },
};

// Example 1's obstacle, and 20 parts that reach it soon; the belt is hardly ever at a constant speed.
static void make_jam(scene *s, int solver)
{
    helper_scene_example(s, 60.0, SCENE_SEALED);
    s->initial.n_rows = 4;
    s->initial.n_columns = 5;
    s->initial.first = (vec2){ 0.40, 0.15 };
    s->duration = 0.3;
    s->macro.cell = 0.01;
    s->macro.step = 0.0025;
    s->micro.path = solvers[solver].path;
    s->micro.integrator = solvers[solver].integrator;
    s->micro.step = solvers[solver].step;
    s->micro.modulus_reduction = 1e6;
    s->micro.overlap_limit = 1.0;
    s->belts[0].acceleration = 6.0;
    s->belts[0].deceleration = 5.0;
    helper_scene_schedule(&s->belts[0], 4, (double[]){ 0.02, 0.11, 0.17, 0.26 },
                          (double[]){ 0.1, 1.6, 0.0, 1.0 });
}

static helper_run_log *new_log(int solver)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = solvers[solver].model;
    return log;
}

static void a_run_stopped_in_a_ramp_resumes_to_the_same_results(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_jam(&s, k);
        helper_run_free(helper_run_check_stops(&s, solvers[k].model, 5, HELPER_AMOUNT(1, 3),
                                               (helper_run_threads){ .before = 1, .after = 2 }));
        scene_fini(&s);
    }
}

// An S on which an eye lets the belt run back before its parts come to the first bend; all its sections are told.
static void make_path(scene *s, int solver)
{
    const vec2 points[] = { { 0.0, 0.2 }, { 0.3, 0.2 }, { 0.5, 0.4 }, { 0.8, 0.4 } };

    helper_scene_belt(s, 0.8, 0.6, 0.01, (scene_pose[]){ { 0.2, 0.2, 0.0 }, { 0.33, 0.23, 0.0 } },
                      2);
    helper_scene_add_path(s, 0.4, 0.2, 0.15, points, 4)->acceleration = 4.0;
    s->duration = 0.3;
    s->output.curve_every = 0.01;
    s->macro.closure = SCENE_CONGESTED;
    s->micro.path = solvers[solver].path;
    s->micro.integrator = solvers[solver].integrator;
    s->micro.step = solvers[solver].step;
    s->micro.modulus_reduction = 1e6;
    s->n_eyes = s->n_actions = 1;
    s->eyes = memory_alloc(1, sizeof *s->eyes);
    s->actions = memory_alloc(1, sizeof *s->actions);
    assert_true(s->eyes != NULL && s->actions != NULL);
    scene_photo_eye_init(&s->eyes[0]);
    s->eyes[0].line[0] = (vec2){ 0.23, 0.1 };
    s->eyes[0].line[1] = (vec2){ 0.23, 0.3 };
    s->eyes[0].density_ratio = 0.01;
    scene_action_init(&s->actions[0]);
    s->actions[0].eye = s->actions[0].target = 0;
    s->actions[0].when_blocked = true;
    s->actions[0].delay = 0.02;
    s->actions[0].type = SCENE_ACTION_BELT;
    s->actions[0].value = -0.5;
    helper_scene_resolve(s);
}

static void a_run_along_a_path_that_an_eye_commands_resumes_to_the_same_results(void **state)
{
    for (int k = 0; k < SOLVERS; k += 2) {
        scene s;
        make_path(&s, k);
        helper_run_log *log = helper_run_check_stops(
            &s, solvers[k].model, 4, 1, (helper_run_threads){ .before = 1, .after = 2 });
        const uint32_t speed = log->begin.n_columns - 1;
        assert_near(log->values[0][speed], 0.4, 1e-12);
        assert_near(helper_run_at(log, 0.3)[speed], -0.2, 1e-12);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// From 0.0395 m/s at 0.11 s the belt has 0.3995 m/s at 0.17 s, and stands 0.0799 s later, until 0.26 s.
static void speeds_and_stops_of_a_belt_are_told(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        helper_run_log *log = new_log(k);
        scene s;
        make_jam(&s, k);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        const double *stopped = &log->figures[figure_at(&s, FIGURE_STOPPED_COUNT, 0)];
        const uint32_t speed = log->begin.n_columns - 1;
        assert_true(stopped[0] == 1.0);
        assert_near(stopped[1], 0.0101, 1e-12);
        assert_near(stopped[2], 0.0101, 1e-12);
        assert_near(log->values[0][speed], 0.395, 1e-15);
        assert_near(helper_run_at(log, 0.11)[speed], 0.0395, 1e-15);
        assert_true(helper_run_at(log, 0.25)[speed] == 0.0);
        scene_fini(&s);
        helper_run_free(log);
    }
}

static void a_checkpoint_fits_no_other_schedule(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        helper_run_log *log = new_log(k);
        scene s;
        make_jam(&s, k);
        log->stop_at = 1;
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        s.belts[0].speed_schedule.factors[3] = 1.0 + 0x1p-40;
        assert_int_equal(helper_run(&s, 1, 1, log), BF_ECORRUPT);
        scene_fini(&s);
        helper_run_free(log);
    }
}

// The belt stands from 0.3 s on, 0.3 m before the plate, after it has moved by 0.395 m/s (0.2 s + 0.1 s / 2).
static void while_a_belt_stands_the_curve_does_not_move(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        helper_run_log *log = new_log(k);
        scene s;
        make_jam(&s, k);
        s.duration = 0.5;
        s.initial.first = (vec2){ 0.2, 0.15 };
        s.counters[0].rect.x_max = 0.2 + 0.395 * 0.25 + 0.02;
        s.belts[0].deceleration = 0.395 / 0.1;
        s.belts[0].speed_schedule.n_times = s.belts[0].speed_schedule.n_factors = 1;
        s.belts[0].speed_schedule.times[0] = 0.2;
        s.belts[0].speed_schedule.factors[0] = 0.0;
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        const double *start = helper_run_at(log, 0.0);
        const double *then = helper_run_at(log, 0.4), *end = helper_run_at(log, 0.5);
        assert_true(then[0] < start[0] && then[0] > 0.0);
        // Parts come to rest by friction within some 10 ms, and the counter ends between their columns.
        assert_true(then[0] == end[0]);
        scene_fini(&s);
        helper_run_free(log);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_stopped_in_a_ramp_resumes_to_the_same_results),
        cmocka_unit_test(a_run_along_a_path_that_an_eye_commands_resumes_to_the_same_results),
        cmocka_unit_test(speeds_and_stops_of_a_belt_are_told),
        cmocka_unit_test(a_checkpoint_fits_no_other_schedule),
        cmocka_unit_test(while_a_belt_stands_the_curve_does_not_move),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
