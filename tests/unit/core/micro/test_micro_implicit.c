// Implicit steps against closed forms and against the paper's explicit method.

#include "core/micro/contact_law.h"
#include "core/micro/micro.h"
#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_outflow.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WORLD_PARTS = 128, EXPLICIT_RUNS = HELPER_AMOUNT(2, 1) };

static const double example_time = HELPER_AMOUNT(6.0, 0.6);        // s
static const double radius = 0.012, mass = 0.02841, speed = 0.395; // m, kg, m/s

// Cylinders in a domain of 2 m x 2 m that is open all around, on two belts: west of x = 1 with
// `speed` to the east, east of it with another velocity. No air.
typedef struct world {
    micro_def def;
    scene_belt belts[2];
    vec2 west[4], east[4];
    scene_obstacle obstacle;
    vec2 path[2];
    micro_kind kind;
    scene_pose poses[WORLD_PARTS];
} world;

static void set_belt(scene_belt *belt, vec2 *corners, double x_min, double x_max, double v)
{
    corners[0] = (vec2){ x_min, 0.0 };
    corners[1] = (vec2){ x_max, 0.0 };
    corners[2] = (vec2){ x_max, 2.0 };
    corners[3] = (vec2){ x_min, 2.0 };
    *belt = (scene_belt){ .velocity = { v, 0.0 }, .n_points = 4, .polygon = corners };
}

static world *make_world(double v_east)
{
    world *w = calloc(1, sizeof *w);

    assert_non_null(w);
    w->def = micro_def_default();
    w->def.integrator = MICRO_IMPLICIT;
    w->def.domain = (scene_rect){ 0.0, 2.0, 0.0, 2.0 };
    for (int k = 0; k < SCENE_SIDE_COUNT; k++)
        w->def.edges[k] = SCENE_EDGE_OUTFLOW;
    set_belt(&w->belts[0], w->west, 0.0, 1.0, speed);
    set_belt(&w->belts[1], w->east, 1.0, 2.0, v_east);
    w->kind.shape = (scene_shape){ .type = SCENE_CYLINDER, .radius = radius, .height = 0.008 };
    w->kind.material = (scene_material){ 210e9, 0.28 };
    w->kind.mass = mass;
    w->kind.spin_radius = 0.008;
    w->def.n_belts = 2;
    w->def.belts = w->belts;
    w->def.n_kinds = 1;
    w->def.kinds = &w->kind;
    w->def.poses = w->poses;
    w->def.damping = 0.0;
    return w;
}

static void add_part(world *w, double x, double y)
{
    assert_true(w->def.n_parts < WORLD_PARTS);
    w->poses[w->def.n_parts++] = (scene_pose){ x, y, 0.0 };
}

static double stiffness_between_parts(const world *w)
{
    return contact_law_of_line(&w->def.contact[SCENE_CARGO_CARGO], &w->kind.material,
                               &w->kind.material, w->def.modulus_reduction)
        .stiffness;
}

static double stiffness_at_walls(const world *w)
{
    return contact_law_of_line(&w->def.contact[SCENE_HANDLING_CARGO], &w->kind.material,
                               &w->def.handling, w->def.modulus_reduction)
        .stiffness;
}

// Mean curve of explicit runs from starts that differ by a micrometre: contacts are chaotic, and one
// run alone may stray from the others by 1 % of N.
static void average_explicit(helper_outflow *e, double *ret_u)
{
    double u[HELPER_OUTFLOW_SAMPLES];

    memset(ret_u, 0, sizeof u);
    e->def.integrator = MICRO_VERLET;
    e->def.dt = 2e-5;
    for (int run = 0; run < EXPLICIT_RUNS; run++) {
        for (int k = 0; k < HELPER_OUTFLOW_PARTS; k++)
            e->poses[k].y += 1e-6 * run * ((7 * k + 3 * run) % 5 - 2) / 5.0;
        helper_outflow_curve(&e->def, example_time, u);
        for (int k = 0; k < HELPER_OUTFLOW_SAMPLES; k++)
            ret_u[k] += u[k] / EXPLICIT_RUNS;
    }
}

