// Implicit steps in space against the closed forms of mechanics, the planar path and explicit steps.

#include "tests/unit/core/helper_body.h"
#include "tests/unit/core/helper_hull.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const double g = 9.81, speed = 0.395; // m/s2, m/s
static const double mass = 0.03;             // kg
static const vec3 along_y = { 0.0, 1.0, 0.0 };

static void begin(helper_body *h, scene_shape shape, double dt)
{
    helper_body_init(h, shape);
    h->def.integrator = MICRO_IMPLICIT;
    h->def.dt = dt;
}

// The weight m g equals k delta; the kinetic energy is that of the belt's speed, up to rounding.
static void a_part_rests_flat_on_the_belt_and_goes_with_it(void **state)
{
    const scene_shape shapes[] = { helper_body_box(0.04, 0.03, 0.02),
                                   helper_body_cylinder(0.012, 0.008) };
    for (int k = 0; k < 2; k++) {
        helper_body h;
        begin(&h, shapes[k], 1e-3);
        h.def.n_belts = 1;
        h.poses[0].heading = 0.3;
        body_state *s = helper_body_start(&h);
        double half = s->bodies[0].x.z, sunk = mass * g / s->kinds[0].belt_law.stiffness;
        helper_body_run(s, 0.5);
        for (int m = 0; m < 20; m++) {
            helper_body_run(s, 0.05);
            micro_part part = body__part(s, 0);
            assert_near(part.x[2], half - sunk, 1e-9);
            assert_near(part.x[0], speed * (0.5 + 0.05 * (m + 1)), 1e-9);
            assert_near(part.x[1], 0.0, 1e-12);
            assert_near(part.heading, 0.3, 1e-9);
            assert_near(hypot(part.q[1], part.q[2]), 0.0, 1e-9);
            assert_near(body__measure(s).kinetic_energy / (0.5 * mass * speed * speed), 1.0, 1e-9);
        }
        micro__body.destroy(s);
    }
}

static body_state *slide(helper_body *h, double slope, double friction, double dt)
{
    begin(h, helper_body_box(0.04, 0.03, 0.01), dt);
    h->def.contact[SCENE_CONVEYOR_CARGO].friction = friction;
    body_state *s = helper_body_start(h);
    s->gravity = (vec3){ g * sin(slope), 0.0, -g * cos(slope) };
    return s;
}

// On a slope of angle a the law (7) lets a part creep until mu tanh(lambda v) = tan a.
static void below_the_angle_of_friction_a_box_holds_but_for_the_creep_of_the_law(void **state)
{
    helper_body h;
    const double slope = M_PI / 6.0, creep = atanh(tan(slope)) / 10.0;
    body_state *s = slide(&h, slope, 1.0, 2e-3);
    helper_body_run(s, 0.6);
    assert_near(s->bodies[0].v.x, creep, 1e-5 * creep);
    assert_near(s->bodies[0].x.z, 0.005, 1e-5);
    assert_near(vec3_length(s->bodies[0].w), 0.0, 1e-6);
    micro__body.destroy(s);
}

// Above it the part speeds up by g (sin a - mu cos a) once tanh is 1.
static void above_the_angle_of_friction_a_box_slides(void **state)
{
    helper_body h;
    const double slope = M_PI / 6.0, mu = 0.2;
    body_state *s = slide(&h, slope, mu, 2e-3);
    helper_body_run(s, 0.3);
    double before = s->bodies[0].v.x;
    helper_body_run(s, 0.1);
    assert_near(s->bodies[0].v.x - before, 0.1 * g * (sin(slope) - mu * cos(slope)), 1e-5);
    micro__body.destroy(s);
}

