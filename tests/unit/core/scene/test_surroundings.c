// Unit tests of belts, pieces of plates and edges.

#include "core/scene/surroundings.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <float.h>

static const scene_pose somewhere = { 0.1, 0.1, 0.0 };
static const vec2 west[] = { { 0.0, 0.0 }, { 0.6, 0.0 }, { 0.6, 0.4 }, { 0.0, 0.4 } };
static const vec2 east[] = { { 0.4, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.4 }, { 0.4, 0.4 } };

/// A domain of 1 x 0.5 m with two belts that overlap from x = 0.4 to 0.6 m.
static void make_two_belts(scene *s)
{
    helper_scene_belt(s, 1.0, 0.5, 0.005, &somewhere, 1);
    helper_scene_add_belt(s, (vec2){ 0.1, 0.0 }, west, 4);
    helper_scene_add_belt(s, (vec2){ 0.0, 0.2 }, east, 4);
    helper_scene_resolve(s);
}

static void assert_belt(const surroundings *around, double x, double y, size_t belt, vec2 v)
{
    const vec2 velocity = surroundings_velocity_at(around, belt, (vec2){ x, y });

    assert_int_equal(surroundings_belt_at(around, (vec2){ x, y }), belt);
    assert_true(velocity.x == v.x && velocity.y == v.y);
}

static void the_later_belt_wins_and_nothing_moves_off_the_belts(void **state)
{
    scene s;

    make_two_belts(&s);
    const surroundings around = surroundings_of(&s);
    assert_belt(&around, 0.2, 0.2, 0, (vec2){ 0.1, 0.0 });
    assert_belt(&around, 0.5, 0.2, 1, (vec2){ 0.0, 0.2 });
    assert_belt(&around, 0.4, 0.2, 1, (vec2){ 0.0, 0.2 }); // borders belong to the belt
    assert_belt(&around, 0.5, 0.4 + 2e-9, 2, (vec2){ 0.0, 0.0 });
    scene_fini(&s);
}

// A curve to the right from the east to the south, 0.8 rad/s about the origin.
static void an_arc_carries_between_its_circles_and_ends_and_turns(void **state)
{
    scene s;

    helper_scene_belt(&s, 1.0, 1.0, 0.01, &somewhere, 1);
    helper_scene_add_arc(&s, 0.4, 0.4, 0.6, 90.0, 0.0);
    helper_scene_resolve(&s);
    const surroundings around = surroundings_of(&s);
    assert_near(s.belts[0].turn, -0.8, 1e-15);
    assert_belt(&around, 0.5, 0.0, 0, (vec2){ 0.0, -0.4 });
    assert_belt(&around, 0.3, 0.4, 0, (vec2){ 0.8 * 0.4, 0.8 * -0.3 });
    assert_belt(&around, 0.6, 0.0, 0, (vec2){ 0.0, 0.8 * -0.6 });
    assert_belt(&around, 0.6 + 2e-9, 0.0, 1, (vec2){ 0.0, 0.0 });
    assert_belt(&around, 0.5, -2e-9, 1, (vec2){ 0.0, 0.0 });
    assert_belt(&around, 0.2, 0.3, 1, (vec2){ 0.0, 0.0 });
    // A part that rests on the inner border rests on both sides of its centre.
    for (int k = 1; k < 900; k++) {
        const double at = k * M_PI / 1800.0, r = 0.4 - 2e-5;
        assert_int_equal(surroundings_belt_at(&around, (vec2){ r * cos(at), r * sin(at) }), 0);
    }
    assert_near(surroundings_border_distance(&around, (vec2){ 0.33, 0.44 }), 0.05, 1e-12);
    assert_near(surroundings_border_distance(&around, (vec2){ 0.5, 0.02 }), 0.02, 1e-12);
    assert_near(surroundings_border_distance(&around, (vec2){ 0.5, -0.03 }), 0.03, 1e-12);
    scene_fini(&s);
}

