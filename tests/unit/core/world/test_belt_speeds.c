// Unit tests of belts whose speed changes: ramps, jumps, and means over steps.

#include "core/world/belt_speeds.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/belt_range.h"
#include "tests/reference/schedule.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static belt_speeds speeds_of(const scene_belt *belt)
{
    belt_speeds speeds;

    assert_int_equal(belt_speeds_init(&speeds, 1, belt, NULL), BF_OK);
    return speeds;
}

static void assert_factors(const belt_speeds *speeds, size_t n, const double (*expected)[2])
{
    for (size_t k = 0; k < n; k++)
        assert_near(belt_speeds_at(speeds, 0, expected[k][0]), expected[k][1], 1e-15);
}

#define ASSERT_FACTORS(speeds, ...)                                                                \
    assert_factors(speeds, sizeof((const double[][2]){ __VA_ARGS__ }) / sizeof(double[2]),         \
                   (const double[][2]){ __VA_ARGS__ })

static void without_a_schedule_the_factor_is_1(void **state)
{
    const scene_belt belt = helper_scene_oblique_belt(INFINITY, INFINITY, 0, NULL, NULL);
    belt_speeds speeds = speeds_of(&belt);
    double factors[2];

    assert_true(speeds.are_constant);
    assert_true(belt_range_largest(&belt) == 1.0);
    ASSERT_FACTORS(&speeds, { 0.0, 1.0 }, { 1e9, 1.0 });
    belt_speeds_in_step(&speeds, 77, 0.1, factors);
    assert_true(factors[0] == 1.0 && factors[1] == 1.0);
    belt_speeds_fini(&speeds);
}

// 0.5 m/s: at 1 m/s2 the factor rises by 2 a second, at 2 m/s2 it falls by 4.
static void a_target_is_reached_by_a_ramp(void **state)
{
    double times[] = { 1.0, 2.0, 4.0 }, targets[] = { 0.5, 1.5, 0.0 };
    const scene_belt belt = helper_scene_oblique_belt(1.0, 2.0, 3, times, targets);
    belt_speeds speeds = speeds_of(&belt);

    ASSERT_FACTORS(&speeds, { 0.0, 1.0 }, { 1.0, 1.0 }, { 1.0625, 0.75 }, { 1.125, 0.5 },
                   { 1.9, 0.5 }, { 2.0, 0.5 }, { 2.25, 1.0 }, { 2.5, 1.5 }, { 4.0, 1.5 },
                   { 4.125, 1.0 }, { 4.375, 0.0 }, { 100.0, 0.0 });
    assert_true(belt_range_largest(&belt) == 1.5);
    belt_speeds_fini(&speeds);
}

static void without_accelerations_the_speed_jumps(void **state)
{
    double times[] = { 1.0, 2.0 }, targets[] = { 0.0, 2.0 };
    const scene_belt belt = helper_scene_oblique_belt(INFINITY, INFINITY, 2, times, targets);
    belt_speeds speeds = speeds_of(&belt);

    assert_true(belt_speeds_at(&speeds, 0, nextafter(1.0, 0.0)) == 1.0);
    assert_true(belt_speeds_at(&speeds, 0, 1.0) == 0.0);
    assert_true(belt_speeds_at(&speeds, 0, nextafter(2.0, 0.0)) == 0.0);
    assert_true(belt_speeds_at(&speeds, 0, 2.0) == 2.0);
    belt_speeds_fini(&speeds);
}

static void a_belt_without_velocity_needs_no_ramp(void **state)
{
    double times[] = { 1.0 }, targets[] = { 0.25 };
    scene_belt belt = helper_scene_oblique_belt(1.0, 1.0, 1, times, targets);

    belt.velocity = (vec2){ 0.0, 0.0 };
    belt_speeds speeds = speeds_of(&belt);
    ASSERT_FACTORS(&speeds, { 0.5, 1.0 }, { 1.0, 0.25 });
    belt_speeds_fini(&speeds);
}

// A belt that is scheduled from the start begins at the first factor, without a ramp from 1.
static void a_factor_at_0_holds_from_the_start(void **state)
{
    double times[] = { 0.0, 1.0 }, targets[] = { 0.0, 0.5 };
    const scene_belt belt = helper_scene_oblique_belt(1.0, 1.0, 2, times, targets);
    belt_speeds speeds = speeds_of(&belt);

    ASSERT_FACTORS(&speeds, { 0.0, 0.0 }, { 1.0, 0.0 }, { 1.125, 0.25 }, { 1.25, 0.5 });
    assert_true(belt_range_largest(&belt) == 0.5);
    belt_speeds_fini(&speeds);
}