// An Example's curve with the step that is chosen and with given ones, from 0.2 to 2 ms.
static void check_example(double angle_deg, double modulus_reduction)
{
    const double steps[] = { 0.0, 2e-4, 2e-3 };
    double expected[HELPER_OUTFLOW_SAMPLES], u[HELPER_OUTFLOW_SAMPLES];
    helper_outflow *e = malloc(sizeof *e);

    assert_non_null(e);
    helper_outflow_example(e, angle_deg, modulus_reduction);
    average_explicit(e, expected);
    helper_outflow_example(e, angle_deg, modulus_reduction);
    e->def.integrator = MICRO_IMPLICIT;
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        e->def.dt = steps[k];
        helper_outflow_curve(&e->def, example_time, u);
        if (helper_outflow_gap(u, expected) > 0.01)
            fail_msg("%g deg, reduction %g, step %g s: %.2f %% of the parts", angle_deg,
                     modulus_reduction, steps[k], 100.0 * helper_outflow_gap(u, expected));
    }
    free(e);
}

static void outflow_of_example_1_is_that_of_explicit_steps(void **state)
{
    check_example(60.0, 1e6);
    check_example(60.0, 1e4);
}

static void outflow_of_example_2_is_that_of_explicit_steps(void **state)
{
    check_example(90.0, 1e6);
    check_example(90.0, 1e4);
}

// Overlap of two parts that collide head-on with 2 `speed`, after time t.
static double overlap_after(double damping, double dt, double t)
{
    world *w = make_world(-speed);

    w->def.gravity = 0.0;
    w->def.tension = true; // so that the equation is linear
    w->def.contact[SCENE_CARGO_CARGO].damping = damping;
    w->def.dt = dt;
    add_part(w, 1.0 - radius, 1.0);
    add_part(w, 1.0 + radius, 1.0);
    micro_solver *s = helper_micro_start(&w->def);
    helper_micro_advance_to(s, t);
    double overlap = 2.0 * radius - (micro_part_of(s, 1).x[0] - micro_part_of(s, 0).x[0]);
    micro_destroy(s);
    free(w);
    return overlap;
}

// The same by the equation of the damped oscillator, (m/2) delta'' + d delta' + k delta = 0.
static double exact_overlap(double damping, double t)
{
    world *w = make_world(-speed);
    double gamma = damping / mass, square = gamma * gamma - 2.0 * stiffness_between_parts(w) / mass;
    double beta = sqrt(fabs(square)), wave = square > 0.0 ? sinh(beta * t) : sin(beta * t);

    free(w);
    return 2.0 * speed * exp(-gamma * t) * wave / beta;
}

static void check_order(double damping, double t)
{
    double exact = exact_overlap(damping, t), coarser = 0.0;

    for (double dt = 4e-5; dt > 0.9e-5; dt *= 0.5) {
        double error = fabs(overlap_after(damping, dt, t) - exact);
        assert_true(error < 0.1 * exact);
        assert_true(coarser == 0.0 || (coarser / error > 1.8 && coarser / error < 2.2));
        coarser = error;
    }
}

static void a_head_on_contact_nears_the_damped_oscillator_with_order_1(void **state)
{
    check_order(119.0, 4e-4); // over-damped: m/2d = 0.12 ms
    check_order(1.0, 4e-3);   // under-damped: a quarter of the period is 7 ms
}

static void a_step_far_longer_than_the_impact_gives_the_overlap_after_it(void **state)
{
    // What is left after the impact decays with d/k = 0.17 s, of which 2 ms are little.
    assert_near(overlap_after(119.0, 2e-3, 0.02) / exact_overlap(119.0, 0.02), 1.0, 0.02);
}

static void a_part_rests_at_a_wall_where_contact_and_belt_forces_balance(void **state)
{
    world *w = make_world(speed);

    w->def.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    w->def.dt = 2e-3;
    add_part(w, 2.0 - radius - 0.01, 1.0);
    micro_solver *s = helper_micro_start(&w->def);
    helper_micro_advance_to(s, 8.0); // 25 times d/k
    micro_part part = micro_part_of(s, 0);
    // k delta = mu m g tanh(lambda v), of which the solver's tanh is good to 2e-4.
    double overlap = part.x[0] + radius - 2.0;
    double expected = mass * 9.81 * tanh(10.0 * speed) / stiffness_at_walls(w);
    assert_near(overlap / expected, 1.0, 3e-4);
    assert_near(part.v[0], 0.0, 1e-9);
    micro_destroy(s);
    free(w);
}