static void the_distance_to_a_border_is_that_of_the_nearest_belt(void **state)
{
    scene s;

    make_two_belts(&s);
    surroundings around = surroundings_of(&s);
    assert_near(surroundings_border_distance(&around, (vec2){ 0.5, 0.2 }), 0.1, 1e-15);
    assert_near(surroundings_border_distance(&around, (vec2){ 0.8, 0.35 }), 0.05, 1e-15);
    around.n_belts = 0;
    assert_true(surroundings_border_distance(&around, (vec2){ 0.5, 0.2 }) == DBL_MAX);
    scene_fini(&s);
}

static void a_copy_outlives_the_scene_and_is_whole_or_not_there(void **state)
{
    for (size_t n = 1;; n++) {
        scene s;
        make_two_belts(&s);
        const surroundings around = surroundings_of(&s);
        surroundings copy;
        memory_plan_fault(n, 0);
        bf_status status = surroundings_copy(&around, &copy, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        scene_fini(&s);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            assert_belt(&copy, 0.5, 0.2, 1, (vec2){ 0.0, 0.2 });
            surroundings_fini(&copy);
            break;
        }
        assert_int_equal(status, BF_ENOMEM);
        assert_null(copy.belts);
    }
}

static void a_piece_faces_against_the_belt_whichever_way_its_path_runs(void **state)
{
    // 45 degrees: t = (1, 1)/sqrt(2); against v_T = (0.395, 0) stands n = (-1, 1)/sqrt(2).
    static const vec2 up[] = { { 0.4, 0.1 }, { 0.7, 0.4 } },
                      down[] = { { 0.7, 0.4 }, { 0.4, 0.1 } };
    const double half = sqrt(0.5);
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
    helper_scene_add_obstacle(&s, up, 2, SCENE_SEALED);
    helper_scene_add_obstacle(&s, down, 2, SCENE_SEALED);
    helper_scene_resolve(&s);
    const surroundings around = surroundings_of(&s);
    for (int k = 0; k < 2; k++) {
        const surroundings_piece p = surroundings_piece_of(&around, &s.obstacles[k], 0);
        assert_near(p.length, 0.3 * sqrt(2.0), 1e-15);
        assert_near(p.thickness, 0.005, 0.0);
        assert_near(p.along.x, k == 0 ? half : -half, 1e-15);
        assert_near(p.upstream.x, -half, 1e-15);
        assert_near(p.upstream.y, half, 1e-15);
    }
    scene_fini(&s);
}

// A belt at 0.395 m/s along x, and one of 0.05 degrees: what is typed is rounded.
static void along_the_belt_the_left_side_is_upstream(void **state)
{
    const vec2 n = surroundings_upstream((vec2){ 1.0, 0.0 }, (vec2){ 0.395, 1e-14 });
    const vec2 m = surroundings_upstream((vec2){ 1.0, 0.0 }, (vec2){ 0.395, 3.4e-4 });

    assert_true(n.x == 0.0 && n.y == 1.0);
    assert_true(m.x == 0.0 && m.y == 1.0);
}

static void assert_corners(const surroundings *around, const scene_obstacle *o, size_t k,
                           double low, double high)
{
    const surroundings_piece p = surroundings_piece_of(around, o, k);
    double y_min = INFINITY, y_max = -INFINITY;
    vec2 corners[4];

    surroundings_piece_corners(&p, corners);
    for (int c = 0; c < 4; c++) {
        y_min = fmin(y_min, corners[c].y);
        y_max = fmax(y_max, corners[c].y);
    }
    assert_near(y_min, low, 1e-12);
    assert_near(y_max, high, 1e-12);
}