// v' = mu g tanh(lambda (v_T - v)): sinh(lambda u) = sinh(lambda v_T) exp(-mu g lambda t).
static void a_belt_takes_a_part_up_by_its_law_with_order_1(void **state)
{
    const double exact = asinh(sinh(10.0 * speed) * exp(-g * 10.0 * 0.03)) / 10.0;
    double coarser = 0.0;
    for (double dt = 1e-3; dt > 0.2e-3; dt *= 0.5) {
        helper_body h;
        begin(&h, helper_body_box(0.06, 0.05, 0.004), dt);
        h.def.n_belts = 1;
        body_state *s = helper_body_start(&h);
        helper_body_run(s, 0.2);
        s->bodies[0].v.x = 0.0;
        helper_body_run(s, 0.03);
        double error = fabs(speed - s->bodies[0].v.x - exact);
        assert_true(error < 0.02 * speed);
        assert_true(coarser == 0.0 || (coarser / error > 1.7 && coarser / error < 2.3));
        coarser = error;
        micro__body.destroy(s);
    }
}

/// Overlap after time t of two parts that collide head-on, face to face, with 2 x 0.1 m/s.
static double overlap_after(scene_shape shape, double damping, double dt, double t,
                            double *ret_stiffness)
{
    helper_body h;

    begin(&h, shape, dt);
    h.def.n_parts = 2;
    h.def.tension = true; // so that the equation is linear
    h.def.contact[SCENE_CARGO_CARGO].damping = damping;
    h.poses[0].x = -0.01;
    h.poses[1].x = 0.01;
    body_state *s = helper_body_start(&h);
    s->gravity = (vec3){ 0.0, 0.0, 0.0 };
    s->bodies[0].x.z = s->bodies[1].x.z = 0.5;
    s->bodies[0].v.x = 0.1;
    s->bodies[1].v.x = -0.1;
    helper_body_run(s, t);
    double overlap = 0.02 - (s->bodies[1].x.x - s->bodies[0].x.x);
    *ret_stiffness = body__law(s, &s->kinds[0], &s->kinds[0]).stiffness;
    micro__body.destroy(s);
    return overlap;
}

// (m/2) delta'' + d delta' + k delta = 0, delta = 0 and delta' = 2 v at the start.
static double exact_overlap(double damping, double stiffness, double t)
{
    double gamma = damping / mass, square = gamma * gamma - 2.0 * stiffness / mass;
    double beta = sqrt(fabs(square)), wave = square > 0.0 ? sinh(beta * t) : sin(beta * t);

    return 0.2 * exp(-gamma * t) * wave / beta;
}

static void check_order(scene_shape shape, double damping, double t)
{
    double coarser = 0.0, stiffness;

    for (double dt = 4e-5; dt > 0.9e-5; dt *= 0.5) {
        double overlap = overlap_after(shape, damping, dt, t, &stiffness);
        double exact = exact_overlap(damping, stiffness, t), error = fabs(overlap - exact);
        assert_true(error < 0.15 * exact);
        assert_true(coarser == 0.0 || (coarser / error > 1.75 && coarser / error < 2.25));
        coarser = error;
    }
}

static void a_head_on_contact_nears_the_damped_oscillator_with_order_1(void **state)
{
    const scene_shape shapes[] = { helper_body_box(0.02, 0.03, 0.02),
                                   helper_body_cylinder(0.01, 0.02) };
    for (int k = 0; k < 2; k++) {
        check_order(shapes[k], 119.0, 4e-4); // over-damped: m/2d = 0.13 ms
        check_order(shapes[k], 1.0, 8e-4);   // under-damped: a quarter of the period is 0.7 ms
    }
}

// With m/2d = 0.13 ms a step of 2 ms spans the impact; the remaining overlap decays with d/k.
static void a_step_far_longer_than_the_impact_gives_the_overlap_after_it(void **state)
{
    const scene_shape shapes[] = { helper_body_box(0.02, 0.03, 0.02),
                                   helper_body_cylinder(0.01, 0.02) };
    for (int k = 0; k < 2; k++) {
        double stiffness, overlap = overlap_after(shapes[k], 1190.0, 1e-3, 0.01, &stiffness);
        assert_near(overlap / exact_overlap(1190.0, stiffness, 0.01), 1.0, 0.05);
    }
}

