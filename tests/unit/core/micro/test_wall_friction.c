// Friction at walls of the domain: that of a plate in the same place, by every solver.

#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const vec2 belt_velocity = { 0.4, -0.3 };

static const scene_shape cylinder = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 };
static const scene_shape box = {
    .type = SCENE_BOX, .length = 0.03, .width = 0.024, .height = 0.008
};

// What a belt that runs askew against its side makes of a part that lies there, after 1 s. The side is a wall of the
// domain with this friction or, NAN, the upstream face of a plate.
static micro_part slide(int solver, const scene_shape *shape, double wall_friction)
{
    const bool has_plate = isnan(wall_friction);
    scene_belt belt = { .velocity = belt_velocity };
    vec2 path[2] = { { -1.0, 0.0 }, { 3.0, 0.0 } };
    scene_obstacle plate = { .n_points = 2, .path = path, .thickness = 0.01 };
    const scene_pose pose = { 0.1, 0.012, 0.0 };
    micro_kind kind = {
        .shape = *shape, .material = { 210e9, 0.28 }, .mass = 0.03, .spin_radius = 0.008
    };
    micro_def def = helper_micro_def(solver);

    def.domain = (scene_rect){ 0.0, 2.0, has_plate ? -0.5 : 0.0, 1.0 };
    def.n_belts = def.n_kinds = def.n_parts = 1;
    def.belts = &belt;
    def.n_obstacles = has_plate ? 1 : 0;
    def.obstacles = &plate;
    def.kinds = &kind;
    def.poses = &pose;
    def.wall_friction = has_plate ? 0.0 : wall_friction;
    micro_solver *s = helper_micro_start(&def);
    helper_micro_advance_to(s, 1.0);
    const micro_part part = micro_part_of(s, 0);
    micro_destroy(s);
    return part;
}

static void check_equal(int solver, const scene_shape *shape, double tolerance)
{
    const micro_def def = micro_def_default();
    const double friction = def.contact[SCENE_HANDLING_CARGO].friction;
    const micro_part plate = slide(solver, shape, NAN), wall = slide(solver, shape, friction);
    const micro_part smooth = slide(solver, shape, 0.0);

    assert_true(def.wall_friction == friction);
    assert_near(wall.x[0], plate.x[0], tolerance);
    assert_near(wall.x[1], plate.x[1], tolerance);
    assert_near(wall.v[0], plate.v[0], tolerance);
    assert_true(smooth.x[0] > wall.x[0] + 0.005);
    assert_near(smooth.v[0], belt_velocity.x, 1e-4);
}

static void a_part_slides_along_a_wall_as_along_a_plate(void **state)
{
    for (int solver = 0; solver < HELPER_MICRO_SOLVERS; solver++) {
        const bool is_planar = helper_micro_solvers[solver].path == MICRO_PATH_PLANAR;
        // A cylinder that leans a little touches a plate within its radius, and a wall by its rims.
        check_equal(solver, &cylinder, is_planar ? 1e-12 : 1e-6);
        if (!is_planar)
            check_equal(solver, &box, 1e-12);
    }
}

// The belt's friction F on a box that slides steadily at u along the wall acts along its slip, (v_x - u, v_y): the
// wall takes the part F v_y/|slip| of it as its normal force, of which it gives mu tanh(lambda u) back along itself. So
// v_x - u = mu tanh(lambda u) |v_y|.
static void a_box_slides_at_the_speed_that_both_frictions_give(void **state)
{
    const double mu = 0.19, lambda = 10.0;
    double u = belt_velocity.x;

    for (int k = 0; k < 100; k++)
        u = belt_velocity.x + mu * tanh(lambda * u) * belt_velocity.y;
    for (int solver = 0; solver < HELPER_MICRO_SOLVERS; solver++)
        if (helper_micro_solvers[solver].path == MICRO_PATH_SPATIAL)
            assert_near(slide(solver, &box, mu).v[0], u, 1e-3 * u);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_slides_along_a_wall_as_along_a_plate),
        cmocka_unit_test(a_box_slides_at_the_speed_that_both_frictions_give),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
