// Unit tests of the spatial path: bodies against the closed forms of mechanics.

#include "core/micro/friction.h"
#include "tests/unit/core/helper_body.h"
#include "tests/unit/core/helper_hull.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const double g = 9.81;
static const vec3 along_x = { 1.0, 0.0, 0.0 }, along_y = { 0.0, 1.0, 0.0 };

// The weight m g equals k delta, for any number of contact points: four, three, six or 32.
static void a_part_that_lies_flat_sinks_by_its_weight_over_the_stiffness(void **state)
{
    double hexagon[6][3], triangle[3][3];
    for (int k = 0; k < 6; k++) {
        hexagon[k][0] = 0.012 * cos(M_PI / 3.0 * k);
        hexagon[k][1] = 0.012 * sin(M_PI / 3.0 * k);
    }
    for (int k = 0; k < 3; k++) {
        triangle[k][0] = 0.012 * cos(M_PI / 1.5 * k);
        triangle[k][1] = 0.012 * sin(M_PI / 1.5 * k);
    }
    const scene_shape shapes[] = {
        helper_body_box(0.03, 0.02, 0.01),
        { .type = SCENE_PRISM, .height = 0.01, .n_vertices = 3, .vertices = triangle },
        { .type = SCENE_PRISM, .height = 0.01, .n_vertices = 6, .vertices = hexagon },
        helper_body_cylinder(0.012, 0.01),
    };
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
        helper_body h;
        helper_body_init(&h, shapes[k]);
        body_state *s = helper_body_start(&h);
        assert_near(body__part(s, 0).x[2], 0.005, 1e-15);
        helper_body_run(s, 0.08);
        double sunk = 0.03 * g / s->kinds[0].belt_law.stiffness;
        assert_near(body__part(s, 0).x[2], 0.005 - sunk, 1e-6 * sunk);
        micro__body.destroy(s);
    }
}

// Two of the four corners of a face carry an edge: half the stiffness. A body cannot balance on its
// edge, so the force is compared at a given depth.
static void an_edge_is_half_as_stiff_as_a_face(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.02, 0.02, 0.02));
    body_state *s = helper_body_start(&h);
    body_load load = { .torque = { 0.0, 0.0, 0.0 } };
    const double depth = 1e-5;
    helper_body_tilt(s, 0, along_y, M_PI / 6.0, -depth);
    body__add_belt_forces(s, 0, &load);
    assert_near(load.force.z, 0.5 * s->kinds[0].belt_law.stiffness * depth, 1e-3 * load.force.z);
    micro__body.destroy(s);
}

static void a_box_dropped_flat_comes_to_rest_flat_without_spin(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.04, 0.03, 0.02));
    h.poses[0].heading = 0.3;
    body_state *s = helper_body_start(&h);
    s->bodies[0].x.z += 0.005;
    helper_body_run(s, 0.15);
    micro_part part = body__part(s, 0);
    double sunk = 0.03 * g / s->kinds[0].belt_law.stiffness;
    assert_near(part.x[2], 0.01 - sunk, 1e-9);
    assert_near(part.x[0], 0.0, 1e-12);
    assert_near(part.x[1], 0.0, 1e-12);
    assert_near(part.heading, 0.3, 1e-12);
    assert_near(part.q[1], 0.0, 1e-12);
    assert_near(part.q[2], 0.0, 1e-12);
    assert_true(body__measure(s).kinetic_energy < 1e-15);
    micro__body.destroy(s);
}

// On a slope of angle a the law (7) lets a part creep until mu tanh(lambda v) = tan a.
static void below_the_angle_of_friction_a_box_holds_but_for_the_creep_of_the_law(void **state)
{
    helper_body h;
    const double slope = M_PI / 6.0, creep = atanh(tan(slope)) / 10.0;
    helper_body_init(&h, helper_body_box(0.04, 0.03, 0.01));
    body_state *s = helper_body_start(&h);
    s->gravity = (vec3){ g * sin(slope), 0.0, -g * cos(slope) };
    helper_body_run(s, 0.4);
    assert_near(body__part(s, 0).v[0], creep, 1e-5 * creep);
    assert_near(body__part(s, 0).x[2], 0.005, 1e-5);
    micro__body.destroy(s);
}