// At 0.5 m/s2 a stop takes 1 s. It is called off after half of it, at the factor 0.5.
static void a_ramp_that_is_interrupted_goes_on_from_the_speed_it_has(void **state)
{
    double times[] = { 1.0, 1.5 }, targets[] = { 0.0, 1.0 };
    const scene_belt belt = helper_scene_oblique_belt(0.25, 0.5, 2, times, targets);
    belt_speeds speeds = speeds_of(&belt);

    ASSERT_FACTORS(&speeds, { 1.25, 0.75 }, { 1.5, 0.5 }, { 2.0, 0.75 }, { 2.5, 1.0 },
                   { 3.0, 1.0 });
    belt_speeds_fini(&speeds);
}

// From 1 at 1 s to 0 at 1.25 s.
static void the_mean_over_a_step_is_the_displacement_in_it(void **state)
{
    double times[] = { 1.0, 3.0 }, targets[] = { 0.0, 2.0 };
    const scene_belt belt = helper_scene_oblique_belt(INFINITY, 2.0, 2, times, targets);
    belt_speeds speeds = speeds_of(&belt);

    assert_near(belt_speeds_mean(&speeds, 0, 0.0, 2.0), 0.5 * (1.0 + 0.125), 1e-15);
    assert_near(belt_speeds_mean(&speeds, 0, 1.0, 1.25), 0.5, 1e-15);
    assert_near(belt_speeds_mean(&speeds, 0, 1.125, 1.25), 0.25, 1e-15);
    assert_near(belt_speeds_mean(&speeds, 0, 2.5, 3.5), 1.0, 1e-15);
    // The same bits as the factor itself where that is constant.
    assert_true(belt_speeds_mean(&speeds, 0, 0.1, 0.7) == 1.0);
    assert_true(belt_speeds_mean(&speeds, 0, 0.3, 1.0) == 1.0);
    assert_true(belt_speeds_mean(&speeds, 0, 1.25, 3.0) == 0.0);
    assert_true(belt_speeds_mean(&speeds, 0, 3.0, 3.001) == 2.0);
    belt_speeds_fini(&speeds);
}

// Schedules of 40 times with ramps of which about half are interrupted, and steps of any length.
static void random_schedules_agree_with_the_recursion_over_them(void **state)
{
    enum { TIMES = 40 };
    double times[TIMES], targets[TIMES];
    bf_random r;

    random_init(&r, 5);
    for (int round = 0; round < 50; round++) {
        double t = round % 2 == 0 ? 0.0 : random_unit(&r);
        for (int k = 0; k < TIMES; k++) {
            times[k] = t;
            targets[k] = k % 5 == 0 ? 0.0 : 2.0 * random_unit(&r);
            t += 0.05 + random_unit(&r);
        }
        const scene_belt belt = helper_scene_oblique_belt(
            0.1 + random_unit(&r), 0.1 + random_unit(&r), TIMES, times, targets);
        belt_speeds speeds = speeds_of(&belt);
        const double dt = 0.01 + random_unit(&r);
        for (unsigned long n = 0; (double)n * dt < t; n++) {
            double factors[2];
            belt_speeds_in_step(&speeds, n, dt, factors);
            assert_near(factors[0], schedule_mean(&belt, n, dt), 1e-11);
            assert_true(factors[0] >= 0.0 && factors[0] <= belt_range_largest(&belt) + 1e-15);
        }
        belt_speeds_fini(&speeds);
    }
}

static void off_every_belt_the_factor_is_1(void **state)
{
    double times[] = { 0.0 }, targets[] = { 0.5 };
    const scene_belt belts[] = { helper_scene_oblique_belt(1.0, 1.0, 1, times, targets),
                                 helper_scene_oblique_belt(1.0, 1.0, 0, NULL, NULL) };
    belt_speeds speeds;
    double factors[3];

    assert_int_equal(belt_speeds_init(&speeds, 2, belts, NULL), BF_OK);
    assert_false(speeds.are_constant);
    belt_speeds_in_step(&speeds, 0, 1.0, factors);
    assert_true(factors[0] == 0.5 && factors[1] == 1.0 && factors[2] == 1.0);
    belt_speeds_fini(&speeds);
}

