// The four microscopic solvers on belts whose speed changes. Expected values are derived.

#include "core/base/memory.h"
#include "core/micro/micro.h"
#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

// An upright cylinder of 12 mm on two belts, without damping. Do not move it once it was made.
typedef struct world {
    micro_def def;
    scene_belt belts[2];
    vec2 corners[2][4];
    double times[2][4], factors[2][4];
    micro_kind kind;
    scene_pose pose;
} world;

// The first belt moves to the east and covers the domain; the second one is not in the definition yet.
static void make_world(world *w, int solver)
{
    *w = (world){ .def = helper_micro_def(solver),
                  .kind = { .shape = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 },
                            .material = { 210e9, 0.28 },
                            .mass = 0.0284,
                            .spin_radius = 0.008 },
                  .pose = { 0.5, 1.0, 0.0 } };
    w->def.domain = (scene_rect){ 0.0, 3.0, 0.0, 3.0 };
    w->def.n_belts = w->def.n_kinds = w->def.n_parts = 1;
    w->def.belts = w->belts;
    w->def.kinds = &w->kind;
    w->def.poses = &w->pose;
    for (int k = 0; k < 2; k++)
        w->belts[k] = (scene_belt){ .velocity = { k == 0 ? 0.4 : 0.0, k == 0 ? 0.0 : 0.3 },
                                    .acceleration = INFINITY,
                                    .deceleration = INFINITY };
}

static void set_schedule(world *w, int belt, size_t n, const double *times, const double *factors)
{
    memcpy(w->times[belt], times, n * sizeof *times);
    memcpy(w->factors[belt], factors, n * sizeof *factors);
    w->belts[belt].speed_schedule =
        (scene_speed_schedule){ n, w->times[belt], n, w->factors[belt] };
}

// Goes on to time t, in calls of one step and of many.
static void advance_to(micro_solver *s, double t)
{
    const uint64_t end = (uint64_t)lround(t / micro_dt(s));

    assert_int_equal(micro_advance(s, 1, NULL), BF_OK);
    assert_int_equal(micro_advance(s, end - micro_steps(s), NULL), BF_OK);
}

static void a_part_starts_with_the_speed_that_its_belt_has_then(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world w;
        make_world(&w, k);
        set_schedule(&w, 0, 2, (double[]){ 0.0, 1.0 }, (double[]){ 0.25, 1.0 });
        micro_solver *s = helper_micro_start(&w.def);
        assert_true(micro_part_of(s, 0).v[0] == 0.1 && micro_part_of(s, 0).v[1] == 0.0);
        advance_to(s, 0.9);
        assert_near(micro_part_of(s, 0).x[0], 0.5 + 0.1 * 0.9, 1e-9);
        micro_destroy(s);
    }
}

static void on_a_belt_that_stands_a_part_does_not_move(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world w;
        make_world(&w, k);
        set_schedule(&w, 0, 1, (double[]){ 0.0 }, (double[]){ 0.0 });
        micro_solver *s = helper_micro_start(&w.def);
        advance_to(s, 0.5);
        const micro_part part = micro_part_of(s, 0);
        assert_near(hypot(part.x[0] - 0.5, part.x[1] - 1.0), 0.0, 1e-15);
        assert_near(hypot(part.v[0], part.v[1]), 0.0, 1e-15);
        micro_destroy(s);
    }
}

// On a belt of acceleration a the friction mu m g tanh(lambda s) is m a; here a = 1 m/s2 from 0.2 m/s on. In a step the
// belt has its mean speed, that of the middle. A part after n steps has the velocity at which friction was taken: in the
// next step by Verlet, in the last one by implicit steps, whose secants are within 2e-4 in the plane (friction.h).
static void in_a_ramp_a_part_trails_by_the_slip_of_its_friction(void **state)
{
    const double slip = atanh(1.0 / 9.81) / 10.0;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        const double half = helper_micro_solvers[k].integrator == MICRO_IMPLICIT ? -0.5 : 0.5;
        world w;
        make_world(&w, k);
        w.belts[0].acceleration = 1.0;
        set_schedule(&w, 0, 2, (double[]){ 0.0, helper_micro_solvers[k].dt },
                     (double[]){ 0.5, 4.0 });
        micro_solver *s = helper_micro_start(&w.def);
        advance_to(s, 0.5);
        const double belt = 0.2 + 0.5 + (half - 1.0) * helper_micro_solvers[k].dt;
        assert_near(belt - micro_part_of(s, 0).v[0], slip, k == 1 ? 2e-4 * slip : 1e-12);
        micro_destroy(s);
    }
}

