// Unit tests of what stops belts: failures at given and at drawn times, breaks and operating time.

#include "core/world/belt_stops.h"

#include "core/base/memory.h"
#include "core/world/belt_speeds.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

// A belt of 0.5 m/s that stops at once.
static scene_belt belt_with(scene_stops stops)
{
    return (scene_belt){
        .velocity = { 0.3, 0.4 }, .acceleration = INFINITY, .deceleration = INFINITY, .stops = stops
    };
}

static belt_speeds speeds_of(const scene_belt *belt)
{
    belt_speeds speeds;

    assert_int_equal(belt_speeds_init(&speeds, 1, belt, NULL), BF_OK);
    return speeds;
}

// What stops the belt changes at these times and to these.
static void assert_stops(const belt_speeds *speeds, size_t n, const belt_speeds_stop *expected)
{
    double until = 0.0;

    for (size_t k = 0; k < n; k++) {
        assert_near(until, expected[k].t, 1e-12);
        assert_int_equal(belt_speeds_stopped_by(speeds, 0, until, &until), expected[k].now);
    }
}

#define ASSERT_STOPS(speeds, ...)                                                                  \
    assert_stops(speeds,                                                                           \
                 sizeof((const belt_speeds_stop[]){ __VA_ARGS__ }) / sizeof(belt_speeds_stop),     \
                 (const belt_speeds_stop[]){ __VA_ARGS__ })

static void listed_failures_stop_a_belt_with_its_ramps(void **state)
{
    double times[] = { 2.0, 10.0 }, durations[] = { 3.0, 1.0 };
    scene_failure listed = { .type = SCENE_FAILURE_LISTED,
                             .n_times = 2,
                             .times = times,
                             .n_durations = 2,
                             .durations = durations };
    scene_belt belt =
        belt_with((scene_stops){ .n_failures = 1, .failures = &listed, .until = 20.0 });
    belt.deceleration = 0.5;
    belt.acceleration = 0.25;
    belt_speeds speeds = speeds_of(&belt);
    ASSERT_STOPS(&speeds, { 0.0, 0 }, { 2.0, 1 }, { 5.0, 0 }, { 10.0, 1 }, { 11.0, 0 });
    const double expected[][2] = { { 2.0, 1.0 }, { 2.5, 0.5 }, { 3.0, 0.0 },  { 5.0, 0.0 },
                                   { 6.0, 0.5 }, { 7.0, 1.0 }, { 11.0, 0.0 }, { 14.0, 1.0 } };
    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
        assert_near(belt_speeds_at(&speeds, 0, expected[k][0]), expected[k][1], 1e-12);
    belt_speeds_fini(&speeds);
}

static void a_belt_that_stands_by_its_schedule_does_not_fail(void **state)
{
    scene_failure f =
        helper_scene_failure("f", helper_scene_fixed_time(10.0), helper_scene_fixed_time(2.0));
    double times[] = { 4.0, 7.0, 27.0 }, factors[] = { 0.0, 0.5, 0.0 };
    scene_belt belt = belt_with((scene_stops){ .n_failures = 1, .failures = &f, .until = 100.0 });
    belt.speed_schedule = (scene_speed_schedule){ 3, times, 3, factors };
    belt_speeds speeds = speeds_of(&belt);
    ASSERT_STOPS(&speeds, { 0.0, 0 }, { 13.0, 1 }, { 15.0, 0 }, { 25.0, 1 }, { 27.0, 0 });
    assert_true(belt_speeds_at(&speeds, 0, 14.0) == 0.0 && belt_speeds_at(&speeds, 0, 16.0) == 0.5);
    assert_true(belt_speeds_at(&speeds, 0, 99.0) == 0.0);
    belt_speeds_fini(&speeds);
}

static void a_belt_that_runs_backwards_fails_and_comes_to_rest(void **state)
{
    scene_failure f =
        helper_scene_failure("f", helper_scene_fixed_time(10.0), helper_scene_fixed_time(2.0));
    double times[] = { 4.0 }, factors[] = { -1.0 };
    scene_belt belt = belt_with((scene_stops){ .n_failures = 1, .failures = &f, .until = 20.0 });
    belt.speed_schedule = (scene_speed_schedule){ 1, times, 1, factors };
    belt.acceleration = belt.deceleration = 0.5;
    belt_speeds speeds = speeds_of(&belt);
    ASSERT_STOPS(&speeds, { 0.0, 0 }, { 10.0, 1 }, { 12.0, 0 });
    const double expected[][2] = { { 9.0, -1.0 }, { 10.0, -1.0 }, { 10.5, -0.5 }, { 11.0, 0.0 },
                                   { 12.0, 0.0 }, { 12.5, -0.5 }, { 13.0, -1.0 }, { 14.0, -1.0 } };
    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
        assert_near(belt_speeds_at(&speeds, 0, expected[k][0]), expected[k][1], 1e-12);
    belt_speeds_fini(&speeds);
}