// Above it the part speeds up by g (sin a - mu cos a) once tanh is 1.
static void above_the_angle_of_friction_a_box_slides(void **state)
{
    helper_body h;
    const double slope = M_PI / 6.0, mu = 0.2;
    helper_body_init(&h, helper_body_box(0.04, 0.03, 0.01));
    h.def.contact[SCENE_CONVEYOR_CARGO].friction = mu;
    body_state *s = helper_body_start(&h);
    s->gravity = (vec3){ g * sin(slope), 0.0, -g * cos(slope) };
    helper_body_run(s, 0.3);
    double before = body__part(s, 0).v[0];
    helper_body_run(s, 0.1);
    assert_near(body__part(s, 0).v[0] - before, 0.1 * g * (sin(slope) - mu * cos(slope)), 1e-5);
    micro__body.destroy(s);
}

// It stands on its rim until its centre is above it: tan a = r / (h/2), 21.8 degrees.
static void a_tilted_cylinder_tips_over_the_edge_that_its_centre_is_beyond(void **state)
{
    for (int is_beyond = 0; is_beyond <= 1; is_beyond++) {
        helper_body h;
        helper_body_init(&h, helper_body_cylinder(0.012, 0.06));
        body_state *s = helper_body_start(&h);
        helper_body_tilt(s, 0, along_y, (is_beyond ? 24.0 : 20.0) * M_PI / 180.0, 0.0);
        helper_body_run(s, 0.6);
        vec3 axis = mat3_column(&s->bodies[0].r, 2);
        assert_near(axis.z, is_beyond ? 0.0 : 1.0, 0.02);
        assert_near(axis.x, is_beyond ? 1.0 : 0.0, 0.02);
        assert_near(s->bodies[0].x.z, is_beyond ? 0.012 : 0.03, 1e-3);
        micro__body.destroy(s);
    }
}

// With dashpots from over-damped to a hundredth of that, in which case they bounce.
static void energy_never_grows_without_a_belt(void **state)
{
    bf_random random;
    random_init(&random, 5);
    for (int k = 0; k < 12; k++) {
        helper_body h;
        helper_body_init(&h, helper_body_box(0.03, 0.02, 0.01));
        h.def.contact[SCENE_CONVEYOR_CARGO].damping = k % 2 == 0 ? 230.0 : 2.3;
        helper_body_check_fall(&h, &random);
    }
}

// Only the error of the integrator changes the direction of L; the error halves with the step, and energy, taken
// at the end of the step, only falls.
static void a_free_body_conserves_its_angular_momentum_to_the_order_of_the_step(void **state)
{
    double error[2];
    for (int k = 0; k < 2; k++) {
        helper_body h;
        helper_body_init(&h, helper_body_box(0.05, 0.03, 0.01));
        h.def.dt = k == 0 ? 2e-5 : 1e-5;
        body_state *s = helper_body_start(&h);
        s->gravity = (vec3){ 0.0, 0.0, 0.0 };
        s->bodies[0].x.z = 0.5;
        s->bodies[0].w = (vec3){ 10.0, 20.0, 30.0 };
        vec3 before = helper_body_angular_momentum(s);
        double energy = helper_body_energy(s);
        for (int m = 0; m < 20; m++) {
            helper_body_run(s, 0.01);
            assert_true(helper_body_energy(s) <= energy * (1.0 + 1e-14));
            energy = helper_body_energy(s);
        }
        vec3 after = helper_body_angular_momentum(s);
        error[k] = vec3_length(vec3_sub(after, before)) / vec3_length(before);
        micro__body.destroy(s);
    }
    assert_true(error[0] < 1e-3);
    assert_near(error[0] / error[1], 2.0, 0.1);
}

static void a_free_pair_conserves_its_momentum(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.04, 0.03, 0.02));
    h.def.dt = 2e-6;
    helper_body_check_pair(&h, 1e-5);
}

