// Runs of both models with feeds, photo eyes and actions: nothing is lost, and stops and threads change nothing.

#include "core/base/memory.h"
#include "core/run/run.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SOLVERS = 5 };

// Columns of the scenes here.
enum { INSIDE, LEFT, OFFERED, ADMITTED, WAITING, DISCARDED, BLOCKED };

static const struct {
    run_model model;
    scene_closure closure;
    scene_path path;
    scene_integrator integrator;
    double step; // of the microscopic model, s
} solvers[SOLVERS] = {
    { RUN_MACRO, SCENE_DISPERSIVE, SCENE_PATH_AUTO, SCENE_VERLET, 1e-5 },
    { RUN_MACRO, SCENE_CONGESTED, SCENE_PATH_AUTO, SCENE_VERLET, 1e-5 },
    { RUN_MICRO, SCENE_DISPERSIVE, SCENE_PATH_PLANAR, SCENE_VERLET, 2e-5 },
    { RUN_MICRO, SCENE_DISPERSIVE, SCENE_PATH_PLANAR, SCENE_IMPLICIT, 1e-3 },
    { RUN_MICRO, SCENE_DISPERSIVE, SCENE_PATH_SPATIAL, SCENE_IMPLICIT, 1e-3 },
};

static void add_feed(scene *s, double rate)
{
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_POISSON, rate);
}

// A photo eye across the belt at x, m.
static void add_eye(scene *s, double x)
{
    s->n_eyes = 1;
    s->eyes = memory_alloc(1, sizeof *s->eyes);
    assert_non_null(s->eyes);
    scene_photo_eye_init(s->eyes);
    s->eyes[0].line[0] = (vec2){ x, 0.0 };
    s->eyes[0].line[1] = (vec2){ x, 0.16 };
}

// At the eye's change the first belt heads for a factor.
static void add_action(scene *s, bool when_blocked, double delay, double factor)
{
    scene_action *all = memory_alloc(s->n_actions + 1, sizeof *all);

    assert_non_null(all);
    if (s->n_actions > 0)
        memcpy(all, s->actions, s->n_actions * sizeof *all);
    memory_free(s->actions);
    s->actions = all;
    scene_action_init(&all[s->n_actions]);
    all[s->n_actions].eye = 0;
    all[s->n_actions].when_blocked = when_blocked;
    all[s->n_actions].delay = delay;
    all[s->n_actions].type = SCENE_ACTION_BELT;
    all[s->n_actions].target = 0;
    all[s->n_actions++].value = factor;
}

// A belt of 0.4 m/s, 0.4 m x 0.16 m, which starts empty.
static void make_belt(scene *s, int solver)
{
    helper_scene_belt(s, 0.4, 0.16, 0.01, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->macro.closure = solvers[solver].closure;
    s->micro.path = solvers[solver].path;
    s->micro.integrator = solvers[solver].integrator;
    s->micro.step = solvers[solver].step;
    s->micro.modulus_reduction = 1e4;
    if (solvers[solver].integrator == SCENE_VERLET)
        s->micro.modulus_reduction = 1e6;
    s->output.curve_every = 0.05;
    s->output.snapshot_every = 0.5;
    scene_belt *belt = helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    belt->acceleration = 2.0;
    belt->deceleration = 2.0;
}

// Fed with 60 parts/s through a stop of the belt from 0.6 s to 1.2 s, in which no part finds a place.
static void make_stop(scene *s, int solver)
{
    make_belt(s, solver);
    s->duration = 2.0;
    helper_scene_schedule(&s->belts[0], 2, (double[]){ 0.6, 1.2 }, (double[]){ 0.0, 1.0 });
    add_feed(s, 60.0);
    add_eye(s, 0.3);
    s->eyes[0].density_ratio = 0.3; // 60/s are 0.47 of close packing
    helper_scene_resolve(s);
}

static helper_run_log *new_log(int solver)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = solvers[solver].model;
    return log;
}

static void nothing_is_lost_through_a_blocked_inlet(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        const double tolerance = solvers[k].model == RUN_MICRO ? 0.0 : 1e-9 * 120.0;
        helper_run_log *log = new_log(k);
        bool was_blocked = false;
        scene s;
        make_stop(&s, k);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        assert_int_equal(log->begin.n_columns, 8); // with the speed of the belt
        for (size_t i = 0; i < log->n_samples; i++) {
            const double *v = log->values[i];
            assert_near(v[OFFERED], v[ADMITTED] + v[WAITING] + v[DISCARDED], tolerance);
            assert_near(v[ADMITTED], v[INSIDE] + v[LEFT], tolerance);
            was_blocked |= v[WAITING] > 5.0;
        }
        assert_true(was_blocked);
        const double *last = log->values[log->n_samples - 1];
        assert_true(last[OFFERED] > 90.0 && last[LEFT] > 20.0 && last[DISCARDED] == 0.0);
        assert_near(log->end.parts_entered, last[ADMITTED], 0.0);
        assert_near(log->end.parts_end, last[INSIDE], tolerance);
        if (solvers[k].model == RUN_MICRO)
            assert_near((double)log->n_present, last[INSIDE], 0.0);
        scene_fini(&s);
        helper_run_free(log);
    }
}