// Failures of "often" at 3, 3 + 1 + 3 = 7 ... of operating time 3 each; "rare" is due after 10 of it.
static void while_one_failure_lasts_the_others_wait(void **state)
{
    scene_failure failures[] = {
        helper_scene_failure("often", helper_scene_fixed_time(3.0), helper_scene_fixed_time(1.0)),
        helper_scene_failure("rare", helper_scene_fixed_time(10.0), helper_scene_fixed_time(5.0))
    };
    const scene_belt belt =
        belt_with((scene_stops){ .n_failures = 2, .failures = failures, .until = 25.0 });
    belt_speeds speeds = speeds_of(&belt);
    ASSERT_STOPS(&speeds, { 0.0, 0 }, { 3.0, 1 }, { 4.0, 0 }, { 7.0, 1 }, { 8.0, 0 }, { 11.0, 1 },
                 { 12.0, 0 }, { 13.0, 2 }, { 18.0, 0 }, { 20.0, 1 }, { 21.0, 0 });
    belt_speeds_fini(&speeds);
}

static void failures_that_are_due_at_once_come_one_after_the_other(void **state)
{
    scene_failure failures[] = {
        helper_scene_failure("a", helper_scene_fixed_time(4.0), helper_scene_fixed_time(1.0)),
        helper_scene_failure("b", helper_scene_fixed_time(4.0), helper_scene_fixed_time(2.0))
    };
    const scene_belt belt =
        belt_with((scene_stops){ .n_failures = 2, .failures = failures, .until = 12.0 });
    belt_speeds speeds = speeds_of(&belt);
    ASSERT_STOPS(&speeds, { 0.0, 0 }, { 4.0, 1 }, { 5.0, 2 }, { 7.0, 0 }, { 11.0, 1 });
    belt_speeds_fini(&speeds);
}

// In a break no operating time passes, and a repair goes on.
static void breaks_repeat_and_repairs_go_on_in_them(void **state)
{
    scene_failure f =
        helper_scene_failure("f", helper_scene_fixed_time(8.5), helper_scene_fixed_time(3.0));
    scene_break breaks[] = { { .start = 10.0, .duration = 5.0, .every = 20.0 },
                             { .start = 0.0, .duration = 1.0, .every = INFINITY } };
    const scene_belt belt = belt_with((scene_stops){
        .n_failures = 1, .failures = &f, .n_breaks = 2, .breaks = breaks, .until = 60.0 });
    enum { BREAK = BELT_STOPS_BREAK };
    belt_speeds speeds = speeds_of(&belt);
    assert_true(belt_speeds_at(&speeds, 0, 0.0) == 0.0 && belt_speeds_at(&speeds, 0, 1.0) == 1.0);
    ASSERT_STOPS(&speeds, { 0.0, BREAK }, { 1.0, 0 }, { 9.5, 1 }, { 10.0, BREAK | 1 },
                 { 12.5, BREAK }, { 15.0, 0 }, { 23.5, 1 }, { 26.5, 0 }, { 30.0, BREAK },
                 { 35.0, 0 }, { 40.0, 1 }, { 43.0, 0 }, { 50.0, BREAK }, { 55.0, 0 }, { 56.5, 1 });
    belt_speeds_fini(&speeds);
}

static void after_the_only_break_nothing_stops_a_belt(void **state)
{
    scene_break once = { .start = 10.0, .duration = 5.0, .every = INFINITY };
    const scene_belt belt =
        belt_with((scene_stops){ .n_breaks = 1, .breaks = &once, .until = 60.0 });
    belt_speeds speeds = speeds_of(&belt);
    ASSERT_STOPS(&speeds, { 0.0, 0 }, { 10.0, BELT_STOPS_BREAK }, { 15.0, 0 });
    assert_true(belt_speeds_at(&speeds, 0, 1e6) == 1.0);
    belt_speeds_fini(&speeds);
}

