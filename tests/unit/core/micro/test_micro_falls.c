// The four microscopic solvers where belts leave a gap: parts cross it or fall. Expected values are derived.

#include "core/base/memory.h"
#include "core/micro/micro.h"
#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

#define RADIUS 0.012 // of a cylinder, and half the least width of a box, m
#define SPEED  0.4   // of both belts, m/s
#define BORDER 0.5   // where the first belt ends, m

enum { COLUMNS = 30, ROWS = 40, PARTS_MAX = COLUMNS * ROWS };

// Two belts along x, the second one behind a gap. Do not move it once it was made.
typedef struct world {
    micro_def def;
    scene_belt belts[2];
    vec2 corners[2][4];
    micro_kind kind;
    scene_pose poses[PARTS_MAX];
} world;

static void make_world(world *w, int solver, scene_shape_type shape, double gap)
{
    const double ends[2][2] = { { 0.0, BORDER }, { BORDER + gap, 3.0 } };

    *w = (world){ .def = helper_micro_def(solver),
                  .kind = { .shape = { .type = shape,
                                       .radius = RADIUS,
                                       .length = 3.0 * RADIUS,
                                       .width = 2.0 * RADIUS,
                                       .height = 0.008 },
                            .material = { 210e9, 0.28 },
                            .mass = 0.0284,
                            .spin_radius = 0.008 } };
    w->def.domain = (scene_rect){ 0.0, 3.0, 0.0, 3.0 };
    w->def.belts = w->belts;
    w->def.n_belts = 2;
    w->def.kinds = &w->kind;
    w->def.n_kinds = 1;
    w->def.poses = w->poses;
    for (int k = 0; k < 2; k++) {
        const vec2 corners[] = {
            { ends[k][0], 0.0 }, { ends[k][1], 0.0 }, { ends[k][1], 3.0 }, { ends[k][0], 3.0 }
        };
        memcpy(w->corners[k], corners, sizeof corners);
        w->belts[k] = (scene_belt){ .velocity = { SPEED, 0.0 },
                                    .acceleration = INFINITY,
                                    .deceleration = INFINITY,
                                    .n_points = 4,
                                    .polygon = w->corners[k] };
    }
}

// Rows of parts that end 10 mm before the border; neighbours touch each other.
static void add_rows(world *w, size_t n_rows)
{
    for (size_t row = 0; row < n_rows; row++)
        for (size_t k = 0; k < COLUMNS; k++)
            w->poses[w->def.n_parts++] = (scene_pose){ BORDER - 0.01 - 2.0 * RADIUS * (double)row,
                                                       0.1 + 2.0 * RADIUS * (double)k, 0.0 };
}

static bool is_spatial(int solver)
{
    return helper_micro_solvers[solver].path == MICRO_PATH_SPATIAL;
}

// It keeps its speed: both belts have it, and one of them always carries the part.
static void check_crossing(int solver, scene_shape_type shape)
{
    world w;

    make_world(&w, solver, shape, 0.4 * RADIUS);
    w.poses[0] = (scene_pose){ 0.45, 1.0, 0.0 };
    w.def.n_parts = 1;
    micro_solver *s = helper_micro_start(&w.def);
    helper_micro_advance_to(s, 0.5);
    assert_false(micro_is_gone(s, 0));
    assert_near(micro_part_of(s, 0).x[0], 0.45 + SPEED * 0.5, 1e-6);
    assert_near(micro_part_of(s, 0).v[0], SPEED, 1e-6);
    assert_near(micro_part_of(s, 0).w[2], 0.0, 1e-6);
    assert_int_equal(micro_fallen(s), 0);
    micro_destroy(s);
}

// It falls in the step in which its centre comes behind the border, and not before.
static void check_fall(int solver, scene_shape_type shape)
{
    micro_departure gone[2];
    world w;

    make_world(&w, solver, shape, 3.0 * RADIUS);
    w.poses[0] = (scene_pose){ 0.45, 1.0, 0.0 };
    w.poses[1] = (scene_pose){ 1.0, 1.0, 0.0 };
    w.def.n_parts = 2;
    micro_solver *s = helper_micro_start(&w.def);
    helper_micro_advance_to(s, 0.12);
    assert_false(micro_is_gone(s, 0));
    helper_micro_advance_to(s, 0.13);
    assert_true(micro_is_gone(s, 0) && micro_part_of(s, 0).has_fallen && !micro_is_gone(s, 1));
    assert_near(micro_part_of(s, 0).x[0], BORDER, SPEED * micro_dt(s) + 1e-6);
    assert_int_equal(micro_measure(s).n_parts, 1);
    assert_int_equal(micro_fallen(s), 1);
    assert_int_equal(micro_take_departures(s, gone, 2), 1);
    assert_true(gone[0].part == 0 && gone[0].has_fallen);
    assert_int_equal(micro_fallen(s), 1);
    assert_int_equal(micro_take_departures(s, gone, 2), 0);
    micro_destroy(s);
}