// Parts that have just entered lie on the side with the feed, also while their belt stands.
static void parts_on_the_line_of_their_feed_are_inside(void **state)
{
    static const struct {
        scene_side side;
        vec2 velocity;
    } cases[] = { { SCENE_WEST, { 0.4, 0.0 } },
                  { SCENE_EAST, { -0.4, 0.0 } },
                  { SCENE_SOUTH, { 0.0, 0.4 } },
                  { SCENE_NORTH, { 0.0, -0.4 } } };
    enum { PLANAR_IMPLICIT = 3 };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        helper_run_log *log = new_log(PLANAR_IMPLICIT);
        scene s;
        make_belt(&s, PLANAR_IMPLICIT);
        s.belts[0].velocity = cases[k].velocity;
        helper_scene_schedule(&s.belts[0], 2, (double[]){ 0.3, 0.6 }, (double[]){ 0.0, 1.0 });
        helper_scene_add_feed(&s, cases[k].side, SCENE_ARRIVALS_POISSON, 100.0);
        helper_scene_resolve(&s);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        assert_true(log->values[log->n_samples - 1][ADMITTED] > 30.0);
        for (size_t i = 0; i < log->n_samples; i++)
            assert_near(log->values[i][ADMITTED], log->values[i][INSIDE] + log->values[i][LEFT],
                        0.0);
        scene_fini(&s);
        helper_run_free(log);
    }
}

static void a_run_stopped_anywhere_resumes_to_the_same_results(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_stop(&s, k);
        add_action(&s, true, 0.1, 0.5);
        add_action(&s, false, 0.0, 1.0);
        helper_scene_resolve(&s);
        helper_run_log *whole =
            helper_run_check_stops(&s, solvers[k].model, 4, HELPER_AMOUNT(1, 2),
                                   (helper_run_threads){ .before = 2, .after = 1 });
        assert_true(whole->n_changes > 1);
        scene_fini(&s);
        helper_run_free(whole);
    }
}

static void a_drained_run_ends_before_its_duration(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        helper_run_log *log = new_log(k);
        scene s;
        make_belt(&s, k);
        s.duration = 20.0;
        s.until = SCENE_UNTIL_DRAINED;
        add_feed(&s, 40.0);
        s.feeds[0].arrivals = SCENE_ARRIVALS_REGULAR;
        s.feeds[0].count = 10.0;
        helper_scene_resolve(&s);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        // The last one arrives at 9.5/40 s, and is 1 s on its way.
        assert_int_equal(log->end.reason, FRAME_END_DRAINED);
        assert_int_equal(log->end.stopped, 0);
        assert_true(log->end.t > 1.0 && log->end.t < 1.5);
        assert_true(log->end.n_steps < log->begin.n_steps);
        assert_near(log->t[log->n_samples - 1], log->end.t, 0.0);
        assert_near(log->values[log->n_samples - 1][LEFT], 10.0,
                    solvers[k].model == RUN_MICRO ? 0.0 : 0.5);
        // Ten parts of 1 s each; one that leaves counts up to a tick, 0.25 12 mm by 0.4 m/s, and a step longer.
        if (solvers[k].model == RUN_MICRO)
            assert_near(log->end.part_steps * log->begin.dt, 10.0, 10.0 * 0.0085);
        scene_fini(&s);
        helper_run_free(log);
    }
}

// One part that enters at 0 s in the middle of the west side.
static void add_one_part(scene *s)
{
    scene_arrival_list *list;

    add_feed(s, NAN);
    s->feeds[0].demand = SCENE_DEMAND_SCHEDULE;
    list = &s->feeds[0].schedule;
    list->n = 1;
    list->times = memory_alloc(1, sizeof *list->times);
    list->places = memory_alloc(1, sizeof *list->places);
    assert_true(list->times != NULL && list->places != NULL);
    list->places[0] = 0.5;
}

