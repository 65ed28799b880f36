// Unit tests of what belts may do: whether they reverse, and speed schedules, failures and breaks at fault.

#include "core/scene/belt_range.h"

#include "core/scene/ranges.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static const bf_faults *faults_of(const scene_belt *belt)
{
    static bf_faults faults;

    faults = (bf_faults){ .n = 0 };
    belt_range_check(belt, "/b", &faults);
    return &faults;
}

static void assert_fault(const scene_belt *belt, bf_status code, const char *pointer)
{
    const bf_faults *faults = faults_of(belt);

    assert_int_equal(faults->n, 1);
    assert_int_equal(faults->items[0].code, code);
    assert_string_equal(faults->items[0].pointer, pointer);
}

static void accelerations_are_positive(void **state)
{
    const double bad[] = { 0.0, -1.0, NAN, -INFINITY, 1e300 };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        scene_belt belt = helper_scene_oblique_belt(bad[k], INFINITY, 0, NULL, NULL);
        assert_fault(&belt, BF_EINPUT, "/b/acceleration_m_s2");
        belt = helper_scene_oblique_belt(INFINITY, bad[k], 0, NULL, NULL);
        assert_fault(&belt, BF_EINPUT, "/b/deceleration_m_s2");
    }
}

static void times_rise_and_factors_are_finite(void **state)
{
    static const struct {
        double times[3], factors[3];
        const char *pointer; // NULL: no fault
    } schedules[] = {
        { { 0.0, 1.0, 2.0 }, { 0.0, 1.0, 2.0 }, NULL },
        { { -1.0, 1.0, 2.0 }, { 1.0, 1.0, 1.0 }, "/b/speed_schedule/t_s/0" },
        { { 0.0, 2.0, 1.0 }, { 1.0, 1.0, 1.0 }, "/b/speed_schedule/t_s/2" },
        { { 0.0, 1.0, 1.0 }, { 1.0, 1.0, 1.0 }, "/b/speed_schedule/t_s/2" },
        { { 0.0, NAN, 1.0 }, { 1.0, 1.0, 1.0 }, "/b/speed_schedule/t_s/1" },
        { { 0.0, 1.0, INFINITY }, { 1.0, 1.0, 1.0 }, "/b/speed_schedule/t_s/2" },
        { { 0.0, 1.0, 2.0 }, { 1.0, -0.1, 1.0 }, NULL },
        { { 0.0, 1.0, 2.0 }, { 1.0, -INFINITY, 1.0 }, "/b/speed_schedule/factor/1" },
        { { 0.0, 1.0, 2.0 }, { 1.0, NAN, 1.0 }, "/b/speed_schedule/factor/1" },
        { { 0.0, 1.0, 2.0 }, { 1.0, 1.0, INFINITY }, "/b/speed_schedule/factor/2" },
        // 0.5 m/s times 2001 are more than 1000 m/s.
        { { 0.0, 1.0, 2.0 }, { 2001.0, 1.0, 1.0 }, "/b/speed_schedule/factor/0" },
        { { 0.0, 1.0, 2.0 }, { -2001.0, 1.0, 1.0 }, "/b/speed_schedule/factor/0" },
        { { 0.0, 1.0, 2.0 }, { 2000.0, 1.0, 1.0 }, NULL },
    };

    for (size_t k = 0; k < sizeof schedules / sizeof *schedules; k++) {
        double times[3], factors[3];
        memcpy(times, schedules[k].times, sizeof times);
        memcpy(factors, schedules[k].factors, sizeof factors);
        const scene_belt belt = helper_scene_oblique_belt(1.0, 1.0, 3, times, factors);
        if (schedules[k].pointer != NULL)
            assert_fault(&belt, BF_EINPUT, schedules[k].pointer);
        else
            assert_int_equal(faults_of(&belt)->n, 0);
    }
}

static void there_is_a_factor_for_each_time_and_not_too_many(void **state)
{
    static double times[SCENE_SPEEDS_MAX + 1], factors[SCENE_SPEEDS_MAX + 1];
    scene_belt belt = helper_scene_oblique_belt(1.0, 1.0, 3, times, factors);

    for (int k = 0; k <= SCENE_SPEEDS_MAX; k++)
        times[k] = k;
    belt.speed_schedule.n_factors = 2;
    assert_fault(&belt, BF_EINPUT, "/b/speed_schedule");
    belt = helper_scene_oblique_belt(1.0, 1.0, SCENE_SPEEDS_MAX, times, factors);
    assert_int_equal(faults_of(&belt)->n, 0);
    belt = helper_scene_oblique_belt(1.0, 1.0, SCENE_SPEEDS_MAX + 1, times, factors);
    assert_fault(&belt, BF_ELIMIT, "/b/speed_schedule");
}

static void a_belt_may_reverse_by_its_schedule_or_by_a_command(void **state)
{
    double times[] = { 1.0, 2.0 }, targets[] = { 0.0, 2.0 };
    scene_belt belt = helper_scene_oblique_belt(1.0, 1.0, 2, times, targets);

    assert_false(belt_range_may_reverse(&belt));
    belt.is_commanded = belt.command_reverses = true;
    assert_true(belt_range_may_reverse(&belt));
    assert_true(belt_range_may_reverse_any(1, &belt));
    belt.is_commanded = belt.command_reverses = false;
    targets[1] = -0.001;
    assert_true(belt_range_may_reverse(&belt));
}