// delta'' + (d/mu) delta' + (k/mu) delta = 0 with mu = m/2, delta = 0 and delta' = 2 v at the
// start: for two boxes face to face and for two cylinders side by side, until the force would become negative.
static void a_head_on_contact_is_a_damped_oscillator(void **state)
{
    for (int is_cylinder = 0; is_cylinder <= 1; is_cylinder++) {
        helper_body h;
        helper_body_init(&h, is_cylinder ? helper_body_cylinder(0.01, 0.02)
                                         : helper_body_box(0.02, 0.03, 0.02));
        h.def.n_parts = 2;
        h.def.dt = 2e-7;
        h.poses[0].x = -0.01;
        h.poses[1].x = 0.01;
        body_state *s = helper_body_start(&h);
        s->gravity = (vec3){ 0.0, 0.0, 0.0 };
        s->bodies[0].x.z = s->bodies[1].x.z = 0.5;
        s->bodies[0].v.x = 0.1;
        s->bodies[1].v.x = -0.1;
        double mu = 0.015, k = body__law(s, &s->kinds[0], &s->kinds[0]).stiffness;
        double c = 119.0 / (2.0 * mu), root = sqrt(c * c - k / mu), t = 5e-4;
        helper_body_run(s, t);
        double delta = 0.02 - (s->bodies[1].x.x - s->bodies[0].x.x);
        double exact = 0.2 / (2.0 * root) * (exp((root - c) * t) - exp((-root - c) * t));
        assert_near(delta, exact, 3e-3 * exact);
        micro__body.destroy(s);
    }
}

// I w' = -mu r_spin m g tanh(w), solved by sinh w = sinh(w_0) exp(-mu r_spin m g t / I).
static void spin_on_the_plane_decays_by_its_law(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_cylinder(0.012, 0.008));
    h.def.dt = 1e-6;
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.04);
    s->bodies[0].w.z = 3.0;
    helper_body_run(s, 2e-3);
    double rate = 0.008 * g / (0.5 * 0.012 * 0.012);
    assert_near(s->bodies[0].w.z, asinh(sinh(3.0) * exp(-rate * 2e-3)), 5e-3);
    micro__body.destroy(s);
}

static void theta_is_tanh_by_its_argument(void **state)
{
    assert_true(friction_secant(1.0, 1.0, 1.0, 0.0) == 1.0);
    for (double z = 1e-8; z < 1e3; z *= 1.01)
        assert_near(friction_secant(1.0, 1.0, 1.0, z), tanh(z) / z, 1e-12 * tanh(z) / z);
}

// v' = mu g tanh(lambda (v_T - v)), solved by sinh(lambda u) = sinh(lambda v_T) exp(-mu g lambda
// t).
static void a_belt_takes_a_part_up_by_its_law(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.06, 0.05, 0.004));
    h.def.n_belts = 1;
    body_state *s = helper_body_start(&h);
    assert_near(s->bodies[0].v.x, 0.395, 0.0);
    helper_body_run(s, 0.04);
    assert_near(s->bodies[0].v.x, 0.395, 1e-9);
    s->bodies[0].v.x = 0.0;
    helper_body_run(s, 0.03);
    double slip = asinh(sinh(3.95) * exp(-g * 10.0 * 0.03)) / 10.0;
    assert_near(0.395 - s->bodies[0].v.x, slip, 2e-3 * 0.395);
    micro__body.destroy(s);
}

// The two halves are on belts with opposite velocities.
static void a_box_across_two_belts_turns_on_the_spot(void **state)
{
    vec2 half[2][4] = { { { -1.0, 0.0 }, { 1.0, 0.0 }, { 1.0, 1.0 }, { -1.0, 1.0 } },
                        { { -1.0, -1.0 }, { 1.0, -1.0 }, { 1.0, 0.0 }, { -1.0, 0.0 } } };
    helper_body h;
    helper_body_init(&h, helper_body_box(0.06, 0.06, 0.01));
    h.def.n_belts = 2;
    for (int k = 0; k < 2; k++) {
        h.belts[k].n_points = 4;
        h.belts[k].polygon = half[k];
        h.belts[k].velocity = (vec2){ k == 0 ? 0.4 : -0.4, 0.0 };
    }
    h.kinds[0].spin_radius = 0.0;
    body_state *s = helper_body_start(&h);
    s->bodies[0].v.x = 0.0;
    helper_body_run(s, 0.05);
    assert_true(s->bodies[0].w.z < -1.0);
    assert_near(s->bodies[0].v.x, 0.0, 1e-6);
    micro__body.destroy(s);
}

