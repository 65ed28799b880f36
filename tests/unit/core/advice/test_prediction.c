// Predictions: the load of a run from a run on a coarse grid, and its time from costs and the machine's speed.

#include "core/advice/prediction.h"
#include "core/advice/prediction_load.h"
#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

enum { ROWS = 10, COLUMNS = 10 };

static const prediction_speed same = { .factors = { 1, 1, 1, 1, 1, 1, 1 } };

// A block of parts 2 m before the end of a belt of 0.5 m/s.
static void make_scene(scene *s, double duration)
{
    scene_pose poses[ROWS * COLUMNS];

    for (size_t k = 0; k < ROWS * COLUMNS; k++)
        poses[k] = (scene_pose){ .x = 0.2 + 0.03 * (double)(k % COLUMNS),
                                 .y = 0.1 + 0.03 * (double)(k / COLUMNS) };
    helper_scene_belt(s, 2.0, 0.48, 0.01, poses, ROWS * COLUMNS);
    helper_scene_add_belt(s, (vec2){ 0.5, 0.0 }, NULL, 0);
    s->duration = duration;
    s->macro.step = 0.0;
}

static void check_scene(scene *s, run_model model)
{
    bf_faults faults = { 0 };

    helper_scene_resolve(s);
    scene_check(s, &faults);
    run_check(s, model, &faults);
    if (faults.n > 0)
        fail_msg("%s: %s", faults.items[0].pointer, faults.items[0].text);
}

static prediction_load load_of(scene *s, run_model model)
{
    prediction_load load;

    assert_int_equal(prediction_load_of(s, model, &load, NULL), BF_OK);
    return load;
}

static bf_status take(void *context, const frame *f, bf_error *err)
{
    return BF_OK;
}

static void test_parts_that_leave_stop_to_count(void **state)
{
    scene s;

    make_scene(&s, 8.0);
    check_scene(&s, RUN_MICRO);
    const prediction_load load = load_of(&s, RUN_MICRO);
    // Part k is there until it has gone from its place to x = 2 m; the mean place is 0.2 m + 4.5 * 0.03 m.
    const double expected = ROWS * COLUMNS * (2.0 - 0.335) / 0.5;
    assert_near(load.parts, expected, 0.03 * expected);
    assert_true(load.time == 8.0);
    assert_true(load.saturated == 0.0 && load.saturated_area == 0.0);
    scene_fini(&s);
}

static void test_parts_that_jam_count_to_the_end(void **state)
{
    const vec2 across[] = { { 1.5, 0.0 }, { 1.5, 0.48 } };
    scene s;

    make_scene(&s, 8.0);
    helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
    check_scene(&s, RUN_MICRO);
    const prediction_load load = load_of(&s, RUN_MICRO);
    assert_near(load.parts, 8.0 * ROWS * COLUMNS, 0.02 * 8.0 * ROWS * COLUMNS);
    // They reach the plate after 1.8 s to 2.4 s, and are saturated soon after that.
    assert_true(load.saturated > 0.5 * 5.0 * ROWS * COLUMNS && load.saturated < load.parts);
    scene_fini(&s);
}

static void test_a_long_run_is_followed_for_a_part_of_it(void **state)
{
    scene s;

    make_scene(&s, 10000.0);
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
    s.output.curve_every = s.output.snapshot_every = 1.0;
    check_scene(&s, RUN_MACRO);
    const prediction_load load = load_of(&s, RUN_MACRO);
    // 20 parts/s that take 4 s each.
    assert_near(load.parts / 10000.0, 80.0, 4.0);
    scene_fini(&s);
}

// 5 parts/s that all stay before a plate across the belt: their number rises as the time, up to 750, and none of the run stands for
// the rest of it.
static void test_a_queue_that_grows_all_the_time_is_followed_to_the_end(void **state)
{
    const vec2 across[] = { { 1.5, 0.0 }, { 1.5, 0.48 } };
    const double expected = 0.5 * 5.0 * 150.0 * 150.0;
    scene s;

    make_scene(&s, 150.0);
    s.initial.type = SCENE_INITIAL_EMPTY;
    s.macro.closure = SCENE_CONGESTED;
    helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 5.0);
    s.output.curve_every = s.output.snapshot_every = 1.0;
    check_scene(&s, RUN_MACRO);
    const prediction_load load = load_of(&s, RUN_MACRO);
    assert_near(load.parts, expected, 0.03 * expected);
    assert_true(load.saturated > 0.7 * expected && load.saturated < load.parts);
    scene_fini(&s);
}