static void parts_cross_a_narrow_gap_and_fall_into_a_wide_one(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        check_crossing(k, SCENE_CYLINDER);
        check_fall(k, SCENE_CYLINDER);
        if (!is_spatial(k))
            continue;
        check_crossing(k, SCENE_BOX);
        check_fall(k, SCENE_BOX);
    }
}

// The gap is between the radii of the two kinds.
static void each_kind_bridges_by_its_own_radius(void **state)
{
    for (int solver = 0; solver < HELPER_MICRO_SOLVERS; solver++) {
        const uint32_t of[] = { 0, 1 };
        world w;
        make_world(&w, solver, SCENE_CYLINDER, 1.2 * RADIUS);
        micro_kind kinds[2] = { w.kind, w.kind };
        kinds[1].shape.radius = 1.5 * RADIUS;
        w.poses[0] = (scene_pose){ 0.45, 1.0, 0.0 };
        w.poses[1] = (scene_pose){ 0.45, 2.0, 0.0 };
        w.def.kinds = kinds;
        w.def.n_kinds = w.def.n_parts = 2;
        w.def.part_kinds = of;
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, 0.5);
        assert_true(micro_part_of(s, 0).has_fallen && !micro_is_gone(s, 1));
        assert_near(micro_part_of(s, 1).x[0], 0.45 + SPEED * 0.5, 1e-6);
        micro_destroy(s);
    }
}

static void what_starts_off_the_belts_falls_in_the_first_step(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world w;
        make_world(&w, k, SCENE_CYLINDER, 1.0);
        w.poses[0] = (scene_pose){ 1.0, 1.0, 0.0 };
        w.def.n_parts = 1;
        micro_solver *s = helper_micro_start(&w.def);
        assert_false(micro_is_gone(s, 0));
        assert_int_equal(micro_advance(s, 1, NULL), BF_OK);
        assert_true(micro_part_of(s, 0).has_fallen);
        micro_destroy(s);
    }
}

// What is beyond an open side of the domain has left, also where it is off the belts there.
static void what_leaves_the_domain_has_not_fallen(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        micro_departure gone;
        world w;
        make_world(&w, k, SCENE_CYLINDER, 0.0);
        w.poses[0] = (scene_pose){ 2.99, 1.0, 0.0 };
        w.def.n_parts = 1;
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, 0.1);
        assert_int_equal(micro_take_departures(s, &gone, 1), 1);
        assert_false(gone.has_fallen);
        assert_int_equal(micro_fallen(s), 0);
        micro_destroy(s);
    }
}

static uint64_t run_rows(const world *w, int n_threads, bool is_interrupted)
{
    micro_def def = w->def;
    bf_buffer saved = { 0 };

    def.n_threads = n_threads;
    micro_solver *s = helper_micro_start(&def);
    helper_micro_advance_to(s, 0.01);
    assert_int_equal(micro_fallen(s), COLUMNS); // the first row; the next one is 24 mm behind
    if (is_interrupted) {
        assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
        micro_destroy(s);
        s = helper_micro_start(&def);
        assert_int_equal(micro_load(s, saved.bytes, saved.n, NULL), BF_OK);
        assert_int_equal(micro_fallen(s), COLUMNS);
        buffer_fini(&saved);
    }
    helper_micro_advance_to(s, 0.02);
    assert_int_equal(micro_fallen(s), 2 * COLUMNS);
    const uint64_t digest = micro_digest(s);
    micro_destroy(s);
    return digest;
}

// As many disks as make steps in tiles where these are explicit; at five times the speed, for a fifth of the steps.
static void what_falls_is_the_same_for_any_threads_and_interruption(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        static world w;
        make_world(&w, k, SCENE_CYLINDER, 3.0 * RADIUS);
        w.belts[0].velocity.x = w.belts[1].velocity.x = 5.0 * SPEED;
        add_rows(&w, is_spatial(k) ? 2 : 16);
        const uint64_t digest = run_rows(&w, 1, false);
        for (int is_interrupted = HELPER_AMOUNT(0, 1); is_interrupted < 2; is_interrupted++)
            assert_true(run_rows(&w, 2, is_interrupted) == digest);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_cross_a_narrow_gap_and_fall_into_a_wide_one),
        cmocka_unit_test(each_kind_bridges_by_its_own_radius),
        cmocka_unit_test(what_starts_off_the_belts_falls_in_the_first_step),
        cmocka_unit_test(what_leaves_the_domain_has_not_fallen),
        cmocka_unit_test(what_falls_is_the_same_for_any_threads_and_interruption),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