static double sliding_speed(double angle_deg, micro_integrator integrator, double dt)
{
    const double angle = angle_deg * M_PI / 180.0;
    world *w = make_world(speed);

    w->def.integrator = integrator;
    w->def.dt = dt;
    w->path[0] = (vec2){ 0.2, 0.01 };
    w->path[1] = (vec2){ 0.2 + 1.5 * cos(angle), 0.01 + 1.5 * sin(angle) };
    w->obstacle = (scene_obstacle){ .n_points = 2, .path = w->path, .thickness = 0.005 };
    w->def.n_obstacles = 1;
    w->def.obstacles = &w->obstacle;
    // 0.2 m along the plate, a millimetre before its upstream face.
    double off = radius + 1e-3;
    add_part(w, 0.2 + 0.2 * cos(angle) - off * sin(angle), 0.21 * sin(angle) + off * cos(angle));
    micro_solver *s = helper_micro_start(&w->def);
    helper_micro_advance_to(s, 1.0);
    micro_part part = micro_part_of(s, 0);
    micro_destroy(s);
    free(w);
    return part.v[0] * cos(angle) + part.v[1] * sin(angle);
}

static void a_part_slides_along_an_obstacle_as_with_explicit_steps(void **state)
{
    const double angles[] = { 45.0, 60.0, 75.0 };

    for (size_t k = 0; k < 3; k++) {
        double expected = sliding_speed(angles[k], MICRO_VERLET, 1e-5);
        assert_true(expected > 0.04);
        assert_near(sliding_speed(angles[k], MICRO_IMPLICIT, 0.0) / expected, 1.0, 0.01);
    }
}

static void a_fast_part_does_not_pass_a_wall_in_the_largest_step(void **state)
{
    world *w = make_world(5.0);

    w->def.gravity = 0.0;
    w->def.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    w->def.dt = micro_dt_stable(&w->def);
    add_part(w, 1.5, 1.0);
    micro_solver *s = helper_micro_start(&w->def);
    helper_micro_advance_to(s, 0.3);
    // The dashpot alone would stop it within v m/d.
    double overlap = micro_measure(s).largest_overlap;
    assert_true(overlap > 0.0 && overlap <= 5.0 * mass / 120.0);
    assert_true(micro_part_of(s, 0).x[0] <= 2.0);
    micro_destroy(s);
    free(w);
}

// Two groups of parts that collide at a small angle.
static world *make_crowds(double dt)
{
    world *w = make_world(-speed);

    w->def.gravity = 0.0;
    w->def.dt = dt;
    for (int k = 0; k < 64; k++) {
        int row = k / 8, column = k % 8;
        add_part(w, 0.99 - 0.0245 * column - 0.003 * row, 0.9 + 0.0247 * row);
        add_part(w, 1.01 + 0.0247 * column, 0.91 + 0.0246 * row + 0.001 * column);
    }
    return w;
}

// Energy of motion and of overlaps.
static double energy_of(const world *w, const micro_solver *s)
{
    double energy = micro_measure(s).kinetic_energy, k = stiffness_between_parts(w);

    for (size_t i = 0; i < micro_parts(s); i++)
        for (size_t j = 0; j < i; j++) {
            micro_part a = micro_part_of(s, i), b = micro_part_of(s, j);
            double overlap = 2.0 * radius - hypot(a.x[0] - b.x[0], a.x[1] - b.x[1]);
            energy += overlap > 0.0 ? 0.5 * k * overlap * overlap : 0.0;
        }
    return energy;
}

