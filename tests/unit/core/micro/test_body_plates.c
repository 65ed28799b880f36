// Unit tests of plates whose paths bend: a joint acts on a body once, and there is no gap behind it.

#include "tests/unit/core/helper_body.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

// A box that the belt drives against a plate and along it, over the middle of its path.
static uint64_t digest_of_slide(bool has_point_between)
{
    const double angle = M_PI / 3.0;
    helper_body h;

    helper_body_init(&h, helper_body_box(0.04, 0.04, 0.006));
    h.def.n_belts = h.def.n_obstacles = 1;
    h.path[0] = (vec2){ -0.25, -0.25 * tan(angle) };
    h.path[1] = (vec2){ 0.0, 0.0 };
    h.path[2] = (vec2){ 0.25, 0.25 * tan(angle) };
    h.obstacle.n_points = has_point_between ? 3 : 2;
    if (!has_point_between)
        h.path[1] = h.path[2];
    h.poses[0] = (scene_pose){ -0.03 * sin(angle) - 0.08 * cos(angle),
                               0.03 * cos(angle) - 0.08 * sin(angle), angle };
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.6);
    assert_true(s->bodies[0].x.y > 0.0); // it has passed the point
    uint64_t digest = helper_body_digest(s);
    micro__body.destroy(s);
    return digest;
}

static void a_point_on_a_straight_path_changes_nothing(void **state)
{
    assert_true(digest_of_slide(true) == digest_of_slide(false));
}

// The force of plates on the first body, at rest with its centre at a place.
static vec3 force_at(const helper_body *h, vec2 at)
{
    body_load load = { .torque = { 0.0, 0.0, 0.0 } };
    body_report report = { .bad_part = SIZE_MAX };
    body_state *s = helper_body_start(h);

    s->bodies[0].x.x = at.x;
    s->bodies[0].x.y = at.y;
    s->bodies[0].v = (vec3){ 0.0, 0.0, 0.0 };
    body__add_boundary_forces(s, 0, &load, &report);
    micro__body.destroy(s);
    return load.force;
}

// The force on a box whose front face overlaps the tip of a path by a hundredth of a millimetre.
static vec3 force_at_tip(size_t n_points)
{
    helper_body h;

    helper_body_init(&h, helper_body_box(0.04, 0.04, 0.02));
    h.def.n_belts = h.def.n_obstacles = 1;
    h.path[0] = (vec2){ 0.1, -0.2 };
    h.path[1] = (vec2){ 0.0, 0.0 };
    h.path[2] = (vec2){ 0.1, 0.2 };
    h.obstacle.n_points = n_points;
    h.poses[0] = (scene_pose){ -0.03, 0.0, 0.0 };
    return force_at(&h, (vec2){ -0.02 + 1e-5, 0.0 });
}

// With two points there is only the plate below the tip.
static void the_outer_side_of_a_bend_acts_once(void **state)
{
    vec3 one = force_at_tip(2), both = force_at_tip(3);
    assert_true(one.x < 0.0);
    assert_near(both.x, one.x, 1e-9 * fabs(one.x));
}

// The force on a long box whose corner is 1e-5 m inside the second plate, `along` it behind the joint. The centre is
// before the first one; the box leaves the corner by 10 degrees. Not bent: the second plate goes on instead of the first.
static vec3 force_on_corner(double along, bool is_bent)
{
    const double bend = 15.0 * M_PI / 180.0, heading = 0.5 * M_PI - 25.0 * M_PI / 180.0;
    const vec2 second = { sin(bend), cos(bend) }, normal = { -second.y, second.x };
    const vec2 to_corner = { 0.06 * cos(heading) + 0.01 * sin(heading),
                             0.06 * sin(heading) - 0.01 * cos(heading) };
    helper_body h;

    helper_body_init(&h, helper_body_box(0.12, 0.02, 0.02));
    h.def.n_belts = h.def.n_obstacles = 1;
    h.path[0] = is_bent ? (vec2){ 0.0, -0.1 } : vec2_scale(second, -0.1);
    h.path[1] = is_bent ? (vec2){ 0.0, 0.0 } : vec2_scale(second, 0.1);
    h.path[2] = vec2_scale(second, 0.1);
    h.obstacle.n_points = is_bent ? 3 : 2;
    h.poses[0] = (scene_pose){ -0.2, 0.0, heading };
    return force_at(
        &h, vec2_sub(vec2_sub(vec2_scale(second, along), vec2_scale(normal, 1e-5)), to_corner));
}

static void a_corner_presses_the_plate_that_it_is_on(void **state)
{
    const double places[] = { 0.03, 0.01 };

    for (int k = 0; k < 2; k++) {
        vec3 force = force_on_corner(places[k], true), known = force_on_corner(places[k], false);
        assert_true(known.x < 0.0 && known.y > 0.0);
        assert_near(force.x, known.x, 1e-6 * fabs(known.x));
        assert_near(force.y, known.y, 1e-6 * fabs(known.x));
    }
}

// Nearer to the end of the second plate than to its side, where the first one may be felt instead, whose normal is 15
// degrees off and below which the corner is 0.8 % less deep.
static void a_corner_at_a_joint_is_held(void **state)
{
    vec3 force = force_on_corner(1e-6, true), known = force_on_corner(1e-6, false);

    assert_true(vec3_dot(force, known) >= 0.95 * vec3_dot(known, known));
}

// A plate of 5 cm that opens upstream by a right angle. A small disk comes from downstream, on a belt of
// its own, towards the corner, where the two downstream faces meet at sqrt(2) thicknesses behind the tip.
static void there_is_no_gap_behind_a_bend(void **state)
{
    const double thickness = 0.05, corner = M_SQRT2 * thickness;
    const vec2 behind[] = { { 0.01, -0.2 }, { 0.3, -0.2 }, { 0.3, 0.2 }, { 0.01, 0.2 } };
    vec2 polygon[4];
    helper_body h;

    helper_body_init(&h, helper_body_cylinder(0.005, 0.01));
    h.def.n_belts = 2;
    h.def.n_obstacles = 1;
    h.obstacle.thickness = thickness;
    h.obstacle.n_points = 3;
    h.path[0] = (vec2){ -0.2, -0.2 };
    h.path[1] = (vec2){ 0.0, 0.0 };
    h.path[2] = (vec2){ -0.2, 0.2 };
    for (int k = 0; k < 4; k++)
        polygon[k] = behind[k];
    h.belts[1] = (scene_belt){ .velocity = { -0.4, 0.0 }, .n_points = 4, .polygon = polygon };
    h.poses[0] = (scene_pose){ corner + 0.03, 0.0, 0.0 };
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.5);
    assert_true(s->bodies[0].x.x > corner);
    micro__body.destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_on_a_straight_path_changes_nothing),
        cmocka_unit_test(the_outer_side_of_a_bend_acts_once),
        cmocka_unit_test(a_corner_presses_the_plate_that_it_is_on),
        cmocka_unit_test(a_corner_at_a_joint_is_held),
        cmocka_unit_test(there_is_no_gap_behind_a_bend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
