// Runs of both models on belts that fail: what they report, that nothing is lost, and that any threads and a stop change
// nothing.

#include "core/base/memory.h"
#include "core/observe/columns.h"
#include "core/observe/figure.h"
#include "core/run/run.h"
#include "core/world/belt_stops.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Bodies in space take long, and have the belts of the others.
enum { SOLVERS = 4, PLANAR = 3 };

static const struct {
    run_model model;
    scene_closure closure;
    scene_path path;
} solvers[SOLVERS] = {
    { RUN_MACRO, SCENE_CONGESTED, SCENE_PATH_AUTO },
    { RUN_MACRO, SCENE_DISPERSIVE, SCENE_PATH_AUTO },
    { RUN_MICRO, SCENE_CONGESTED, SCENE_PATH_PLANAR },
    { RUN_MICRO, SCENE_CONGESTED, SCENE_PATH_SPATIAL },
};

static helper_run_log *new_log(int solver)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = solvers[solver].model;
    return log;
}

// Two belts of 0.5 m x 0.2 m in a row, the second one with n kinds of failures, which the caller fills in.
static scene_failure *make_line(scene *s, int solver, size_t n)
{
    static const vec2 first[] = { { 0.0, 0.0 }, { 0.5, 0.0 }, { 0.5, 0.2 }, { 0.0, 0.2 } };
    static const vec2 second[] = { { 0.5, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.2 }, { 0.5, 0.2 } };

    helper_scene_belt(s, 1.0, 0.2, 0.02, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    (void)helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, first, 4);
    scene_belt *belt = helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, second, 4);
    s->macro.closure = solvers[solver].closure;
    s->micro.path = solvers[solver].path;
    s->micro.integrator = SCENE_IMPLICIT;
    s->micro.step = 0.0;
    s->output.curve_every = 0.1;
    s->output.snapshot_every = 5.0;
    belt->stops.n_failures = n;
    belt->stops.failures = memory_alloc(n, sizeof *belt->stops.failures);
    assert_non_null(belt->stops.failures);
    return belt->stops.failures;
}

static void set_list(scene_failure *f, size_t n, const double *times, const double *durations)
{
    const scene_series copy = helper_scene_series(n, times, durations, INFINITY);

    f->type = SCENE_FAILURE_LISTED;
    f->n_times = f->n_durations = n;
    f->times = copy.times;
    f->durations = copy.values;
}

static void set_break(scene *s, scene_break entry)
{
    scene_stops *stops = &s->belts[1].stops;

    stops->breaks = memory_alloc(1, sizeof *stops->breaks);
    assert_non_null(stops->breaks);
    stops->breaks[0] = entry;
    stops->n_breaks = 1;
}

static size_t column_of(const scene *s, const char *name)
{
    char of[COLUMN_NAME_SIZE];
    size_t k = 0;

    do
        columns_name(s, k++, of);
    while (strcmp(of, name) != 0);
    return k - 1;
}

