// Disks on belts against closed forms. Velocities that a part does not get from its belt at the start
// are put into the solver's own rows.

#include "tests/unit/core/helper_disk_state.h"
#include "tests/unit/core/helper_disks.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

static const double radius = 0.012, gravity = 9.81;

// s' = -mu g tanh(lambda s) has the solution sinh(lambda s) = sinh(lambda s0) e^(-mu g lambda t).
static double exact_slip(double lambda, double rate, double s0, double t)
{
    return asinh(sinh(lambda * s0) * exp(-rate * lambda * t)) / lambda;
}

// With mu = 1 and lambda = 10 s/m. An error of first order at dt = 1e-5 s: mu g dt = 1e-4 m/s.
static void a_belt_takes_up_a_part_from_rest(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);

    d->def.damping = 0.0;
    helper_disks_add(d, 0.3, 0.5);
    disk_state *s = helper_disk_state_start(&d->def);
    helper_disk_state_row(s, 0)->vx = 0.0;
    helper_disk_state_advance(s, 1); // without forces
    for (int k = 1; k <= 40; k++) {
        helper_disk_state_advance(s, 100);
        double slip = exact_slip(10.0, gravity, 0.395, k * 1e-3);
        assert_near(helper_disk_state_row(s, 0)->vx, 0.395 - slip, 2e-4);
        assert_true(helper_disk_state_row(s, 0)->vy == 0.0);
    }
    helper_disk_state_end(s);
    helper_disks_free(d);
}

// w' = -A tanh(lambda w) likewise, with A = mu r_spin m g/(m r^2/2) = 2 mu g r_spin/r^2 = 1090 rad/s2 and
// lambda = 1 s; the implicit step is off by A lambda dt = 1 % of what is lost in a time 1/(A lambda).
static void spin_decays_on_the_belt(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);
    double spin_deceleration = 2.0 * gravity * 0.008 / (radius * radius), error[2];

    d->def.damping = 0.0;
    helper_disks_add(d, 0.3, 0.5);
    for (int fine = 0; fine < 2; fine++) {
        d->def.dt = fine ? 5e-6 : 1e-5;
        disk_state *s = helper_disk_state_start(&d->def);
        helper_disk_state_row(s, 0)->spin = 6.0;
        helper_disk_state_advance(s, 1); // without forces
        error[fine] = 0.0;
        for (int k = 1; k <= 100; k++) {
            helper_disk_state_advance(s, fine ? 20 : 10);
            double exact = exact_slip(1.0, spin_deceleration, 6.0, k * 1e-4);
            error[fine] = fmax(error[fine], fabs(helper_disk_state_row(s, 0)->spin - exact));
        }
        assert_true(helper_disk_state_row(s, 0)->spin >= 0.0 &&
                    helper_disk_state_row(s, 0)->spin < 0.1);
        helper_disk_state_end(s);
    }
    assert_true(error[0] < 0.02);
    assert_true(log2(error[0] / error[1]) > 0.9);
    helper_disks_free(d);
}

// The step is far too long for this brake, and the spin still comes to rest without turning round.
static void spin_friction_never_turns_the_spin_round(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.0);

    d->kinds[0].spin_radius = 1e6;
    helper_disks_add(d, 0.3, 0.5);
    disk_state *s = helper_disk_state_start(&d->def);
    helper_disk_state_row(s, 0)->spin = -50.0;
    for (int k = 0; k < 20; k++) {
        double before = helper_disk_state_row(s, 0)->spin;
        helper_disk_state_advance(s, 1);
        assert_true(helper_disk_state_row(s, 0)->spin <= 0.0 &&
                    helper_disk_state_row(s, 0)->spin >= before);
    }
    assert_near(helper_disk_state_row(s, 0)->spin, 0.0, 1e-6);
    helper_disk_state_end(s);
    helper_disks_free(d);
}

// Speed at which a part that cannot spin slides along an obstacle: friction of the belt points along the
// slip v_T - v t, the obstacle's against the motion, so with u the speed
//     v_T cos(theta) - u = mu tanh(lambda u) v_T sin(theta).
static double sliding_speed(double v, double theta, double mu, double lambda)
{
    double low = 0.0, high = v;

    for (int k = 0; k < 200; k++) {
        double u = 0.5 * (low + high);
        if (v * cos(theta) - u > mu * tanh(lambda * u) * v * sin(theta))
            low = u;
        else
            high = u;
    }
    return low;
}