// Of the times between failures and of repairs of a belt that always runs.
typedef struct times {
    size_t n;
    double *up, *down;
} times;

static times find_times(const scene_failure *f, uint64_t substream, double until)
{
    scene_failure copy = *f;
    const scene_belt belt = belt_with((scene_stops){
        .n_failures = 1, .failures = &copy, .substream = substream, .until = until });
    belt_speeds speeds = speeds_of(&belt);
    const size_t room = speeds.curves[0].n_stops;
    times all = { .up = calloc(room, sizeof(double)), .down = calloc(room, sizeof(double)) };
    double at = 0.0;

    assert_true(all.up != NULL && all.down != NULL);
    for (;; all.n++) {
        double fails, repaired;
        assert_int_equal(belt_speeds_stopped_by(&speeds, 0, at, &fails), 0);
        if (fails >= until)
            break;
        assert_int_equal(belt_speeds_stopped_by(&speeds, 0, fails, &repaired), 1);
        if (repaired >= until)
            break;
        all.up[all.n] = fails - at;
        all.down[all.n] = repaired - fails;
        at = repaired;
    }
    belt_speeds_fini(&speeds);
    return all;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

// Of times by a Weibull distribution: the mean within four times its standard error, and by Kolmogorov and Smirnov below
// what one of a thousand samples exceeds.
static void assert_weibull(double *of, size_t n, double mean, double shape)
{
    const double gamma1 = tgamma(1.0 + 1.0 / shape), gamma2 = tgamma(1.0 + 2.0 / shape);
    const double deviation = mean * sqrt(gamma2 / (gamma1 * gamma1) - 1.0);
    double sum = 0.0, distance = 0.0;

    qsort(of, n, sizeof *of, compare_doubles);
    for (size_t k = 0; k < n; k++) {
        const double p = 1.0 - exp(-pow(of[k] * gamma1 / mean, shape));
        sum += of[k];
        distance = fmax(distance, fmax(p - (double)k / (double)n, (double)(k + 1) / (double)n - p));
    }
    assert_near(sum / (double)n, mean, 4.0 * deviation / sqrt((double)n));
    assert_true(distance * sqrt((double)n) < 1.95);
}

static void drawn_times_have_their_distributions(void **state)
{
    const struct {
        double shape_up, shape_down;
    } cases[] = { { 1.0, 2.5 }, { 0.7, 1.0 }, { 3.0, 0.5 } };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const scene_failure f = helper_scene_failure(
            "f", (scene_drawn_time){ 40.0, SCENE_TIME_WEIBULL, cases[k].shape_up },
            (scene_drawn_time){ 10.0, SCENE_TIME_WEIBULL, cases[k].shape_down });
        times all = find_times(&f, 7, 250000.0);
        assert_true(all.n > 4500 && all.n < 5500);
        assert_weibull(all.up, all.n, 40.0, cases[k].shape_up);
        assert_weibull(all.down, all.n, 10.0, cases[k].shape_down);
        free(all.up);
        free(all.down);
    }
}

static void draws_follow_the_id_and_the_substream_alone(void **state)
{
    const scene_drawn_time up = { 40.0, SCENE_TIME_EXPONENTIAL, 1.0 },
                           down = { 10.0, SCENE_TIME_EXPONENTIAL, 1.0 };
    const scene_failure f = helper_scene_failure("f", up, down),
                        g = helper_scene_failure("g", up, down);
    times of[] = { find_times(&f, 0, 1000.0), find_times(&f, 0, 1000.0), find_times(&f, 1, 1000.0),
                   find_times(&g, 0, 1000.0) };
    assert_int_equal(of[0].n, of[1].n);
    assert_memory_equal(of[0].up, of[1].up, of[0].n * sizeof *of[0].up);
    assert_memory_equal(of[0].down, of[1].down, of[0].n * sizeof *of[0].down);
    assert_true(of[0].up[0] != of[2].up[0] && of[0].up[0] != of[3].up[0]);
    assert_true(of[0].up[0] != of[0].down[0]);
    for (size_t k = 0; k < 4; k++) {
        free(of[k].up);
        free(of[k].down);
    }
}

static scene_belt commanded_belt(scene_failure *f)
{
    scene_belt belt = belt_with((scene_stops){ .n_failures = 1, .failures = f, .until = 500.0 });

    belt.is_commanded = true;
    belt.command_factor = 1.0;
    belt.deceleration = 0.4;
    return belt;
}