// It stands on its rim until its centre is above it: tan a = r / (h/2), 21.8 degrees.
static void a_tilted_cylinder_tips_over_the_edge_that_its_centre_is_beyond(void **state)
{
    for (int is_beyond = 0; is_beyond <= 1; is_beyond++) {
        helper_body h;
        begin(&h, helper_body_cylinder(0.012, 0.06), 1e-3);
        body_state *s = helper_body_start(&h);
        helper_body_tilt(s, 0, along_y, (is_beyond ? 24.0 : 20.0) * M_PI / 180.0, 0.0);
        helper_body_run(s, 0.8);
        vec3 axis = mat3_column(&s->bodies[0].r, 2);
        assert_near(axis.z, is_beyond ? 0.0 : 1.0, 0.02);
        assert_near(axis.x, is_beyond ? 1.0 : 0.0, 0.02);
        assert_near(s->bodies[0].x.z, is_beyond ? 0.012 : 0.03, 1e-3);
        micro__body.destroy(s);
    }
}

static void energy_never_grows_without_a_belt(void **state)
{
    const double steps[] = { 2e-4, 5e-4, 1e-3 };
    bf_random random;
    random_init(&random, 5);
    for (int k = 0; k < HELPER_AMOUNT(12, 3); k++) {
        helper_body h;
        begin(&h, helper_body_box(0.03, 0.02, 0.01), steps[k % 3]);
        helper_body_check_fall(&h, &random);
    }
}

/// Two groups of boxes that collide at a small angle, high above the belt.
static body_state *make_groups(helper_body *h, double dt)
{
    begin(h, helper_body_box(0.022, 0.018, 0.02), dt);
    h->def.gravity = 0.0;
    h->def.n_parts = 32;
    for (size_t k = 0; k < 32; k++) {
        double side = k % 2 == 0 ? 1.0 : -1.0, row = (double)(k / 8), column = (double)(k / 2 % 4);
        h->poses[k] = (scene_pose){ side * (0.018 + 0.03 * column), 0.032 * row + 0.004 * side,
                                    0.1 * (double)k };
    }
    body_state *s = helper_body_start(h);
    for (size_t k = 0; k < 32; k++) {
        s->bodies[k].x.z = 0.5 + 0.001 * (double)(k % 5);
        s->bodies[k].v.x = k % 2 == 0 ? -speed : speed;
    }
    return s;
}

static void free_jams_lose_energy_and_conserve_their_momentum(void **state)
{
    const double steps[] = { 2e-4, 1e-3, 2e-3 };
    for (int k = 0; k < 3; k++) {
        helper_body h;
        body_state *s = make_groups(&h, steps[k]);
        vec3 before = helper_body_momentum(s);
        double energy = body__measure(s).kinetic_energy, start = energy;
        for (int m = 0; m < 100; m++) {
            helper_body_run(s, 2e-3);
            assert_true(body__measure(s).kinetic_energy <= start);
        }
        energy = body__measure(s).kinetic_energy;
        assert_true(energy < 0.7 * start);
        vec3 change = vec3_sub(helper_body_momentum(s), before);
        assert_true(vec3_length(change) < 1e-12 * 32.0 * mass * speed);
        micro__body.destroy(s);
    }
}

static void a_free_pair_conserves_its_momentum(void **state)
{
    helper_body h;
    begin(&h, helper_body_box(0.04, 0.03, 0.02), 2e-4);
    helper_body_check_pair(&h, 2e-3);
}

static void nothing_passes_a_thin_plate_or_a_wall(void **state)
{
    const scene_shape shapes[] = { helper_body_box(0.03, 0.02, 0.015),
                                   helper_body_cylinder(0.012, 0.008) };
    for (int k = 0; k < 4; k++) {
        helper_body h;
        begin(&h, shapes[k % 2], 2e-3);
        helper_body_check_barrier(&h, k >= 2);
    }
}