// After the warm-up of 1 s there are 9 s, of which breaks take 1 s and failures outside them 1.5 s.
static void availability_and_failures_are_told(void **state)
{
    static const double times[] = { 0.2, 2.0, 6.0 }, lasts[] = { 0.5, 1.0, 0.5 };
    static const struct {
        double t;
        belt_stops_cause state;
    } expected[] = { { 0.2, BELT_STOPS_BY_FAILURE }, { 0.7, BELT_STOPS_BY_NOTHING },
                     { 2.0, BELT_STOPS_BY_FAILURE }, { 3.0, BELT_STOPS_BY_NOTHING },
                     { 3.5, BELT_STOPS_BY_BREAK },   { 4.0, BELT_STOPS_BY_NOTHING },
                     { 6.0, BELT_STOPS_BY_FAILURE }, { 6.5, BELT_STOPS_BY_NOTHING },
                     { 7.5, BELT_STOPS_BY_BREAK },   { 8.0, BELT_STOPS_BY_NOTHING } };
    enum { N = sizeof expected / sizeof *expected };
    for (int k = 0; k < PLANAR; k++) {
        helper_run_log *log = new_log(k);
        scene s;
        set_list(make_line(&s, k, 1), 3, times, lasts);
        set_break(&s, (scene_break){ .start = 3.5, .duration = 0.5, .every = 4.0 });
        (void)helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 10.0);
        s.duration = 10.0;
        s.warmup = 1.0;
        helper_scene_resolve(&s);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        assert_near(log->figures[figure_at(&s, FIGURE_AVAILABILITY, 0)], 6.5 / 8.0, 1e-11);
        assert_true(log->figures[figure_at(&s, FIGURE_FAILED_COUNT, 0)] == 2.0);
        assert_near(log->figures[figure_at(&s, FIGURE_FAILED_TOTAL, 0)], 1.5, 1e-11);
        assert_true(log->figures[figure_at(&s, FIGURE_STOPPED_COUNT, 0)] == 4.0);
        assert_near(log->figures[figure_at(&s, FIGURE_STOPPED_TOTAL, 0)], 2.5, 1e-11);
        const size_t failed = column_of(&s, "failure-1.failed"),
                     speed = column_of(&s, "belt-2.speed_m_s");
        assert_true(helper_run_at(log, 2.5)[failed] == 1.0 &&
                    helper_run_at(log, 2.5)[speed] == 0.0);
        assert_true(helper_run_at(log, 3.7)[failed] == 0.0 &&
                    helper_run_at(log, 3.7)[speed] == 0.0);
        assert_true(helper_run_at(log, 5.0)[failed] == 0.0 &&
                    helper_run_at(log, 5.0)[speed] == 0.4);
        assert_int_equal(log->n_changes, N);
        for (size_t i = 0; i < N; i++) {
            const frame_change *c = &log->changes[i];
            assert_int_equal(c->type, FRAME_CHANGE_BELT);
            assert_int_equal(c->item, 1);
            assert_string_equal(c->id, "belt-2");
            assert_int_equal(c->state, expected[i].state);
            assert_true(c->t >= expected[i].t - 1e-9 && c->t < expected[i].t + 0.05);
        }
        scene_fini(&s);
        helper_run_free(log);
    }
}

// A kind of failure about every 0.6 s, one about every 1.5 s, and a photo eye that slows the same belt down.
static void make_eventful(scene *s, int solver)
{
    scene_failure *f = make_line(s, solver, 2);

    f[0] = (scene_failure){ .type = SCENE_FAILURE_DRAWN,
                            .between = { 0.5, SCENE_TIME_WEIBULL, 1.5 },
                            .repair = { 0.1, SCENE_TIME_EXPONENTIAL, 1.0 } };
    f[1] = (scene_failure){ .type = SCENE_FAILURE_DRAWN,
                            .between = { 1.2, SCENE_TIME_EXPONENTIAL, 1.0 },
                            .repair = { 0.3, SCENE_TIME_FIXED, 1.0 } };
    s->belts[1].acceleration = s->belts[1].deceleration = 2.0;
    s->eyes = memory_alloc(1, sizeof *s->eyes);
    s->actions = memory_alloc(2, sizeof *s->actions);
    assert_true(s->eyes != NULL && s->actions != NULL);
    s->n_eyes = 1;
    scene_photo_eye_init(&s->eyes[0]);
    s->eyes[0].line[0] = (vec2){ 0.6, 0.0 };
    s->eyes[0].line[1] = (vec2){ 0.6, 0.2 };
    s->n_actions = 2;
    for (size_t k = 0; k < 2; k++) {
        scene_action_init(&s->actions[k]);
        s->actions[k].type = SCENE_ACTION_BELT;
        s->actions[k].when_blocked = k == 0;
        s->actions[k].target = 1;
        s->actions[k].value = k == 0 ? 0.6 : 1.0;
    }
    (void)helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_POISSON, 12.0);
    s->duration = 3.0;
    helper_scene_resolve(s);
}

static void threads_and_a_stop_change_no_bit(void **state)
{
    for (int k = 0; k < PLANAR; k++) {
        scene s;
        make_eventful(&s, k);
        helper_run_log *whole =
            helper_run_check_stops(&s, solvers[k].model, 6, HELPER_AMOUNT(2, 4),
                                   (helper_run_threads){ .before = 1, .after = 2 });
        assert_true(whole->figures[figure_at(&s, FIGURE_FAILED_COUNT, 0)] > 1.0);
        scene_fini(&s);
        helper_run_free(whole);
    }
}