// Failures are due after 10 s of operating time: what was left of it at a command is left after it.
static void commands_stop_the_clock_and_failures_override_them(void **state)
{
    scene_failure f =
        helper_scene_failure("f", helper_scene_fixed_time(10.0), helper_scene_fixed_time(3.0));
    const scene_belt belt = commanded_belt(&f);
    belt_speeds speeds = speeds_of(&belt);
    belt_speeds_command(&speeds, 0, 4.0, 0.0);
    belt_speeds_command(&speeds, 0, 9.0, 0.5);
    double until = 0.0;
    assert_int_equal(belt_speeds_stopped_by(&speeds, 0, 9.0, &until), 0);
    assert_near(until, 15.0, 1e-12);
    assert_int_equal(belt_speeds_stopped_by(&speeds, 0, 15.0, &until), 1);
    assert_near(until, 18.0, 1e-12);
    belt_speeds_command(&speeds, 0, 16.5, 1.0); // heard at the end of the repair
    assert_int_equal(belt_speeds_stopped_by(&speeds, 0, 16.5, &until), 1);
    assert_near(until, 18.0, 1e-12);
    assert_true(belt_speeds_at(&speeds, 0, 17.9) == 0.0 && belt_speeds_at(&speeds, 0, 18.1) == 1.0);
    belt_speeds_fini(&speeds);
}

static void a_belt_that_was_commanded_fails_as_before_after_a_checkpoint(void **state)
{
    scene_failure f =
        helper_scene_failure("f", (scene_drawn_time){ 8.0, SCENE_TIME_EXPONENTIAL, 1.0 },
                             (scene_drawn_time){ 3.0, SCENE_TIME_WEIBULL, 2.0 });
    const scene_belt belt = commanded_belt(&f);
    belt_speeds speeds = speeds_of(&belt);
    for (int n = 0; n < 12; n++) {
        belt_speeds loaded = speeds_of(&belt);
        checkpoint_writer w;
        checkpoint_reader r;
        bf_buffer out = { 0 };
        checkpoint_begin(&w, &out, CHECKPOINT_RUN, 1);
        belt_speeds_save(&speeds, &w);
        assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
        assert_int_equal(checkpoint_open(&r, out.bytes, out.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
        assert_true(belt_speeds_load(&loaded, &r));
        const double t = 7.3 * (n + 1);
        belt_speeds_command(&loaded, 0, t, 0.25 * (n % 3));
        belt_speeds_command(&speeds, 0, t, 0.25 * (n % 3));
        for (double at = t; at < 500.0; at += 0.37)
            assert_true(belt_speeds_at(&loaded, 0, at) == belt_speeds_at(&speeds, 0, at));
        belt_speeds_fini(&loaded);
        buffer_fini(&out);
    }
    belt_speeds_fini(&speeds);
}

static void without_memory_there_are_no_stops(void **state)
{
    scene_failure f =
        helper_scene_failure("f", helper_scene_fixed_time(10.0), helper_scene_fixed_time(3.0));
    const scene_belt belt =
        belt_with((scene_stops){ .n_failures = 1, .failures = &f, .until = 50.0 });
    for (size_t n = 1; n <= 3; n++) {
        belt_speeds speeds;
        memory_plan_fault(n, 0);
        assert_int_equal(belt_speeds_init(&speeds, 1, &belt, NULL), BF_ENOMEM);
        memory_plan_fault(0, 0);
        assert_null(speeds.curves);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(listed_failures_stop_a_belt_with_its_ramps),
        cmocka_unit_test(a_belt_that_stands_by_its_schedule_does_not_fail),
        cmocka_unit_test(a_belt_that_runs_backwards_fails_and_comes_to_rest),
        cmocka_unit_test(while_one_failure_lasts_the_others_wait),
        cmocka_unit_test(failures_that_are_due_at_once_come_one_after_the_other),
        cmocka_unit_test(breaks_repeat_and_repairs_go_on_in_them),
        cmocka_unit_test(after_the_only_break_nothing_stops_a_belt),
        cmocka_unit_test(drawn_times_have_their_distributions),
        cmocka_unit_test(draws_follow_the_id_and_the_substream_alone),
        cmocka_unit_test(commands_stop_the_clock_and_failures_override_them),
        cmocka_unit_test(a_belt_that_was_commanded_fails_as_before_after_a_checkpoint),
        cmocka_unit_test(without_memory_there_are_no_stops),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