// The belt exerts F = mu m g tanh(lambda |u|) u/|u|, u = v_T - v t; the plate exerts the normal force F.n
// and the friction mu_p (F.n) tanh(lambda v): the speed along it is the one at which F.t equals that.
static double sliding_speed(double angle)
{
    double low = 0.0, high = 0.395;

    for (int k = 0; k < 60; k++) {
        double v = 0.5 * (low + high);
        double ux = 0.395 - v * cos(angle), uy = -v * sin(angle), u = hypot(ux, uy);
        double belt_friction = tanh(10.0 * u) * (ux * cos(angle) + uy * sin(angle)) / u;
        double normal_force = tanh(10.0 * u) * (ux * sin(angle) - uy * cos(angle)) / u;
        if (belt_friction > 0.19 * normal_force * tanh(10.0 * v))
            low = v;
        else
            high = v;
    }
    return low;
}

static void a_box_slides_along_a_plate_with_the_speed_of_the_laws(void **state)
{
    const double angle = M_PI / 3.0;
    helper_body h;
    helper_body_init(&h, helper_body_box(0.04, 0.04, 0.006));
    h.def.n_belts = h.def.n_obstacles = 1;
    h.path[0] = (vec2){ -0.5 * cos(angle), -0.5 * sin(angle) };
    h.path[1] = (vec2){ 0.5 * cos(angle), 0.5 * sin(angle) };
    h.poses[0] = (scene_pose){ -0.03 * sin(angle) - 0.3 * cos(angle),
                               0.03 * cos(angle) - 0.3 * sin(angle), angle };
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 1.0);
    vec3 t = { cos(angle), sin(angle), 0.0 };
    assert_near(vec3_dot(s->bodies[0].v, t), sliding_speed(angle), 1e-3);
    assert_near(body__part(s, 0).heading, angle, 2e-3);
    micro__body.destroy(s);
}

static void nothing_passes_a_thin_plate_or_a_wall(void **state)
{
    const scene_shape shapes[] = { helper_body_box(0.03, 0.02, 0.015),
                                   helper_body_cylinder(0.012, 0.008) };
    for (int k = 0; k < 4; k++) {
        helper_body h;
        helper_body_init(&h, shapes[k % 2]);
        helper_body_check_barrier(&h, k >= 2);
    }
}

// At the end of a plate the normal is the direction of least depth.
static void a_box_is_turned_by_the_end_of_a_plate(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.04, 0.04, 0.02));
    h.def.n_belts = h.def.n_obstacles = 1;
    h.path[0] = (vec2){ 0.05, -0.2 };
    h.path[1] = (vec2){ 0.05, -0.012 };
    h.kinds[0].spin_radius = 0.0;
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.2);
    // Held back below its centre, on the right: it turns clockwise and gets past.
    assert_true(body__part(s, 0).heading < -0.1);
    assert_true(s->bodies[0].x.y > 0.0);
    assert_true(body__measure(s).largest_overlap < 5e-4);
    micro__body.destroy(s);
}

static void a_part_that_leaves_over_an_open_edge_is_gone(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.04, 0.04, 0.02));
    h.def.n_belts = 1;
    h.def.domain.x_max = 0.01;
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.025);
    assert_false(body__part(s, 0).is_gone);
    helper_body_run(s, 0.0005);
    micro_part part = body__part(s, 0);
    assert_true(part.is_gone);
    assert_int_equal(body__measure(s).n_parts, 0);
    helper_body_run(s, 0.01);
    assert_near(body__part(s, 0).x[0], part.x[0], 0.0);
    micro__body.destroy(s);
}