static void test_fields_are_made_while_plates_move(void **state)
{
    const vec2 flap[] = { { 1.5, 0.0 }, { 1.7, 0.0 } };
    const double times[] = { 1.0, 2.0 }, angles[] = { 0.0, 0.5 };
    scene s;

    make_scene(&s, 8.0);
    helper_scene_add_obstacle(&s, flap, 2, SCENE_SEALED);
    check_scene(&s, RUN_MACRO);
    assert_true(load_of(&s, RUN_MACRO).fields == 0.0);
    scene_fini(&s);
    make_scene(&s, 8.0);
    helper_scene_add_obstacle(&s, flap, 2, SCENE_SEALED);
    s.obstacles[0].turn = helper_scene_series(2, times, angles, INFINITY);
    check_scene(&s, RUN_MACRO);
    // The flap's tip goes by 0.2 m * 0.5, of which each quarter of a cell asks for one: at most one step late.
    const double expected = 0.1 / (0.25 * 0.01);
    const double fields = load_of(&s, RUN_MACRO).fields;
    assert_true(fields > 0.5 * expected && fields < 1.2 * expected);
    scene_fini(&s);
}

static void test_tracers_are_there_while_cargo_is_fed(void **state)
{
    scene s;

    make_scene(&s, 8.0);
    check_scene(&s, RUN_MACRO);
    assert_true(load_of(&s, RUN_MACRO).tracers == 0.0);
    scene_fini(&s);
    make_scene(&s, 100.0);
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
    check_scene(&s, RUN_MACRO);
    // A thousand of what is fed in 100 s, each for the 4 s of its way.
    const double expected = 1024.0 * 4.0;
    assert_near(load_of(&s, RUN_MACRO).tracers, expected, 0.3 * expected);
    scene_fini(&s);
}

// What the run on coarse cells foresees of its cells is what the run itself goes over.
static void test_sweeps_are_foreseen(void **state)
{
    static const scene_scheme schemes[] = { SCENE_SCHEME_ROE, SCENE_SCHEME_MUSCL };
    const vec2 across[] = { { 1.5, 0.0 }, { 1.5, 0.48 } };
    const run_sink sink = { NULL, take, NULL };

    for (size_t k = 0; k < sizeof schemes / sizeof *schemes; k++) {
        run *r = NULL;
        scene s;
        make_scene(&s, 8.0);
        s.macro.scheme = schemes[k];
        helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
        check_scene(&s, RUN_MACRO);
        const prediction_load load = load_of(&s, RUN_MACRO);
        assert_int_equal(run_create(&s, RUN_MACRO, 1, &r, NULL), BF_OK);
        assert_int_equal(run_execute(r, &sink, NULL), BF_OK);
        const run_work work = run_work_of(r);
        run_destroy(r);
        assert_true(work.dispersed > 0.0);
        assert_near(load.swept, work.swept, 0.1 * work.swept);
        assert_near(load.varied, work.varied, 0.25 * work.varied);
        assert_near(load.dispersed, work.dispersed, 0.5 * work.dispersed);
        scene_fini(&s);
    }
}

// Where nothing is saturated no I is made, and on a belt of one velocity no cell's fluxes are made one by one.
static void test_loose_cargo_is_carried_by_one_velocity(void **state)
{
    scene s;

    make_scene(&s, 2.0);
    check_scene(&s, RUN_MACRO);
    const prediction_load load = load_of(&s, RUN_MACRO);
    assert_true(load.swept > 0.0 && load.dispersed == 0.0 && load.varied == 0.0);
    scene_fini(&s);
}

// Where nothing jams they count once for each cell that cargo covers, in each step.
static void test_kinds_count_where_they_are_told_apart(void **state)
{
    for (int tells = 0; tells < 2; tells++) {
        scene s;
        prediction_work work;
        make_scene(&s, 8.0);
        s.macro.closure = SCENE_CONGESTED;
        s.n_counters = 1;
        s.counters = memory_alloc(1, sizeof *s.counters);
        assert_non_null(s.counters);
        scene_counter_init(s.counters);
        s.counters[0].rect = s.domain;
        s.counters[0].kind = tells ? 0 : SCENE_KIND_ANY;
        check_scene(&s, RUN_MACRO);
        assert_int_equal(prediction_work_of(&s, RUN_MACRO, &work, NULL), BF_OK);
        assert_true(work.amounts[PREDICTION_COVERED_STEPS] > 0.0);
        assert_true(work.amounts[PREDICTION_KIND_STEPS] ==
                    (tells ? work.amounts[PREDICTION_COVERED_STEPS] : 0.0));
        scene_fini(&s);
    }
}

// Each snapshot spreads each part, as each sample looks at each one.
static void test_results_of_parts_cost_by_parts(void **state)
{
    const double parts = ROWS * COLUMNS, reach2 = 2.0 * 53.0 * M_LN2;
    prediction_work work;
    scene s;

    make_scene(&s, 2.0); // within which none leaves
    s.output.curve_every = 0.05;
    s.output.snapshot_every = 0.25;
    check_scene(&s, RUN_MICRO);
    assert_int_equal(prediction_work_of(&s, RUN_MICRO, &work, NULL), BF_OK);
    const double cells = M_PI * reach2 / s.macro.initial_mollifier / (0.01 * 0.01);
    const double snapshots = parts * scene_snapshots(&s), samples = parts * scene_samples(&s);
    assert_near(work.amounts[PREDICTION_SPREAD_CELLS], cells * snapshots, 0.02 * cells * snapshots);
    assert_near(work.amounts[PREDICTION_SAMPLE_PARTS], samples, 0.02 * samples);
    scene_fini(&s);
}