// Friction is an odd function of the slip, so what a part gains on the belt in the ramp down it loses in the same
// ramp up. In between it leads: for slips at which tanh is linear, by 0.4 m/s / (mu g lambda), since the sum of all
// friction is the change of its momentum. tanh z = z (1 - z^2/3 + ...) with z = a / (mu g) < 0.011. Verlet takes the
// friction of a step before the part moves in it, so that a step of 0.4 m/s is missing.
static void after_a_stop_and_go_a_part_is_where_the_belt_has_carried_it(void **state)
{
    const double lead = 0.4 / (9.81 * 10.0);

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        const double missing = helper_micro_solvers[k].integrator == MICRO_VERLET
                                   ? 0.4 * helper_micro_solvers[k].dt
                                   : 0.0;
        world w;
        make_world(&w, k);
        w.belts[0].acceleration = w.belts[0].deceleration = 0.1;
        // Ramps of 4 s each; the belt moves by 0.2 m, 0.8 m, nothing, 0.8 m and 0.2 m.
        set_schedule(&w, 0, 2, (double[]){ 0.5, 5.0 }, (double[]){ 0.0, 1.0 });
        micro_solver *s = helper_micro_start(&w.def);
        advance_to(s, 5.0);
        assert_near(micro_part_of(s, 0).v[0], 0.0, 1e-12);
        assert_near(micro_part_of(s, 0).x[0], 0.5 + 0.2 + 0.8 + lead - missing, 1e-4 * lead);
        advance_to(s, 9.5);
        assert_near(micro_part_of(s, 0).v[0], 0.4, 1e-9);
        assert_near(micro_part_of(s, 0).x[0], 0.5 + 0.2 + 0.8 + 0.8 + 0.2, 1e-9);
        micro_destroy(s);
    }
}

// The two belts meet at x = 1 m.
static void set_transfer(world *w, vec2 velocity)
{
    static const double edges[3] = { 0.0, 1.0, 3.0 };

    for (int k = 0; k < 2; k++) {
        w->corners[k][0] = (vec2){ edges[k], 0.0 };
        w->corners[k][1] = (vec2){ edges[k + 1], 0.0 };
        w->corners[k][2] = (vec2){ edges[k + 1], 3.0 };
        w->corners[k][3] = (vec2){ edges[k], 3.0 };
        w->belts[k].n_points = 4;
        w->belts[k].polygon = w->corners[k];
    }
    w->belts[1].velocity = velocity;
    w->def.n_belts = 2;
}

// A part 0.5 m before the border reaches it after 1.25 s at 0.4 m/s and a pause of 0.5 s. Friction follows a jump
// within some 10 ms; the speeds of the second belt are 0, a half and all of its velocity.
static void check_transfer(int solver, const scene_shape *shape, vec2 velocity)
{
    static const double halves[] = { 0.5, 1.0 };
    world w;

    make_world(&w, solver);
    w.kind.shape = *shape;
    set_transfer(&w, velocity);
    set_schedule(&w, 0, 2, (double[]){ 0.3, 0.8 }, (double[]){ 0.0, 1.0 });
    set_schedule(&w, 1, 3, (double[]){ 0.0, 2.0, 2.5 }, (double[]){ 0.0, 0.5, 1.0 });
    micro_solver *s = helper_micro_start(&w.def);
    advance_to(s, 0.75);
    assert_near(micro_part_of(s, 0).v[0], 0.0, 1e-9);
    advance_to(s, 1.5);
    assert_near(micro_part_of(s, 0).v[0], 0.4, 1e-9);
    for (int k = 0; k < 2; k++) {
        advance_to(s, 2.4 + 0.5 * k);
        assert_near(micro_part_of(s, 0).v[0], halves[k] * velocity.x, 1e-6);
        assert_near(micro_part_of(s, 0).v[1], halves[k] * velocity.y, 1e-6);
    }
    micro_destroy(s);
}

static void a_part_takes_the_speeds_of_the_belt_that_it_comes_to(void **state)
{
    const scene_shape cylinder = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 };
    const scene_shape box = { .type = SCENE_BOX, .length = 0.03, .width = 0.02, .height = 0.01 };
    const vec2 ahead = { 0.3, 0.0 }, aside = { 0.0, 0.3 };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        check_transfer(k, &cylinder, ahead); // a drop in speed
        check_transfer(k, &cylinder, aside); // a right-angle transfer
        if (helper_micro_solvers[k].path == MICRO_PATH_PLANAR)
            continue;
        check_transfer(k, &box, ahead);
        check_transfer(k, &box, aside);
    }
}

enum { COLUMNS = 30, CROWD = 40 * COLUMNS, CROWD_IN_SPACE = 2 * COLUMNS, PARTS_MAX = CROWD };

// Parts that touch each other, on both sides of the border of two belts whose speeds change all the time; so many
// that two threads have work. Do not move it once it was made.
typedef struct crowd {
    world w;
    int n_steps; // of a run
    scene_pose poses[PARTS_MAX];
} crowd;