static double measure_sliding(double theta, double lambda)
{
    helper_disks *d = helper_disks_make(2.0, 2.0, 0.395);

    d->def.damping = 0.0;
    d->def.contact[SCENE_HANDLING_CARGO].tanh_linear = lambda;
    d->kinds[0].spin_radius = 10.0; // blocks the spin
    d->path[0] = (vec2){ 0.2, 0.1 };
    d->path[1] = (vec2){ 0.2 + 1.5 * cos(theta), 0.1 + 1.5 * sin(theta) };
    helper_disks_block(d, 2, 0.005);
    // Touching the line 0.3 m along it.
    helper_disks_add(d, 0.2 + 0.3 * cos(theta) - radius * sin(theta),
                     0.1 + 0.3 * sin(theta) + radius * cos(theta));
    micro_solver *s = helper_disks_start(d);
    helper_disks_advance(s, 150000);
    micro_part before = micro_part_of(s, 0);
    helper_disks_advance(s, 10000);
    micro_part after = micro_part_of(s, 0);
    micro_destroy(s);
    helper_disks_free(d);
    return hypot(after.x[0] - before.x[0], after.x[1] - before.x[1]) / 0.1;
}

static void a_part_slides_along_an_obstacle_at_the_speed_of_balance(void **state)
{
    const double degrees[3] = { 45.0, 60.0, 75.0 }, expected[3] = { 0.227, 0.140, 0.062 };

    for (int k = 0; k < 3; k++) {
        double theta = degrees[k] * M_PI / 180.0;
        double speed = sliding_speed(0.395, theta, 0.19, 10.0);
        assert_near(speed, expected[k], 5e-4);
        assert_near(measure_sliding(theta, 10.0), speed, 2e-5);
        // tanh(2000 u) is 1 for all three: the limit of full friction.
        assert_near(measure_sliding(theta, 2000.0), 0.395 * (cos(theta) - 0.19 * sin(theta)), 2e-5);
    }
}

// At rest before a wall across the belt: mu m g tanh(lambda v_T) = k delta, k of cargo and handling.
static void a_part_rests_before_a_wall(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);
    double compliance = (1.0 - 0.34 * 0.34) / 70e9 + (1.0 - 0.28 * 0.28) / 210e9;
    double k = M_PI / 4.0 * 0.008 / (compliance * 1e6);

    d->def.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    helper_disks_add(d, 1.0 - radius - 1e-3, 0.5);
    micro_solver *s = helper_disks_start(d);
    helper_disks_advance(s, 400000);
    micro_part part = micro_part_of(s, 0);
    double delta = d->kinds[0].mass * gravity * tanh(3.95) / k;
    assert_near(part.x[0], 1.0 - radius + delta, 1e-6);
    assert_near(part.v[0], 0.0, 1e-6);
    assert_int_equal(micro_measure(s).n_contacts, 1);
    assert_near(micro_measure(s).largest_overlap, delta, 1e-6);
    assert_near(micro_measure(s).overlap_share, delta / radius, 1e-4);
    micro_destroy(s);
    helper_disks_free(d);
}

static void loose_parts_ride_their_belts(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);
    const vec2 strip[4] = { { 0.0, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.3 }, { 0.0, 0.3 } };

    d->belts[1] = (scene_belt){ .velocity = { 0.0, 0.2 }, .n_points = 4, .polygon = (vec2 *)strip };
    d->def.n_belts = 2;
    d->def.damping = 0.0;
    helper_disks_add(d, 0.1, 0.8);
    helper_disks_add(d, 0.5, 0.1);
    micro_solver *s = helper_disks_start(d);
    helper_disks_advance(s, 10000);
    assert_near(micro_part_of(s, 0).x[0], 0.1 + 0.0395, 1e-12);
    assert_near(micro_part_of(s, 0).x[1], 0.8, 1e-15);
    assert_near(micro_part_of(s, 1).x[0], 0.5, 1e-15);
    assert_near(micro_part_of(s, 1).x[1], 0.1 + 0.02, 1e-12);
    // Over the border at y = 0.3 the first belt takes it up: (vx - 0.395, vy) decays.
    helper_disks_advance(s, 90000 + 50000);
    micro_part part = micro_part_of(s, 1);
    assert_true(part.x[1] > 0.3 && part.x[1] < 0.32);
    assert_near(part.v[0], 0.395, 1e-6);
    assert_near(part.v[1], 0.0, 1e-6);
    micro_destroy(s);
    helper_disks_free(d);
}

