// Unit tests of the columns of curves, and of when samples are due.

#include "core/observe/columns.h"
#include "core/run/schedule.h"
#include "tests/unit/helper_cmocka.h"

static scene_counter counters[] = { { .id = "up" }, { .id = "b.blocked" } };
static scene_feed feeds[] = { { .id = "west" }, { .id = "north" } };
static scene_belt belts[] = { { .id = "still" },
                              { .id = "infeed", .is_commanded = true },
                              { .id = "ramp", .speed_schedule = { .n_times = 1 } } };
static scene_photo_eye eyes[] = { { .id = "a" }, { .id = "b" } };

static void columns_stand_in_the_order_of_the_table(void **state)
{
    const scene s = { .n_counters = 1,
                      .counters = counters,
                      .n_feeds = 2,
                      .feeds = feeds,
                      .n_eyes = 2,
                      .eyes = eyes,
                      .n_belts = 3,
                      .belts = belts };
    static const char *const expected[] = {
        "up",
        "left_domain",
        "west.offered",
        "west.admitted",
        "west.waiting",
        "west.discarded",
        "north.offered",
        "north.admitted",
        "north.waiting",
        "north.discarded",
        "a.blocked",
        "b.blocked",
        "infeed.speed_m_s",
        "ramp.speed_m_s",
    };
    char name[COLUMN_NAME_SIZE];

    assert_int_equal(columns_count(&s), sizeof expected / sizeof *expected);
    for (size_t k = 0; k < columns_count(&s); k++) {
        columns_name(&s, k, name);
        assert_string_equal(name, expected[k]);
    }
}

static void a_scene_without_feeds_has_counters_and_left_domain(void **state)
{
    const scene s = { .n_counters = 2, .counters = counters };

    assert_int_equal(columns_count(&s), 3);
}

static void what_fell_has_a_column_where_parts_may_fall(void **state)
{
    static scene_counter fallen = { .id = "fallen" };
    const scene s = {
        .n_counters = 1, .counters = counters, .n_feeds = 1, .feeds = feeds, .may_drop = true
    };
    const scene taken = { .n_counters = 1, .counters = &fallen, .may_drop = true };
    const scene free_name = { .n_counters = 1, .counters = &fallen };
    char name[COLUMN_NAME_SIZE];
    bf_faults faults = { 0 };

    assert_int_equal(columns_count(&s), 7);
    columns_name(&s, 2, name);
    assert_string_equal(name, "fallen");
    columns_name(&s, 3, name);
    assert_string_equal(name, "west.offered");
    columns_check(&free_name, &faults);
    assert_int_equal(faults.n, 0);
    columns_check(&taken, &faults);
    assert_int_equal(faults.n, 1);
    assert_string_equal(faults.items[0].pointer, "/counters/0/id");
}

static void counts_since_the_start_are_told_from_what_rises_and_falls(void **state)
{
    static const char *const counts[] = { "left_domain",   "fallen",         "west.offered",
                                          "west.admitted", "west.discarded", "infeed.left" };
    static const char *const others[] = {
        "up", "west.waiting", "a.blocked", "ramp.speed_m_s", "up.fallen", ".leftover", "left", ""
    };

    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++)
        assert_true(columns_is_count(counts[k]));
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        assert_false(columns_is_count(others[k]));
}

static void a_balance_fills_the_columns_of_its_feed(void **state)
{
    const feed_balance balance = {
        .offered = 9.0, .admitted = 5.0, .waiting = 3.0, .discarded = 1.0
    };
    double values[COLUMNS_OF_FEED];

    columns_put_feed(&balance, values);
    assert_true(values[0] == 9.0 && values[1] == 5.0 && values[2] == 3.0 && values[3] == 1.0);
}

static void a_counter_with_the_name_of_another_column_is_a_fault(void **state)
{
    const scene s = { .n_counters = 2, .counters = counters, .n_eyes = 2, .eyes = eyes };
    const scene sound = { .n_counters = 1, .counters = counters, .n_eyes = 2, .eyes = eyes };
    bf_faults faults = { 0 };

    columns_check(&sound, &faults);
    assert_int_equal(faults.n, 0);
    columns_check(&s, &faults);
    assert_int_equal(faults.n, 1);
    assert_string_equal(faults.items[0].pointer, "/counters/1/id");
}

static void assert_steps(const scene_output *output, schedule_of of, double dt, size_t n,
                         const uint64_t *expected)
{
    uint64_t step = 0;

    for (size_t k = 0; k < n; k++) {
        step = schedule_next(output, of, step, dt);
        assert_int_equal(step, expected[k]);
    }
}

#define ASSERT_STEPS(output, of, dt, ...)                                                          \
    assert_steps(output, of, dt, sizeof((uint64_t[]){ __VA_ARGS__ }) / sizeof(uint64_t),           \
                 (uint64_t[]){ __VA_ARGS__ })

static void results_are_due_at_the_first_step_at_or_past_each_multiple(void **state)
{
    const scene_output output = { .curve_every = 0.3, .snapshot_every = 0.25 };

    ASSERT_STEPS(&output, SCHEDULE_CURVE, 0.1, 3, 6, 9, 12);
    ASSERT_STEPS(&output, SCHEDULE_SNAPSHOT, 0.1, 3, 5, 8, 10);
    // A step that is longer than the period.
    ASSERT_STEPS(&output, SCHEDULE_CURVE, 0.7, 1, 2, 3);
}

static void in_a_window_its_own_period_counts_from_its_start(void **state)
{
    scene_output_window windows[] = {
        { .from = 1.1, .to = 2.0, .curve_every = 0.4, .snapshot_every = 5.0 },
        { .from = 2.0, .to = 2.3, .curve_every = 0.1, .snapshot_every = 0.2 },
    };
    const scene_output output = {
        .curve_every = 0.5, .snapshot_every = 0.5, .n_windows = 2, .windows = windows
    };

    // 0.5 and 1.0; 1.1, 1.5, 1.9; 2.0, 2.1, 2.2; 2.5, 3.0.
    ASSERT_STEPS(&output, SCHEDULE_CURVE, 0.1, 5, 10, 11, 15, 19, 20, 21, 22, 25, 30);
    // 0.5 and 1.0; 1.1; 2.0, 2.2; 2.5.
    ASSERT_STEPS(&output, SCHEDULE_SNAPSHOT, 0.1, 5, 10, 11, 20, 22, 25, 30);
    // The next one depends on the step alone.
    assert_int_equal(schedule_next(&output, SCHEDULE_CURVE, 13, 0.1), 15);
    assert_int_equal(schedule_next(&output, SCHEDULE_CURVE, 24, 0.1), 25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_stand_in_the_order_of_the_table),
        cmocka_unit_test(a_scene_without_feeds_has_counters_and_left_domain),
        cmocka_unit_test(what_fell_has_a_column_where_parts_may_fall),
        cmocka_unit_test(counts_since_the_start_are_told_from_what_rises_and_falls),
        cmocka_unit_test(a_balance_fills_the_columns_of_its_feed),
        cmocka_unit_test(a_counter_with_the_name_of_another_column_is_a_fault),
        cmocka_unit_test(results_are_due_at_the_first_step_at_or_past_each_multiple),
        cmocka_unit_test(in_a_window_its_own_period_counts_from_its_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