static void without_memory_there_are_no_speeds(void **state)
{
    double times[] = { 1.0 }, targets[] = { 0.5 };
    const scene_belt belts[] = { helper_scene_oblique_belt(1.0, 1.0, 1, times, targets),
                                 helper_scene_oblique_belt(1.0, 1.0, 1, times, targets) };

    for (size_t n = 1; n <= 3; n++) {
        belt_speeds speeds;
        memory_plan_fault(n, 0);
        assert_int_equal(belt_speeds_init(&speeds, 2, belts, NULL), BF_ENOMEM);
        memory_plan_fault(0, 0);
        assert_int_equal(speeds.n_belts, 0);
        assert_null(speeds.curves);
    }
}

// A belt at 0.5 m/s that actions may command, with a jump to 0 at 10 s by its own schedule.
static scene_belt commanded_belt(void)
{
    static double times[] = { 10.0 }, factors[] = { 0.0 };
    scene_belt belt = helper_scene_oblique_belt(0.25, 0.5, 1, times, factors);

    belt.is_commanded = true;
    belt.command_factor = 1.5;
    return belt;
}

static void a_command_ramps_and_replaces_the_schedule(void **state)
{
    const scene_belt belt = commanded_belt();
    belt_speeds speeds = speeds_of(&belt);

    assert_false(speeds.are_constant);
    assert_true(belt_range_largest(&belt) == 1.5);
    // Down by 1/s to 0.5 at 2.5 s; the schedule would stop it at 10 s.
    belt_speeds_command(&speeds, 0, 2.0, 0.5);
    ASSERT_FACTORS(&speeds, { 2.0, 1.0 }, { 2.25, 0.75 }, { 2.5, 0.5 }, { 20.0, 0.5 });
    assert_near(belt_speeds_mean(&speeds, 0, 2.0, 3.0), 0.5 * 0.75 + 0.5 * 0.5, 1e-15);
    // Up by 0.5/s, from 0.5 at 30 s to 1.5 at 32 s; a command within that ramp begins at 1 at 31 s.
    belt_speeds_command(&speeds, 0, 30.0, 1.5);
    ASSERT_FACTORS(&speeds, { 30.0, 0.5 }, { 31.0, 1.0 }, { 32.0, 1.5 });
    belt_speeds_command(&speeds, 0, 31.0, 0.0);
    ASSERT_FACTORS(&speeds, { 31.0, 1.0 }, { 31.5, 0.5 }, { 32.0, 0.0 }, { 1e9, 0.0 });
    belt_speeds_fini(&speeds);
}

// Stops from 0 to 1 s, and from 3.5 s, 1/s after the second time, to 5 s; 0 is but touched at 6 s.
static void a_belt_stands_between_knots_without_speed(void **state)
{
    static double times[] = { 0.0, 1.0, 2.5, 5.0, 6.0, 7.0 };
    static double factors[] = { 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 };
    const scene_belt belt = helper_scene_oblique_belt(INFINITY, 0.5, 6, times, factors);
    const struct {
        double t, until;
        bool stands;
    } expected[] = { { 0.0, 1.0, true },  { 0.5, 1.0, true },      { 1.0, 2.5, false },
                     { 2.5, 3.5, false }, { 3.5, 5.0, true },      { 5.0, 6.0, false },
                     { 6.0, 7.0, false }, { 7.0, INFINITY, false } };
    belt_speeds speeds = speeds_of(&belt);

    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
        double until = NAN;
        assert_int_equal(belt_speeds_stands(&speeds, 0, expected[k].t, &until), expected[k].stands);
        assert_true(until == expected[k].until);
    }
    belt_speeds_fini(&speeds);
}