// 20 mm thick, whichever way the paths run, and where rounding makes them askew by 1e-9.
static void a_guide_is_centred_on_its_path(void **state)
{
    static const vec2 paths[][2] = { { { 0.2, 0.3 }, { 0.8, 0.3 } },
                                     { { 0.8, 0.3 }, { 0.2, 0.3 } },
                                     { { 0.2, 0.3 + 1e-13 }, { 0.8, 0.3 } },
                                     { { 0.2, 0.3 - 1e-13 }, { 0.8, 0.3 } } };
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
    for (size_t k = 0; k < 4; k++)
        helper_scene_add_obstacle(&s, paths[k], 2, SCENE_SEALED)->thickness = 0.02;
    helper_scene_resolve(&s);
    const surroundings around = surroundings_of(&s);
    for (size_t k = 0; k < 4; k++)
        assert_corners(&around, &s.obstacles[k], 0, 0.29, 0.31);
    scene_fini(&s);
}

// A funnel that goes over into two collinear guides and opens again by 45 degrees, drawn from either end. The body lies above
// the path, where it does of the funnel: also of what opens, which faces downstream.
static void the_body_of_a_path_lies_on_one_side(void **state)
{
    static const vec2 path[] = {
        { 0.2, 0.4 }, { 0.4, 0.3 }, { 0.6, 0.3 }, { 0.8, 0.3 }, { 0.9, 0.4 }
    };
    vec2 back[5];
    scene s;

    for (int k = 0; k < 5; k++)
        back[k] = path[4 - k];
    helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
    helper_scene_add_obstacle(&s, path, 5, SCENE_SEALED)->thickness = 0.02;
    helper_scene_add_obstacle(&s, back, 5, SCENE_SEALED)->thickness = 0.02;
    helper_scene_resolve(&s);
    const surroundings around = surroundings_of(&s);
    for (size_t k = 1; k < 3; k++) {
        assert_corners(&around, &s.obstacles[0], k, 0.3, 0.32);
        assert_corners(&around, &s.obstacles[1], 3 - k, 0.3, 0.32);
    }
    assert_corners(&around, &s.obstacles[0], 3, 0.3, 0.4 + 0.02 * M_SQRT1_2);
    assert_corners(&around, &s.obstacles[1], 0, 0.3, 0.4 + 0.02 * M_SQRT1_2);
    scene_fini(&s);
}

static void parts_leave_over_edges_that_are_no_walls(void **state)
{
    static const vec2 beyond[SCENE_SIDE_COUNT] = { [SCENE_WEST] = { -0.1, 0.2 },
                                                   [SCENE_EAST] = { 1.1, 0.2 },
                                                   [SCENE_SOUTH] = { 0.5, -0.1 },
                                                   [SCENE_NORTH] = { 0.5, 0.6 } };
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
    surroundings around = surroundings_of(&s);
    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        const surroundings_line line = surroundings_side(&around, (scene_side)side);
        assert_near(surroundings_excess(&around, (scene_side)side, beyond[side]), 0.1, 1e-15);
        assert_near(vec2_dot(vec2_sub(line.at, beyond[side]), line.inward), 0.1, 1e-15);
        for (int edge = 0; edge < SCENE_EDGE_COUNT; edge++) {
            around.edges[side] = (scene_edge)edge;
            assert_int_equal(surroundings_is_outside(&around, beyond[side]),
                             edge != SCENE_EDGE_WALL);
        }
    }
    assert_false(surroundings_is_outside(&around, (vec2){ 1.0, 0.5 })); // the border is inside
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_later_belt_wins_and_nothing_moves_off_the_belts),
        cmocka_unit_test(an_arc_carries_between_its_circles_and_ends_and_turns),
        cmocka_unit_test(the_distance_to_a_border_is_that_of_the_nearest_belt),
        cmocka_unit_test(a_copy_outlives_the_scene_and_is_whole_or_not_there),
        cmocka_unit_test(a_piece_faces_against_the_belt_whichever_way_its_path_runs),
        cmocka_unit_test(along_the_belt_the_left_side_is_upstream),
        cmocka_unit_test(a_guide_is_centred_on_its_path),
        cmocka_unit_test(the_body_of_a_path_lies_on_one_side),
        cmocka_unit_test(parts_leave_over_edges_that_are_no_walls),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