static void energy_does_not_grow_without_the_belt(void **state)
{
    const double steps[] = { 2e-4, 1e-3, 2e-3, 5e-3 };

    for (size_t k = 0; k < 4; k++) {
        world *w = make_crowds(steps[k]);
        micro_solver *s = helper_micro_start(&w->def);
        double energy = energy_of(w, s), first = energy;
        while ((double)micro_steps(s) * steps[k] < 0.2) {
            assert_int_equal(micro_advance(s, 1, NULL), BF_OK);
            double next = energy_of(w, s);
            assert_true(next <= energy + 1e-12 * first);
            energy = next;
        }
        assert_true(energy < 0.5 * first);
        micro_destroy(s);
        free(w);
    }
}

// Sums of m v_x, m v_y and of the angular momentum about the origin.
static void sum_momenta(const micro_solver *s, double *ret_p)
{
    ret_p[0] = ret_p[1] = ret_p[2] = 0.0;
    for (size_t k = 0; k < micro_parts(s); k++) {
        micro_part part = micro_part_of(s, k);
        ret_p[0] += mass * part.v[0];
        ret_p[1] += mass * part.v[1];
        ret_p[2] += mass * (part.x[0] * part.v[1] - part.x[1] * part.v[0]) +
                    0.5 * mass * radius * radius * part.w[2];
    }
}

static void free_jams_conserve_their_momenta(void **state)
{
    double before[3], after[3];
    world *w = make_crowds(2e-3);

    micro_solver *s = helper_micro_start(&w->def);
    double energy = micro_measure(s).kinetic_energy;
    sum_momenta(s, before);
    helper_micro_advance_to(s, 0.2);
    assert_true(micro_measure(s).kinetic_energy < 0.5 * energy);
    sum_momenta(s, after);
    for (int k = 0; k < 3; k++)
        assert_near(after[k], before[k], 1e-12 * 128 * mass * speed);
    micro_destroy(s);
    free(w);
}

static double chosen_step(double v, double modulus_reduction)
{
    world *w = make_world(v);

    w->def.dt = 0.0;
    w->def.modulus_reduction = modulus_reduction;
    add_part(w, 0.5, 0.5);
    micro_solver *s = helper_micro_start(&w->def);
    double dt = micro_dt(s);
    assert_true(dt <= micro_dt_stable(&w->def));
    micro_destroy(s);
    free(w);
    return dt;
}

static void the_step_is_chosen_from_stiffness_speed_and_size(void **state)
{
    assert_near(chosen_step(speed, 1e6), 2e-3, 1e-12);
    assert_near(chosen_step(2.0, 1e6), 0.08 * radius / 2.0, 1e-12);
    // 16 iterations: 0.03 sqrt(N) 2 h^2 k/m + 0.8 h d/m = 16^2, N = 1, nearly without d here.
    double k = 1e6 / 1e1 * 716.0, h = 16.0 * sqrt(mass / (0.06 * k));
    assert_near(chosen_step(speed, 1e1), h, 0.02 * h);
}

static void a_step_beyond_the_largest_is_refused(void **state)
{
    world *w = make_world(speed);
    micro_solver *s = NULL;
    bf_error err;

    add_part(w, 0.5, 0.5);
    w->def.dt = 1.01 * micro_dt_stable(&w->def);
    assert_int_equal(micro_create(&w->def, &s, &err), BF_EINPUT);
    assert_null(s);
    assert_non_null(strstr(err.text, "largest"));
    free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outflow_of_example_1_is_that_of_explicit_steps),
        cmocka_unit_test(outflow_of_example_2_is_that_of_explicit_steps),
        cmocka_unit_test(a_head_on_contact_nears_the_damped_oscillator_with_order_1),
        cmocka_unit_test(a_step_far_longer_than_the_impact_gives_the_overlap_after_it),
        cmocka_unit_test(a_part_rests_at_a_wall_where_contact_and_belt_forces_balance),
        cmocka_unit_test(a_part_slides_along_an_obstacle_as_with_explicit_steps),
        cmocka_unit_test(a_fast_part_does_not_pass_a_wall_in_the_largest_step),
        cmocka_unit_test(energy_does_not_grow_without_the_belt),
        cmocka_unit_test(free_jams_conserve_their_momenta),
        cmocka_unit_test(the_step_is_chosen_from_stiffness_speed_and_size),
        cmocka_unit_test(a_step_beyond_the_largest_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