static void assert_stops_fault(const scene_stops *stops, bf_status code, const char *pointer)
{
    scene_belt belt = helper_scene_oblique_belt(INFINITY, INFINITY, 0, NULL, NULL);

    belt.stops = *stops;
    if (pointer != NULL)
        assert_fault(&belt, code, pointer);
    else
        assert_int_equal(faults_of(&belt)->n, 0);
}

static void times_and_shapes_are_in_range(void **state)
{
    const scene_drawn_time good = { 10.0, SCENE_TIME_EXPONENTIAL, 1.0 };
    const struct {
        scene_drawn_time between, repair;
        const char *pointer;
    } cases[] = {
        { good, good, NULL },
        { helper_scene_fixed_time(-1.0), good, "/b/failures/0/mtbf_s" },
        { helper_scene_fixed_time(0.0), good, "/b/failures/0/mtbf_s" },
        { good, helper_scene_fixed_time(0.0), "/b/failures/0/mttr_s" },
        { good, helper_scene_fixed_time(NAN), "/b/failures/0/mttr_s" },
        { { 9.0, SCENE_TIME_WEIBULL, 0.19 }, good, "/b/failures/0/mtbf_shape" },
        { { 9.0, SCENE_TIME_WEIBULL, 0.2 }, { 9.0, SCENE_TIME_WEIBULL, 100.0 }, NULL },
        { good, { 9.0, SCENE_TIME_WEIBULL, 101.0 }, "/b/failures/0/mttr_shape" },
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene_failure f = helper_scene_failure("f", cases[k].between, cases[k].repair);
        assert_stops_fault(&(scene_stops){ .n_failures = 1, .failures = &f, .until = 10.0 },
                           BF_EINPUT, cases[k].pointer);
    }
}

static void lists_rise_and_do_not_overlap(void **state)
{
    double t[] = { 1.0, 4.0, 6.0 }, lasts[] = { 2.0, 1.0, 1.0 };
    scene_failure f = { .id = "f",
                        .type = SCENE_FAILURE_LISTED,
                        .n_times = 3,
                        .times = t,
                        .n_durations = 3,
                        .durations = lasts };
    const scene_stops stops = { .n_failures = 1, .failures = &f, .until = 10.0 };
    assert_stops_fault(&stops, BF_EINPUT, NULL);
    lasts[1] = 2.0; // until the next one begins
    assert_stops_fault(&stops, BF_EINPUT, "/b/failures/0/t_s/2");
    lasts[1] = 0.0;
    assert_stops_fault(&stops, BF_EINPUT, "/b/failures/0/duration_s/1");
    lasts[1] = 1.0;
    t[0] = -1.0;
    assert_stops_fault(&stops, BF_EINPUT, "/b/failures/0/t_s/0");
    t[0] = 1.0;
    f.n_durations = 2;
    assert_stops_fault(&stops, BF_EINPUT, "/b/failures/0");
}

static void breaks_end_before_the_next_one_begins(void **state)
{
    scene_break b = { .start = 5.0, .duration = 900.0, .every = 14400.0 };
    const scene_stops stops = { .n_breaks = 1, .breaks = &b, .until = 10.0 };
    assert_stops_fault(&stops, BF_EINPUT, NULL);
    b.every = 900.0;
    assert_stops_fault(&stops, BF_EINPUT, "/b/breaks/0/every_s");
    b = (scene_break){ .start = -1.0, .duration = 1.0, .every = INFINITY };
    assert_stops_fault(&stops, BF_EINPUT, "/b/breaks/0/start_s");
    b = (scene_break){ .start = 1.0, .duration = 0.0, .every = INFINITY };
    assert_stops_fault(&stops, BF_EINPUT, "/b/breaks/0/duration_s");
}

static void there_are_not_too_many_stops(void **state)
{
    static scene_failure many[SCENE_FAILURES_MAX + 1];
    static scene_break breaks[SCENE_BREAKS_MAX + 1];
    scene_failure f =
        helper_scene_failure("f", helper_scene_fixed_time(0.9), helper_scene_fixed_time(0.1));
    scene_stops stops = { .n_failures = 1, .failures = &f, .until = 1.0 * SCENE_STOPS_MAX };
    assert_stops_fault(&stops, BF_ELIMIT, NULL);
    stops.until += 1.0;
    assert_stops_fault(&stops, BF_ELIMIT, "/b/failures");
    assert_stops_fault(&(scene_stops){ .n_failures = SCENE_FAILURES_MAX + 1, .failures = many },
                       BF_ELIMIT, "/b/failures");
    assert_stops_fault(&(scene_stops){ .n_breaks = SCENE_BREAKS_MAX + 1, .breaks = breaks },
                       BF_ELIMIT, "/b/breaks");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accelerations_are_positive),
        cmocka_unit_test(times_rise_and_factors_are_finite),
        cmocka_unit_test(there_is_a_factor_for_each_time_and_not_too_many),
        cmocka_unit_test(a_belt_may_reverse_by_its_schedule_or_by_a_command),
        cmocka_unit_test(times_and_shapes_are_in_range),
        cmocka_unit_test(lists_rise_and_do_not_overlap),
        cmocka_unit_test(breaks_end_before_the_next_one_begins),
        cmocka_unit_test(there_are_not_too_many_stops),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