// A tetrahedron has its centre of mass at a quarter of its height, and lies on its face.
static void a_hull_is_placed_by_its_origin_and_reported_by_its_centre_of_mass(void **state)
{
    double points[4][3] = {
        { 0.0, 0.0, 0.1 }, { 0.04, 0.0, 0.1 }, { 0.0, 0.04, 0.1 }, { 0.0, 0.0, 0.14 }
    };
    helper_body h;
    helper_body_init(&h, (scene_shape){ .type = SCENE_HULL, .n_vertices = 4, .vertices = points });
    h.poses[0] = (scene_pose){ 0.2, 0.3, M_PI / 2.0 };
    body_state *s = helper_body_start(&h);
    micro_part part = body__part(s, 0);
    assert_near(part.x[0], 0.2 - 0.01, 1e-12);
    assert_near(part.x[1], 0.3 + 0.01, 1e-12);
    assert_near(part.x[2], 0.01, 1e-12);
    assert_near(part.heading, M_PI / 2.0, 1e-12);
    assert_near(part.q[0], M_SQRT1_2, 1e-12);
    assert_near(part.q[3], M_SQRT1_2, 1e-12);
    micro__body.destroy(s);
}

// One on top of the other, both flat: the contact below carries two weights, the one between them one.
static void boxes_and_cylinders_stack(void **state)
{
    for (int is_cylinder = 0; is_cylinder <= 1; is_cylinder++) {
        helper_body h;
        helper_body_init(&h, is_cylinder ? helper_body_cylinder(0.02, 0.01)
                                         : helper_body_box(0.04, 0.04, 0.01));
        h.def.n_parts = 2;
        body_state *s = helper_body_start(&h);
        s->bodies[1].x.z = 0.0151;
        helper_body_run(s, 0.2);
        double weight = 0.03 * g, k = s->kinds[0].belt_law.stiffness;
        double between = body__law(s, &s->kinds[0], &s->kinds[0]).stiffness;
        assert_near(s->bodies[0].x.z, 0.005 - 2.0 * weight / k, 1e-7);
        assert_near(s->bodies[1].x.z, 0.015 - 2.0 * weight / k - weight / between, 1e-7);
        micro__body.destroy(s);
    }
}

static void a_cylinder_on_its_side_rolls_without_sliding(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_cylinder(0.02, 0.03));
    body_state *s = helper_body_start(&h);
    helper_body_tilt(s, 0, along_x, M_PI / 2.0, 0.0);
    s->bodies[0].v.x = 0.3;
    helper_body_run(s, 0.5);
    // Sliding friction turns a third of the momentum into spin: I = m r^2 / 2.
    assert_near(s->bodies[0].v.x, 0.2, 2e-3);
    assert_near(s->bodies[0].w.y, 0.2 / 0.02, 0.2);
    assert_near(s->bodies[0].x.z, 0.02, 1e-4);
    micro__body.destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_that_lies_flat_sinks_by_its_weight_over_the_stiffness),
        cmocka_unit_test(an_edge_is_half_as_stiff_as_a_face),
        cmocka_unit_test(a_box_dropped_flat_comes_to_rest_flat_without_spin),
        cmocka_unit_test(below_the_angle_of_friction_a_box_holds_but_for_the_creep_of_the_law),
        cmocka_unit_test(above_the_angle_of_friction_a_box_slides),
        cmocka_unit_test(a_tilted_cylinder_tips_over_the_edge_that_its_centre_is_beyond),
        cmocka_unit_test(energy_never_grows_without_a_belt),
        cmocka_unit_test(a_free_body_conserves_its_angular_momentum_to_the_order_of_the_step),
        cmocka_unit_test(a_free_pair_conserves_its_momentum),
        cmocka_unit_test(a_head_on_contact_is_a_damped_oscillator),
        cmocka_unit_test(spin_on_the_plane_decays_by_its_law),
        cmocka_unit_test(theta_is_tanh_by_its_argument),
        cmocka_unit_test(a_belt_takes_a_part_up_by_its_law),
        cmocka_unit_test(a_box_across_two_belts_turns_on_the_spot),
        cmocka_unit_test(a_box_slides_along_a_plate_with_the_speed_of_the_laws),
        cmocka_unit_test(nothing_passes_a_thin_plate_or_a_wall),
        cmocka_unit_test(a_box_is_turned_by_the_end_of_a_plate),
        cmocka_unit_test(a_part_that_leaves_over_an_open_edge_is_gone),
        cmocka_unit_test(a_hull_is_placed_by_its_origin_and_reported_by_its_centre_of_mass),
        cmocka_unit_test(boxes_and_cylinders_stack),
        cmocka_unit_test(a_cylinder_on_its_side_rolls_without_sliding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