static void both_models_have_the_same_failures_and_another_substream_has_others(void **state)
{
    double failed[SOLVERS + 1] = { 0.0 };
    for (int k = 0; k <= SOLVERS; k++) {
        helper_run_log *log = new_log(k % SOLVERS);
        scene s;
        make_eventful(&s, k % SOLVERS);
        s.n_actions = 0; // the models' photo eyes differ
        s.belts[1].is_commanded = false;
        s.substream = k == SOLVERS ? 1 : 0;
        helper_scene_resolve(&s);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        failed[k] = log->figures[figure_at(&s, FIGURE_FAILED_TOTAL, 0)];
        scene_fini(&s);
        helper_run_free(log);
    }
    for (int k = 1; k < SOLVERS; k++)
        assert_near(failed[k], failed[0], 1e-11);
    assert_true(failed[SOLVERS] != failed[0]);
}

// In a closed box, 60 parts that the second belt drives against its end and does not, in turn.
static void nothing_is_lost_where_belts_fail(void **state)
{
    for (int k = 0; k < HELPER_AMOUNT(SOLVERS, PLANAR); k++) {
        helper_run_log *log = new_log(k);
        scene s;
        scene_failure *f = make_line(&s, k, 1);
        f[0] = (scene_failure){ .type = SCENE_FAILURE_DRAWN,
                                .between = { 0.3, SCENE_TIME_EXPONENTIAL, 1.0 },
                                .repair = { 0.2, SCENE_TIME_EXPONENTIAL, 1.0 } };
        for (int side = 0; side < SCENE_SIDE_COUNT; side++)
            s.edges[side] = SCENE_EDGE_WALL;
        memory_free(s.initial.poses);
        s.initial = (scene_initial){ .type = SCENE_INITIAL_HEXAGONAL,
                                     .n_rows = 6,
                                     .n_columns = 10,
                                     .first = { 0.1, 0.03 },
                                     .spacing = 0.027 };
        s.duration = k < PLANAR ? 2.0 : 0.6;
        helper_scene_resolve(&s);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        const double start = log->values[0][0];
        assert_true(start > 50.0);
        assert_near(log->end.parts_end, start, 1e-12 * start);
        scene_fini(&s);
        helper_run_free(log);
    }
}

static double throughput(int solver, double rate, bool fails)
{
    static const double times[] = { 4.2, 5.0, 100.0 }, lasts[] = { 0.6, 0.4, 1.0 };
    const size_t first = fails ? 0 : 2; // the last one begins after the run
    helper_run_log *log = new_log(solver);
    scene s;
    set_list(make_line(&s, solver, 1), 3 - first, times + first, lasts + first);
    scene_stops *inlet = &s.belts[0].stops;
    inlet->failures = memory_alloc(1, sizeof *inlet->failures);
    assert_non_null(inlet->failures);
    inlet->n_failures = 1;
    set_list(inlet->failures, 3 - first, times + first, lasts + first);
    (void)helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, rate);
    s.duration = 9.0;
    s.warmup = 4.0;
    helper_scene_resolve(&s);
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    const double result = log->figures[FIGURE_THROUGHPUT];
    scene_fini(&s);
    helper_run_free(log);
    return result;
}

// Where no belt goes on to fill the other one, what is down for 1 s of 5 s lets 4/5 of its capacity through; of little
// cargo all, but for the part at either end of the 5 s: what waited has left 2.5 s after the last stop.
static void throughput_is_capacity_times_availability_or_what_is_offered(void **state)
{
    for (int k = 0; k < HELPER_AMOUNT(PLANAR, 1); k++) {
        const double capacity = throughput(k, 400.0, false), light = 8.0;
        const double error = solvers[k].model == RUN_MICRO ? 0.03 : 0.005;
        assert_near(throughput(k, 400.0, true), 0.8 * capacity, 0.8 * error * capacity);
        assert_near(throughput(k, light, true), 3600.0 * light, 3600.0 * 1.01 / 5.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(availability_and_failures_are_told),
        cmocka_unit_test(threads_and_a_stop_change_no_bit),
        cmocka_unit_test(both_models_have_the_same_failures_and_another_substream_has_others),
        cmocka_unit_test(nothing_is_lost_where_belts_fail),
        cmocka_unit_test(throughput_is_capacity_times_availability_or_what_is_offered),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