static void off_every_belt_nothing_brakes(void **state)
{
    helper_disks *d = helper_disks_make_bare();

    d->def.start_velocity = (vec2){ 0.3, -0.1 };
    helper_disks_add(d, 0.2, 0.5);
    disk_state *s = helper_disk_state_start(&d->def);
    helper_disk_state_row(s, 0)->spin = 3.0;
    helper_disk_state_advance(s, 20000);
    assert_near(helper_disk_state_row(s, 0)->x, 0.2 + 0.06, 1e-12);
    assert_near(helper_disk_state_row(s, 0)->y, 0.5 - 0.02, 1e-12);
    assert_true(helper_disk_state_row(s, 0)->spin == 3.0);
    assert_near(disk__part(s, 0).heading, 3.0 * 0.2, 1e-10);
    helper_disk_state_end(s);
    helper_disks_free(d);
}

// D acts on velocities as (1 - D dt)^n, on spins as (1 - D)^t; the first step is without forces.
static void damping_slows_places_and_spins(void **state)
{
    helper_disks *d = helper_disks_make_bare();

    d->def.damping = 0.5;
    d->def.start_velocity = (vec2){ 0.1, 0.0 };
    helper_disks_add(d, 0.2, 0.5);
    disk_state *s = helper_disk_state_start(&d->def);
    helper_disk_state_row(s, 0)->spin = 3.0;
    helper_disk_state_advance(s, 10001);
    assert_near(helper_disk_state_row(s, 0)->vx, 0.1 * pow(1.0 - 0.5e-5, 10000), 1e-14);
    assert_near(helper_disk_state_row(s, 0)->spin, 3.0 * pow(0.5, 0.1), 1e-11);
    helper_disk_state_end(s);
    helper_disks_free(d);
}

// 0.395e-5 m a step from 0.01 m before the edge: the centre is beyond it after ceil(0.01/0.395e-5).
static void a_part_is_gone_when_its_centre_leaves(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);
    const uint64_t last = (uint64_t)ceil(0.01 / 0.395e-5);

    helper_disks_add(d, 0.99, 0.5);
    helper_disks_add(d, 0.99 - 2.0 * radius + 1e-5, 0.5);
    helper_disks_add(d, 0.99, 0.5 + 2.0 * radius);
    d->def.damping = 0.0;
    micro_solver *s = helper_disks_start(d);
    helper_disks_advance(s, last - 1);
    assert_false(micro_is_gone(s, 2));
    helper_disks_advance(s, 1);
    assert_true(micro_is_gone(s, 2));
    micro_part left = micro_part_of(s, 2);
    assert_near(left.x[0], 0.99 + (double)last * 0.395e-5, 1e-12);
    assert_true(left.x[0] > 1.0);
    helper_disks_advance(s, 3000);
    assert_true(micro_part_of(s, 2).x[0] == left.x[0]);
    helper_disks_advance(s, 7000);
    assert_true(micro_is_gone(s, 0) && micro_is_gone(s, 1));
    assert_int_equal(micro_measure(s).n_parts, 0);
    assert_true(micro_part_of(s, 2).x[0] == left.x[0]);
    assert_int_equal(micro_parts(s), 3);
    micro_destroy(s);
    helper_disks_free(d);
}

static void a_part_of_a_kind_lies_with_its_middle_at_half_its_height(void **state)
{
    helper_disks *d = helper_disks_make(1.0, 1.0, 0.395);

    d->def.n_kinds = 2;
    d->kinds[1].shape.height = 0.02;
    d->part_kinds[1] = 1;
    d->def.part_kinds = d->part_kinds;
    helper_disks_add(d, 0.3, 0.5);
    helper_disks_add(d, 0.4, 0.5);
    d->poses[1].heading = 1.0;
    micro_solver *s = helper_disks_start(d);
    assert_true(micro_is_planar(s));
    assert_near(micro_part_of(s, 0).x[2], 0.004, 1e-15);
    assert_near(micro_part_of(s, 1).x[2], 0.01, 1e-15);
    assert_near(micro_part_of(s, 1).q[0], cos(0.5), 1e-15);
    assert_near(micro_part_of(s, 1).q[3], sin(0.5), 1e-15);
    micro_destroy(s);
    helper_disks_free(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_belt_takes_up_a_part_from_rest),
        cmocka_unit_test(spin_decays_on_the_belt),
        cmocka_unit_test(spin_friction_never_turns_the_spin_round),
        cmocka_unit_test(a_part_slides_along_an_obstacle_at_the_speed_of_balance),
        cmocka_unit_test(a_part_rests_before_a_wall),
        cmocka_unit_test(loose_parts_ride_their_belts),
        cmocka_unit_test(off_every_belt_nothing_brakes),
        cmocka_unit_test(damping_slows_places_and_spins),
        cmocka_unit_test(a_part_is_gone_when_its_centre_leaves),
        cmocka_unit_test(a_part_of_a_kind_lies_with_its_middle_at_half_its_height),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