// One on top of the other, both flat: the contact below carries two weights, the one between them one.
static void boxes_and_cylinders_stack(void **state)
{
    for (int is_cylinder = 0; is_cylinder <= 1; is_cylinder++) {
        helper_body h;
        begin(&h,
              is_cylinder ? helper_body_cylinder(0.02, 0.01) : helper_body_box(0.04, 0.04, 0.01),
              1e-3);
        h.def.n_parts = 2;
        body_state *s = helper_body_start(&h);
        s->bodies[1].x.z = 0.0151;
        helper_body_run(s, 0.4);
        double weight = mass * g, k = s->kinds[0].belt_law.stiffness;
        double between = body__law(s, &s->kinds[0], &s->kinds[0]).stiffness;
        assert_near(s->bodies[0].x.z, 0.005 - 2.0 * weight / k, 1e-7);
        assert_near(s->bodies[1].x.z, 0.015 - 2.0 * weight / k - weight / between, 1e-7);
        micro__body.destroy(s);
    }
}

// The mean over time of the difference of U(t) stays below 1 % of N.
static void upright_cylinders_do_as_on_the_planar_path(void **state)
{
    enum { SAMPLES = HELPER_AMOUNT(70, 20) };
    const double steps[] = { 2e-4, 5e-4, 1e-3 };
    for (int k = 0; k < HELPER_AMOUNT(3, 1); k++) {
        helper_body h;
        double planar[SAMPLES], spatial[SAMPLES];
        helper_body_passage(&h, helper_body_cylinder(0.012, 0.008));
        h.def.integrator = MICRO_IMPLICIT;
        h.def.dt = steps[k];
        h.def.path = MICRO_PATH_PLANAR;
        helper_body_curve(&h.def, 1e-2, SAMPLES, planar);
        h.def.path = MICRO_PATH_SPATIAL;
        helper_body_curve(&h.def, 1e-2, SAMPLES, spatial);
        assert_true(HELPER_AMOUNT_IS_LESS || planar[SAMPLES - 1] < 0.8 * (double)h.def.n_parts);
        assert_true(helper_body_gap(planar, spatial, SAMPLES) < 0.01 * (double)h.def.n_parts);
    }
}

static void boxes_do_as_with_explicit_steps(void **state)
{
    enum { SAMPLES = HELPER_AMOUNT(70, 20) };
    helper_body h;
    double explicit[SAMPLES], implicit[SAMPLES];
    helper_body_passage(&h, helper_body_box(0.02, 0.02, 0.012));
    h.def.dt = 2e-5;
    helper_body_curve(&h.def, 1e-2, SAMPLES, explicit);
    assert_true(HELPER_AMOUNT_IS_LESS || explicit[SAMPLES - 1] < 0.9 * (double)h.def.n_parts);
    h.def.integrator = MICRO_IMPLICIT;
    for (double dt = 2e-4; dt < 1.1e-3; dt *= 5.0) {
        h.def.dt = dt;
        helper_body_curve(&h.def, 1e-2, SAMPLES, implicit);
        assert_true(helper_body_gap(explicit, implicit, SAMPLES) < 0.01 * (double)h.def.n_parts);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_rests_flat_on_the_belt_and_goes_with_it),
        cmocka_unit_test(below_the_angle_of_friction_a_box_holds_but_for_the_creep_of_the_law),
        cmocka_unit_test(above_the_angle_of_friction_a_box_slides),
        cmocka_unit_test(a_belt_takes_a_part_up_by_its_law_with_order_1),
        cmocka_unit_test(a_head_on_contact_nears_the_damped_oscillator_with_order_1),
        cmocka_unit_test(a_step_far_longer_than_the_impact_gives_the_overlap_after_it),
        cmocka_unit_test(a_tilted_cylinder_tips_over_the_edge_that_its_centre_is_beyond),
        cmocka_unit_test(energy_never_grows_without_a_belt),
        cmocka_unit_test(free_jams_lose_energy_and_conserve_their_momentum),
        cmocka_unit_test(a_free_pair_conserves_its_momentum),
        cmocka_unit_test(nothing_passes_a_thin_plate_or_a_wall),
        cmocka_unit_test(boxes_and_cylinders_stack),
        cmocka_unit_test(upright_cylinders_do_as_on_the_planar_path),
        cmocka_unit_test(boxes_do_as_with_explicit_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