// At twice the speed and for half the time the belt moves as far.
static void test_lists_are_made_by_the_way_of_the_belt(void **state)
{
    double listed[2], pairs[2];

    for (int k = 0; k < 2; k++) {
        prediction_work work;
        scene s;
        make_scene(&s, k == 0 ? 2.0 : 1.0);
        s.belts[0].velocity = (vec2){ k == 0 ? 0.5 : 1.0, 0.0 };
        s.micro.step = 1e-4;
        check_scene(&s, RUN_MICRO);
        assert_int_equal(prediction_work_of(&s, RUN_MICRO, &work, NULL), BF_OK);
        listed[k] = work.amounts[PREDICTION_LISTED_PAIRS];
        pairs[k] = work.amounts[PREDICTION_PAIR_STEPS];
        scene_fini(&s);
    }
    assert_true(listed[0] > 0.0);
    assert_near(listed[1] / listed[0], 1.0, 0.05);
    assert_near(pairs[1] / pairs[0], 0.5, 0.05);
}

static void test_a_jam_takes_time_in_proportion_to_its_duration(void **state)
{
    const vec2 across[] = { { 1.5, 0.0 }, { 1.5, 0.48 } };
    double seconds[2];

    for (int model = 0; model < RUN_MODEL_COUNT; model++) {
        for (size_t k = 0; k < 2; k++) {
            prediction_work work;
            scene s;
            make_scene(&s, k == 0 ? 40.0 : 80.0);
            helper_scene_add_obstacle(&s, across, 2, SCENE_SEALED);
            check_scene(&s, (run_model)model);
            assert_int_equal(prediction_work_of(&s, (run_model)model, &work, NULL), BF_OK);
            seconds[k] = prediction_seconds(&work, &same);
            scene_fini(&s);
        }
        assert_true(seconds[0] > 0.0);
        assert_near(seconds[1] / seconds[0], 2.0, 0.25);
    }
}

static void test_a_machine_half_as_fast_takes_twice_as_long(void **state)
{
    const prediction_speed half = { .factors = { 2, 2, 2, 2, 2, 2, 2 } };
    prediction_work work;
    scene s;

    make_scene(&s, 4.0);
    check_scene(&s, RUN_MACRO);
    assert_int_equal(prediction_work_of(&s, RUN_MACRO, &work, NULL), BF_OK);
    assert_true(prediction_seconds(&work, &half) == 2.0 * prediction_seconds(&work, &same));
    scene_fini(&s);
}

static double fake_s;

// A clock by which nothing is done in less than a second.
static double read_fake_s(void)
{
    return fake_s += 1.0;
}

static void test_the_speed_is_measured_by_the_clock(void **state)
{
    double slow, fast;

    for (int kind = 0; kind < PREDICTION_KIND_COUNT; kind++) {
        assert_int_equal(prediction_measure((prediction_kind)kind, read_fake_s, 0.0, &slow, NULL),
                         BF_OK);
        // Two runs, of which each takes a second.
        assert_int_equal(prediction_measure((prediction_kind)kind, read_fake_s, 4.0, &fast, NULL),
                         BF_OK);
        assert_true(slow > 0.0 && fast == slow);
    }
}

static void test_no_memory_is_an_error(void **state)
{
    bf_status status = BF_ENOMEM;
    prediction_work work;
    scene s;

    make_scene(&s, 0.1);
    check_scene(&s, RUN_MICRO);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = prediction_work_of(&s, RUN_MICRO, &work, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        assert_true(n < 2000);
    }
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts_that_leave_stop_to_count),
        cmocka_unit_test(test_parts_that_jam_count_to_the_end),
        cmocka_unit_test(test_a_long_run_is_followed_for_a_part_of_it),
        cmocka_unit_test(test_a_queue_that_grows_all_the_time_is_followed_to_the_end),
        cmocka_unit_test(test_fields_are_made_while_plates_move),
        cmocka_unit_test(test_tracers_are_there_while_cargo_is_fed),
        cmocka_unit_test(test_sweeps_are_foreseen),
        cmocka_unit_test(test_loose_cargo_is_carried_by_one_velocity),
        cmocka_unit_test(test_kinds_count_where_they_are_told_apart),
        cmocka_unit_test(test_results_of_parts_cost_by_parts),
        cmocka_unit_test(test_lists_are_made_by_the_way_of_the_belt),
        cmocka_unit_test(test_a_jam_takes_time_in_proportion_to_its_duration),
        cmocka_unit_test(test_a_machine_half_as_fast_takes_twice_as_long),
        cmocka_unit_test(test_the_speed_is_measured_by_the_clock),
        cmocka_unit_test(test_no_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