// The part, of 12 mm radius, meets the eye at 0.2 m when its centre is at 0.188 m, or 3 mm, a tick, later. The belt
// then stops within 0.4^2/(2 0.8) m = 0.1 m, and the part slips by 0.4/(10 g) m = 4 mm more, g = 9.81, as friction is
// mu g tanh(10 v) with mu = 1.
static void a_photo_eye_stops_a_belt(void **state)
{
    for (int k = 2; k < SOLVERS; k++) {
        helper_run_log *log = new_log(k);
        scene s;
        make_belt(&s, k);
        s.duration = 1.5;
        s.belts[0].deceleration = 0.8;
        add_one_part(&s);
        add_eye(&s, 0.2);
        add_action(&s, true, 0.0, 0.0);
        helper_scene_resolve(&s);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        assert_int_equal(log->n_changes, 3);
        assert_int_equal(log->changes[0].type, FRAME_CHANGE_EYE);
        assert_int_equal(log->changes[0].state, 1);
        assert_int_equal(log->changes[1].type, FRAME_CHANGE_ACTION);
        assert_true(log->changes[0].t >= 0.469 && log->changes[0].t < 0.480);
        assert_near(log->changes[1].t, log->changes[0].t, 0.0);
        assert_int_equal(log->begin.n_values, k == 4 ? 15 : 8);
        assert_true(log->parts[0] == 0.0 && log->parts[1] == 0.0); // id and kind
        assert_true(log->parts[2] > 0.288 && log->parts[2] < 0.297);
        // Where it stands the eye is clear again.
        assert_int_equal(log->changes[2].state, 0);
        assert_true(helper_run_at(log, 0.5)[BLOCKED] == 1.0);
        assert_true(log->values[log->n_samples - 1][BLOCKED] == 0.0);
        scene_fini(&s);
        helper_run_free(log);
    }
}

// Parts of 12 mm radius, 24.5 mm apart, so that each beam is free for 1.25 ms: more than a step, and a sixth of a tick.
static void gaps_that_are_shorter_than_a_tick_are_seen(void **state)
{
    static const scene_pose poses[] = { { 0.1, 0.08, 0.0 }, { 0.1245, 0.08, 0.0 } };
    enum { EYES = 5 };
    helper_run_log *log = new_log(3);
    scene s;
    helper_scene_belt(&s, 0.4, 0.16, 0.01, poses, 2);
    s.micro.integrator = SCENE_IMPLICIT;
    s.micro.step = 1e-3;
    s.micro.modulus_reduction = 1e4;
    s.duration = 0.8;
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, NULL, 0);
    s.n_eyes = EYES;
    s.eyes = memory_alloc(EYES, sizeof *s.eyes);
    for (size_t k = 0; k < EYES; k++) {
        scene_photo_eye_init(&s.eyes[k]);
        snprintf(s.eyes[k].id, sizeof s.eyes[k].id, "eye-%zu", k);
        s.eyes[k].line[0] = (vec2){ 0.2 + 7e-4 * (double)k, 0.0 };
        s.eyes[k].line[1] = (vec2){ 0.2 + 7e-4 * (double)k, 0.16 };
    }
    helper_scene_resolve(&s);
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    assert_int_equal(log->n_changes, 4 * EYES);
    scene_fini(&s);
    helper_run_free(log);
}

static void samples_follow_the_windows(void **state)
{
    scene_output_window *w = memory_alloc(1, sizeof *w);
    helper_run_log *log = new_log(0);
    scene s;

    make_belt(&s, 0);
    s.duration = 1.0;
    s.output.curve_every = 0.5;
    scene_output_window_init(w);
    w->from = 0.7;
    w->to = 0.9;
    w->curve_every = 0.1;
    s.output.n_windows = 1;
    s.output.windows = w;
    add_feed(&s, 10.0);
    helper_scene_resolve(&s);
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    assert_int_equal(log->n_samples, 5); // 0, 0.5, 0.7, 0.8, 1
    assert_near(log->t[2], 0.7, 1e-2);
    assert_near(log->t[3], 0.8, 1e-2);
    scene_fini(&s);
    helper_run_free(log);
}

static void out_of_memory_anywhere_ends_the_run(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        bf_status status = BF_ENOMEM;
        scene s;
        make_belt(&s, k);
        s.duration = 0.05;
        s.micro.step = 0.0;
        add_feed(&s, 200.0);
        add_eye(&s, 0.01);
        add_action(&s, true, 0.0, 0.5);
        helper_scene_resolve(&s);
        for (size_t n = 1; status != BF_OK; n++) {
            helper_run_log *log = new_log(k);
            memory_plan_fault(n, 0);
            status = helper_run(&s, 1, 0, log);
            const size_t n_faults = memory_faults();
            memory_plan_fault(0, 0);
            assert_true(status == (n_faults > 0 ? BF_ENOMEM : BF_OK));
            helper_run_free(log);
        }
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_lost_through_a_blocked_inlet),
        cmocka_unit_test(parts_on_the_line_of_their_feed_are_inside),
        cmocka_unit_test(a_run_stopped_anywhere_resumes_to_the_same_results),
        cmocka_unit_test(a_drained_run_ends_before_its_duration),
        cmocka_unit_test(a_photo_eye_stops_a_belt),
        cmocka_unit_test(gaps_that_are_shorter_than_a_tick_are_seen),
        cmocka_unit_test(samples_follow_the_windows),
        cmocka_unit_test(out_of_memory_anywhere_ends_the_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
