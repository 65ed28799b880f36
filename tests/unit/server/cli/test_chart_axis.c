// Unit tests of the axes of charts.

#include "server/cli/chart_axis.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

// 192 parts over at most about 5 ticks: 192/5 = 38.4, the next of 1, 2, 5 times a power is 50.
static void steps_are_one_two_or_five_times_a_power_of_ten(void **state)
{
    chart_axis a = chart_axis_make(0.0, 192.0, 5, CHART_AXIS_ON_TICKS);
    assert_true(a.step == 50.0);
    assert_true(a.low == 0.0 && a.high == 200.0);
    assert_int_equal(a.n, 5); // 0, 50, 100, 150, 200
    assert_true(chart_axis_tick(&a, 4) == 200.0);
}

static void an_axis_as_given_keeps_its_ends_and_has_ticks_inside(void **state)
{
    chart_axis a = chart_axis_make(0.7, 3.2, 3, CHART_AXIS_AS_GIVEN);
    assert_true(a.low == 0.7 && a.high == 3.2);
    assert_true(a.step == 1.0); // 2.5 / 3 = 0.83
    assert_int_equal(a.n, 3);   // 1, 2, 3
    assert_true(chart_axis_tick(&a, 0) == 1.0);
}

// 0.3 / 0.1 is 2.9999999999999996 in doubles.
static void rounding_does_not_cost_the_last_tick(void **state)
{
    char label[CHART_AXIS_LABEL_SIZE];
    chart_axis a = chart_axis_make(0.0, 0.3, 3, CHART_AXIS_AS_GIVEN);
    assert_int_equal(a.n, 4);
    assert_int_equal(chart_axis_label(&a, 3, label), 3);
    assert_string_equal(label, "0.3");
}

static void zero_is_labelled_without_a_sign(void **state)
{
    char label[CHART_AXIS_LABEL_SIZE];
    chart_axis a = chart_axis_make(-1.0, 1.0, 4, CHART_AXIS_ON_TICKS);
    for (int i = 0; i < a.n; i++) {
        chart_axis_label(&a, i, label);
        assert_string_not_equal(label, "-0");
    }
}

static void an_empty_range_is_widened(void **state)
{
    static const double values[] = { 0.0, 5.0, -1e-300, 1e300, 1e15 };
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        chart_axis a = chart_axis_make(values[i], values[i], 5, CHART_AXIS_AS_GIVEN);
        assert_true(a.low < values[i] && values[i] < a.high);
        assert_true(a.n >= 1 && a.n <= CHART_AXIS_TICKS_MAX);
        assert_int_equal(chart_axis_place(&a, values[i], 101), 50);
    }
}

static void places_run_from_the_low_to_the_high_end(void **state)
{
    chart_axis a = chart_axis_make(0.0, 10.0, 5, CHART_AXIS_AS_GIVEN);
    assert_int_equal(chart_axis_place(&a, 0.0, 11), 0);
    assert_int_equal(chart_axis_place(&a, 4.4, 11), 4);
    assert_int_equal(chart_axis_place(&a, 10.0, 11), 10);
    assert_int_equal(chart_axis_place(&a, 1e9, 11), 10); // beyond the end stays on the axis
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_are_one_two_or_five_times_a_power_of_ten),
        cmocka_unit_test(an_axis_as_given_keeps_its_ends_and_has_ticks_inside),
        cmocka_unit_test(rounding_does_not_cost_the_last_tick),
        cmocka_unit_test(zero_is_labelled_without_a_sign),
        cmocka_unit_test(an_empty_range_is_widened),
        cmocka_unit_test(places_run_from_the_low_to_the_high_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