static void make_crowd(crowd *c, int solver)
{
    static const int steps[HELPER_MICRO_SOLVERS] = { 600, 60, 300, 60 };
    const double t = steps[solver] * helper_micro_solvers[solver].dt; // s, of the run

    make_world(&c->w, solver);
    set_transfer(&c->w, (vec2){ 0.1, 0.3 });
    for (int k = 0; k < PARTS_MAX; k++)
        c->poses[k] =
            (scene_pose){ 0.66 + 0.0239 * (k % COLUMNS), 1.0 + 0.0239 * (k / COLUMNS), 0.0 };
    c->n_steps = steps[solver];
    c->w.def.poses = c->poses;
    c->w.def.n_parts =
        helper_micro_solvers[solver].path == MICRO_PATH_PLANAR ? CROWD : CROWD_IN_SPACE;
    // Ramps of 0.4 m/s take a fifth of the run.
    c->w.belts[0].acceleration = c->w.belts[0].deceleration = 0.4 / (0.2 * t);
    set_schedule(&c->w, 0, 3, (double[]){ 0.1 * t, 0.4 * t, 0.7 * t }, (double[]){ 0.0, 1.5, 0.5 });
    set_schedule(&c->w, 1, 2, (double[]){ 0.0, 0.5 * t }, (double[]){ 1.0, 0.0 });
}

// The digest after a run on n_threads threads that is saved after n steps and goes on in another solver.
static uint64_t digest_of_run(crowd *c, int n_threads, uint64_t n)
{
    bf_buffer saved = { 0 };

    c->w.def.n_threads = n_threads;
    micro_solver *s = helper_micro_start(&c->w.def);
    assert_int_equal(micro_advance(s, n, NULL), BF_OK);
    assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
    micro_destroy(s);
    s = helper_micro_start(&c->w.def);
    assert_int_equal(micro_load(s, saved.bytes, saved.n, NULL), BF_OK);
    assert_int_equal(micro_advance(s, (uint64_t)c->n_steps - n, NULL), BF_OK);
    assert_true(micro_measure(s).n_contacts > 5);
    const uint64_t digest = micro_digest(s);
    micro_destroy(s);
    buffer_fini(&saved);
    return digest;
}

// Saved before the first time, in each of three ramps, while a belt stands, and at the end.
static void threads_and_resumes_in_ramps_change_no_bit(void **state)
{
    static crowd c;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        make_crowd(&c, k);
        const uint64_t n = (uint64_t)c.n_steps, digest = digest_of_run(&c, 1, 0);
        const uint64_t stops[] = { n / 20, n / 5, n / 3, n / 2, 3 * n / 4, n };
        for (size_t m = HELPER_AMOUNT(0, 2); m < sizeof stops / sizeof *stops;
             m += HELPER_AMOUNT(1, 2))
            assert_true(digest_of_run(&c, 1 + (int)m % 3, stops[m]) == digest);
    }
}

static void steps_one_by_one_give_the_bits_of_steps_in_a_row(void **state)
{
    static crowd c;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        make_crowd(&c, k);
        micro_solver *s = helper_micro_start(&c.w.def);
        for (int n = 0; n < c.n_steps; n++)
            assert_int_equal(micro_advance(s, 1, NULL), BF_OK);
        assert_true(micro_digest(s) == digest_of_run(&c, 1, 0));
        micro_destroy(s);
    }
}

// A quarter of a radius in a step, at 0.4 m/s times the largest factor.
static void the_largest_speed_bounds_implicit_steps(void **state)
{
    world w;

    make_world(&w, 1);
    assert_near(micro_dt_stable(&w.def), 0.25 * 0.012 / 0.4, 1e-12);
    set_schedule(&w, 0, 2, (double[]){ 1e3, 2e3 }, (double[]){ 2.5, 0.5 });
    assert_near(micro_dt_stable(&w.def), 0.25 * 0.012 / (0.4 * 2.5), 1e-12);
}

static void out_of_memory_anywhere_is_an_error_and_nothing_leaks(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        bf_status status = BF_ENOMEM;
        world w;
        make_world(&w, k);
        set_schedule(&w, 0, 2, (double[]){ 0.5, 1.0 }, (double[]){ 0.0, 1.0 });
        for (size_t n = 1; status != BF_OK; n++) {
            micro_solver *s = NULL;
            memory_plan_fault(n, 0);
            status = micro_create(&w.def, &s, NULL);
            memory_plan_fault(0, 0);
            assert_true(status == BF_OK ? s != NULL : status == BF_ENOMEM && s == NULL);
            micro_destroy(s);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_starts_with_the_speed_that_its_belt_has_then),
        cmocka_unit_test(on_a_belt_that_stands_a_part_does_not_move),
        cmocka_unit_test(in_a_ramp_a_part_trails_by_the_slip_of_its_friction),
        cmocka_unit_test(after_a_stop_and_go_a_part_is_where_the_belt_has_carried_it),
        cmocka_unit_test(a_part_takes_the_speeds_of_the_belt_that_it_comes_to),
        cmocka_unit_test(threads_and_resumes_in_ramps_change_no_bit),
        cmocka_unit_test(steps_one_by_one_give_the_bits_of_steps_in_a_row),
        cmocka_unit_test(the_largest_speed_bounds_implicit_steps),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error_and_nothing_leaks),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