// At 0.5 m/s it brakes by 1/s from 2 s on, stands at 3 s, and speeds up by 0.5/s to -1 at 5 s. At 6 s it brakes for 0.5, to rest at
// 7 s, and is told at 7.5 s, with 0.25, to run backwards again; 0.25 s later it is at rest once more, and 0.5 s later at -0.25.
static void a_belt_reverses_over_rest(void **state)
{
    double times[] = { 2.0, 6.0, 7.5, 8.25 }, targets[] = { -1.0, 0.5, -1.0, -0.25 };
    scene_belt belt = helper_scene_oblique_belt(0.25, 0.5, 4, times, targets);
    belt_speeds speeds = speeds_of(&belt);

    ASSERT_FACTORS(&speeds, { 2.0, 1.0 }, { 2.5, 0.5 }, { 3.0, 0.0 }, { 4.0, -0.5 }, { 5.0, -1.0 },
                   { 6.5, -0.5 }, { 7.0, 0.0 }, { 7.5, 0.25 }, { 7.75, 0.0 }, { 8.0, -0.125 },
                   { 8.25, -0.25 }, { 1e9, -0.25 });
    // By the areas of the triangles between 2 and 5 s: 1/2 forward, 1 backwards.
    assert_near(belt_speeds_mean(&speeds, 0, 2.0, 5.0), -0.5 / 3.0, 1e-15);
    assert_true(belt_range_largest(&belt) == 1.0 && belt_range_may_reverse(&belt));
    belt_speeds_fini(&speeds);
    belt.acceleration = belt.deceleration = INFINITY;
    speeds = speeds_of(&belt);
    ASSERT_FACTORS(&speeds, { nextafter(2.0, 0.0), 1.0 }, { 2.0, -1.0 }, { 6.0, 0.5 },
                   { 7.5, -1.0 });
    belt_speeds_fini(&speeds);
}

// Back from 1 at 2 s: at rest at 3 s and at -1 at 5 s, from where a command at 4 s, at -0.5, brakes by 1/s and speeds up to 0.5.
static void a_command_reverses_over_rest(void **state)
{
    scene_belt belt = commanded_belt();
    belt_speeds speeds = speeds_of(&belt);

    belt_speeds_command(&speeds, 0, 2.0, -1.0);
    ASSERT_FACTORS(&speeds, { 2.5, 0.5 }, { 3.0, 0.0 }, { 5.0, -1.0 }, { 1e9, -1.0 });
    belt_speeds_command(&speeds, 0, 4.0, 0.5);
    ASSERT_FACTORS(&speeds, { 4.0, -0.5 }, { 4.5, 0.0 }, { 5.5, 0.5 }, { 1e9, 0.5 });
    belt_speeds_fini(&speeds);
}

static void saved_commands_come_back_with_the_same_bits(void **state)
{
    const scene_belt belts[] = { helper_scene_oblique_belt(INFINITY, INFINITY, 0, NULL, NULL),
                                 commanded_belt(), commanded_belt() };
    belt_speeds speeds, loaded;
    checkpoint_writer w;
    checkpoint_reader r;
    bf_buffer out = { 0 };

    assert_int_equal(belt_speeds_init(&speeds, 3, belts, NULL), BF_OK);
    assert_int_equal(belt_speeds_init(&loaded, 3, belts, NULL), BF_OK);
    belt_speeds_command(&speeds, 2, 0.1, -0.3);
    checkpoint_begin(&w, &out, CHECKPOINT_RUN, 1);
    belt_speeds_save(&speeds, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, out.bytes, out.n, CHECKPOINT_RUN, 1, NULL), BF_OK);
    assert_true(belt_speeds_load(&loaded, &r));
    assert_false(belt_speeds_load(&loaded, &r)); // nothing is left
    for (size_t belt = 0; belt < 3; belt++)
        for (int k = 0; k < 20; k++)
            assert_true(belt_speeds_at(&loaded, belt, 0.1 + 0.7 * k) ==
                        belt_speeds_at(&speeds, belt, 0.1 + 0.7 * k));
    belt_speeds_fini(&speeds);
    belt_speeds_fini(&loaded);
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_schedule_the_factor_is_1),
        cmocka_unit_test(a_target_is_reached_by_a_ramp),
        cmocka_unit_test(without_accelerations_the_speed_jumps),
        cmocka_unit_test(a_belt_without_velocity_needs_no_ramp),
        cmocka_unit_test(a_factor_at_0_holds_from_the_start),
        cmocka_unit_test(a_ramp_that_is_interrupted_goes_on_from_the_speed_it_has),
        cmocka_unit_test(the_mean_over_a_step_is_the_displacement_in_it),
        cmocka_unit_test(random_schedules_agree_with_the_recursion_over_them),
        cmocka_unit_test(off_every_belt_the_factor_is_1),
        cmocka_unit_test(without_memory_there_are_no_speeds),
        cmocka_unit_test(a_command_ramps_and_replaces_the_schedule),
        cmocka_unit_test(a_belt_stands_between_knots_without_speed),
        cmocka_unit_test(a_belt_reverses_over_rest),
        cmocka_unit_test(a_command_reverses_over_rest),
        cmocka_unit_test(saved_commands_come_back_with_the_same_bits),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
