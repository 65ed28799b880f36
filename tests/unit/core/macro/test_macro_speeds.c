// The macroscopic solver on belts whose speed changes. Expected values are derived.

#include "core/base/memory.h"
#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Where the mass is on average, m.
static vec2 centre(const macro_solver *s, const bf_grid *g)
{
    double mass = 0.0;
    vec2 moment = { 0.0, 0.0 };

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            const double rho = macro_row(s, j)[i];
            mass += rho;
            moment = vec2_add(moment, (vec2){ rho * grid_x1(g, i), rho * grid_x2(g, j) });
        }
    return vec2_scale(moment, 1.0 / mass);
}

// Upwinding moves the first moment by exactly v dt a step while nothing is saturated. A belt of 0.5 m/s brakes by
// 2.4 and speeds up by 1.6 of its factor a second; the ramp from 1.0 s on has reached 0.8 when it ends.
static void loose_cargo_is_displaced_by_the_integral_of_the_speed(void **state)
{
    static const scene_pose middle = { 1.2, 1.8, 0.0 };
    const double integral = 0.3 + 0.5 / 2.4 + 0.5 * 0.8 * 0.5 + 0.5 * (0.8 + 0.25) * 0.55 / 2.4 +
                            0.25 * (0.5 - 0.55 / 2.4);
    scene s;

    helper_scene_belt(&s, 3.0, 3.0, 0.02, &middle, 1);
    s.duration = 2.0;
    s.output.curve_every = 2.0;
    scene_belt *belt = helper_scene_add_belt(&s, (vec2){ 0.3, -0.4 }, NULL, 0);
    belt->acceleration = 0.8;
    belt->deceleration = 1.2;
    helper_scene_schedule(belt, 3, (double[]){ 0.3, 1.0, 1.5 }, (double[]){ 0.0, 1.5, 0.25 });
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s.edges[side] = SCENE_EDGE_OUTFLOW;
    helper_scene_resolve(&s);
    const bf_grid grid = scene_grid(&s);
    macro_solver *solver = helper_macro_start(&s, 1);
    const vec2 before = centre(solver, &grid);
    helper_macro_advance(solver, (int)lround(2.0 / scene_macro_step(&s)));
    assert_near(macro_time(solver), 2.0, 1e-12);
    const vec2 after = centre(solver, &grid);
    assert_near(after.x - before.x, 0.3 * integral, 1e-12);
    assert_near(after.y - before.y, -0.4 * integral, 1e-12);
    macro_destroy(solver);
    scene_fini(&s);
}

// Example 1 in steps of 2^-9 s, so that times of steps are exact.
static void make_jam(scene *s, size_t n, const double *times, const double *factors)
{
    helper_scene_example(s, 60.0, SCENE_SEALED);
    s->macro.cell = 0.01;
    s->macro.step = 0x1p-9;
    if (n > 0)
        helper_scene_schedule(&s->belts[0], n, times, factors);
}

static double *densities_of(const macro_solver *s, const scene *of)
{
    const bf_grid grid = scene_grid(of);
    double *rho = memory_alloc(grid_cells(&grid), sizeof *rho);

    assert_non_null(rho);
    helper_macro_copy(s, rho);
    return rho;
}

static void assert_same_densities(const macro_solver *a, const macro_solver *b, const scene *of)
{
    const bf_grid grid = scene_grid(of);
    double *of_a = densities_of(a, of), *of_b = densities_of(b, of);

    assert_memory_equal(of_a, of_b, grid_cells(&grid) * sizeof *of_a);
    memory_free(of_a);
    memory_free(of_b);
}

// The jam has cells above close packing, which disperse on a belt that moves.
static void on_a_belt_that_stands_nothing_changes(void **state)
{
    scene s;

    make_jam(&s, 1, (double[]){ 1.0 }, (double[]){ 0.0 });
    const bf_grid grid = scene_grid(&s);
    macro_solver *solver = helper_macro_start(&s, 1);
    helper_macro_advance(solver, 512);
    assert_true(macro_measure(solver).peak > 1.0);
    double *before = densities_of(solver, &s);
    helper_macro_advance(solver, 100);
    double *after = densities_of(solver, &s);
    assert_memory_equal(before, after, grid_cells(&grid) * sizeof *before);
    memory_free(before);
    memory_free(after);
    macro_destroy(solver);
    scene_fini(&s);
}

// A pause of 0.25 s, 128 steps.
static void a_stop_and_go_is_the_same_run_later(void **state)
{
    scene with, without;

    make_jam(&with, 2, (double[]){ 0.5, 0.75 }, (double[]){ 0.0, 1.0 });
    make_jam(&without, 0, NULL, NULL);
    macro_solver *late = helper_macro_start(&with, 1), *early = helper_macro_start(&without, 1);
    helper_macro_advance(late, 200 + 128);
    helper_macro_advance(early, 200);
    for (int k = 0; k < 4; k++) {
        helper_macro_advance(late, 100);
        helper_macro_advance(early, 100);
        assert_same_densities(late, early, &with);
    }
    macro_destroy(late);
    macro_destroy(early);
    scene_fini(&with);
    scene_fini(&without);
}

// On one belt the equation has f dt wherever it has dt: with a schedule the state at t is that of the constant belt at
// tau, the integral of f up to t. The scheme differs by its numerical diffusion, which depends on the speed: both
// differences from the exact curve, and so their difference, are of first order in the cell.
static double largest_gap_of_ramps(double cell)
{
    scene with, without;

    // 0.395 m/s by 0.395 m/s2: the factor changes by 1 a second. tau(4) = 1 + 0.5 + 0.5 + 1.0 = 3.
    make_jam(&with, 2, (double[]){ 1.0, 2.0 }, (double[]){ 0.0, 1.0 });
    make_jam(&without, 0, NULL, NULL);
    with.belts[0].acceleration = with.belts[0].deceleration = 0.395;
    with.macro.cell = without.macro.cell = cell;
    const size_t n = (size_t)lround(0.75 / cell), n2 = (size_t)lround(0.6 / cell);
    macro_solver *late = helper_macro_start(&with, 1), *early = helper_macro_start(&without, 1);
    double largest = 0.0;
    helper_macro_advance(late, 3 * 512);
    helper_macro_advance(early, 2 * 512);
    for (int k = 0; k < 8; k++) {
        double gap = macro_mass_in(late, 0, n, 0, n2) - macro_mass_in(early, 0, n, 0, n2);
        largest = fmax(largest, fabs(gap) * scene_packing_density(&with));
        helper_macro_advance(late, 64);
        helper_macro_advance(early, 64);
    }
    macro_destroy(late);
    macro_destroy(early);
    scene_fini(&with);
    scene_fini(&without);
    return largest;
}

static void ramps_change_when_a_state_is_reached_and_not_which(void **state)
{
    const double coarse = largest_gap_of_ramps(0.01), fine = largest_gap_of_ramps(0.005);
    assert_true(fine < 0.5 * coarse);
    assert_true(fine < 0.01 * 192.0);
}

// Fills the cells of a rectangle, m, with a density.
static void fill(const scene *s, const scene_rect *r, double density, macro_solver *solver)
{
    const bf_grid g = scene_grid(s);
    double *rho = memory_alloc(grid_cells(&g), sizeof *rho);

    assert_non_null(rho);
    for (size_t j = 0; j < g.n2; j++)
        for (size_t i = 0; i < g.n1; i++)
            if (grid_x1(&g, i) > r->x_min && grid_x1(&g, i) < r->x_max &&
                grid_x2(&g, j) > r->y_min && grid_x2(&g, j) < r->y_max)
                rho[j * g.n1 + i] = density;
    macro_set_density(solver, rho);
    memory_free(rho);
}

// Two belts that meet at x = 1.2 m, on faces, 1 cm cells. The first moves to the east with 0.4 m/s, but for a pause
// from 1.203 s on, and has a strip of loose cargo; the second moves at half of its velocity until a time. Steps are 1/200 s.
static void make_transfer(scene *s, double pause, vec2 velocity, double half_until, double density,
                          macro_solver **ret_solver)
{
    static const scene_pose somewhere = { 0.1, 0.1, 0.0 };
    static const vec2 west[] = { { 0.0, 0.0 }, { 1.2, 0.0 }, { 1.2, 0.6 }, { 0.0, 0.6 } };
    static const vec2 east[] = { { 1.2, 0.0 }, { 3.0, 0.0 }, { 3.0, 1.6 }, { 1.2, 1.6 } };
    const scene_rect strip = { 0.2, 1.1, 0.1, 0.2 };

    helper_scene_belt(s, 3.0, 1.6, 0.01, &somewhere, 1);
    s->macro.step = 0.005;
    s->macro.dispersion = 0.4;
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, west, 4);
    helper_scene_add_belt(s, velocity, east, 4);
    if (pause > 0.0)
        helper_scene_schedule(&s->belts[0], 2, (double[]){ 1.203, 1.203 + pause },
                              (double[]){ 0.0, 1.0 });
    helper_scene_schedule(&s->belts[1], 2, (double[]){ 0.0, half_until }, (double[]){ 0.5, 1.0 });
    helper_scene_resolve(s);
    *ret_solver = helper_macro_start(s, 1);
    fill(s, &strip, density, *ret_solver);
}

// Mass east of the border, m2.
static double mass_east(const macro_solver *solver, const scene *s)
{
    const bf_grid g = scene_grid(s);

    return macro_mass_in(solver, 120, g.n1, 0, g.n2);
}

// The strip crosses with 0.4 m/s times its width of 0.1 m, and not while its belt stands, from 1.203 to 1.403 s. At
// 1.2 s its front is 0.38 m beyond the border, and at 1.7 s its end 0.4 m before it: more than 5 times the widths of
// the smeared edges, sqrt(v dx t).
static void a_right_angle_transfer_follows_both_belts(void **state)
{
    const double density = 0.01, mass = 0.9 * 0.1 * density;
    scene s;
    macro_solver *solver;

    make_transfer(&s, 0.2, (vec2){ 0.0, 0.3 }, 2.5, density, &solver);
    const bf_grid g = scene_grid(&s);
    helper_macro_advance(solver, 240);
    const double before = mass_east(solver, &s);
    helper_macro_advance(solver, 100);
    assert_near(mass_east(solver, &s) - before, 0.4 * 0.1 * density * (0.5 - 0.2), 1e-6 * mass);
    // At 4 s nothing has been on the first belt for half a second; on the second one the factor is 1 since 2.5 s.
    helper_macro_advance(solver, 800 - 340);
    assert_near(mass_east(solver, &s), mass, 1e-6 * mass);
    const vec2 there = centre(solver, &g);
    helper_macro_advance(solver, 100);
    assert_near(centre(solver, &g).y - there.y, 0.3 * 0.5, 1e-6);
    assert_near(centre(solver, &g).x, there.x, 1e-6);
    assert_near(mass_east(solver, &s), mass, 1e-6 * mass);
    macro_destroy(solver);
    scene_fini(&s);
}

// What crosses a border goes on with rho_1 v_1 = rho_2 v_2. From 0.4 to 0.16 m/s it becomes 2.5 times as dense; when
// the second belt speeds up to 0.32 m/s, what comes then becomes 1.25 times as dense, and what was there stays as it was.
static void a_drop_in_speed_compresses_by_the_ratio_of_the_speeds(void **state)
{
    const double density = 0.1;
    scene s;
    macro_solver *solver;

    make_transfer(&s, 0.0, (vec2){ 0.32, 0.0 }, 1.5, density, &solver);
    helper_macro_advance(solver, 300);
    const double *row = macro_row(solver, 15);
    assert_near(row[117], density, 1e-6);
    // The last cell before the border has the density behind it, as the face has the velocity of the later belt.
    assert_near(row[119], 2.5 * density, 1e-6);
    assert_near(row[123], 2.5 * density, 1e-4);
    helper_macro_advance(solver, 40); // 0.2 s, 6.4 cells
    row = macro_row(solver, 15);
    assert_near(row[119], 1.25 * density, 1e-3);
    assert_near(macro_measure(solver).peak, 2.5 * density, 1e-3);
    macro_destroy(solver);
    scene_fini(&s);
}

// A closed box with a jam in it, on a belt that stops and starts by ramps.
static void make_box(scene *s)
{
    make_jam(s, 3, (double[]){ 0.2, 0.5, 0.9 }, (double[]){ 0.0, 1.4, 0.3 });
    s->belts[0].acceleration = 1.0;
    s->belts[0].deceleration = 1.5;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = SCENE_EDGE_WALL;
}

static void mass_is_conserved_through_ramps(void **state)
{
    scene s;

    make_box(&s);
    macro_solver *solver = helper_macro_start(&s, 1);
    const double mass = macro_measure(solver).mass;
    for (int k = 0; k < 10; k++) {
        helper_macro_advance(solver, 60);
        assert_near(macro_measure(solver).mass, mass, 1e-13 * mass);
    }
    macro_destroy(solver);
    scene_fini(&s);
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    scene s;

    make_box(&s);
    macro_solver *one = helper_macro_start(&s, 1);
    helper_macro_advance(one, 600);
    for (int n_threads = 2; n_threads <= 4; n_threads++) {
        macro_solver *many = helper_macro_start(&s, n_threads);
        helper_macro_advance(many, 600);
        assert_true(macro_digest(many) == macro_digest(one));
        macro_destroy(many);
    }
    macro_destroy(one);
    scene_fini(&s);
}

// Before the first time, in each ramp (from 0.2, 0.5 and 0.9 s on), while the belt stands and at constant speed.
static void a_run_resumed_in_a_ramp_goes_on_with_the_same_bits(void **state)
{
    static const int stops[] = { 50, 130, 230, 300, 500 };
    scene s;

    make_box(&s);
    macro_solver *whole = helper_macro_start(&s, 1);
    helper_macro_advance(whole, 600);
    for (size_t k = 0; k < sizeof stops / sizeof *stops; k++) {
        macro_solver *first = helper_macro_start(&s, 1), *then = helper_macro_start(&s, 2);
        bf_buffer saved = { 0 };
        helper_macro_advance(first, stops[k]);
        assert_int_equal(macro_save(first, &saved, NULL), BF_OK);
        assert_int_equal(macro_load(then, saved.bytes, saved.n, NULL), BF_OK);
        helper_macro_advance(then, 600 - stops[k]);
        assert_true(macro_digest(then) == macro_digest(whole));
        buffer_fini(&saved);
        macro_destroy(first);
        macro_destroy(then);
    }
    macro_destroy(whole);
    scene_fini(&s);
}

// 1 cm in 2^-9 s are 5.12 m/s, for v + eps = 3 * 0.395 m/s times the largest factor, 4.32.
static void the_largest_factor_bounds_the_step(void **state)
{
    for (int k = 0; k < 2; k++) {
        const double largest = k == 0 ? 4.32 : 4.33;
        scene s;
        velocity_field *f = NULL;
        macro_solver *solver = NULL;
        bf_error err = { 0 };
        make_jam(&s, 2, (double[]){ 1e6, 2e6 }, (double[]){ largest, 0.0 });
        assert_near(scene_step_stable(&s), 0.01 / (3.0 * 0.395 * largest), 1e-12);
        assert_int_equal(velocity_field_create(&s, &f, NULL), BF_OK);
        const macro_def def = helper_macro_def(&s, f);
        assert_int_equal(macro_create(&def, &solver, &err), k == 0 ? BF_OK : BF_EINPUT);
        assert_string_equal(err.pointer, k == 0 ? "" : "/macro/step_s");
        macro_destroy(solver);
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

static void out_of_memory_anywhere_is_an_error_and_nothing_leaks(void **state)
{
    scene s;

    make_box(&s);
    helper_macro_lack_memory(&s);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loose_cargo_is_displaced_by_the_integral_of_the_speed),
        cmocka_unit_test(on_a_belt_that_stands_nothing_changes),
        cmocka_unit_test(a_stop_and_go_is_the_same_run_later),
        cmocka_unit_test(ramps_change_when_a_state_is_reached_and_not_which),
        cmocka_unit_test(a_right_angle_transfer_follows_both_belts),
        cmocka_unit_test(a_drop_in_speed_compresses_by_the_ratio_of_the_speeds),
        cmocka_unit_test(mass_is_conserved_through_ramps),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(a_run_resumed_in_a_ramp_goes_on_with_the_same_bits),
        cmocka_unit_test(the_largest_factor_bounds_the_step),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error_and_nothing_leaks),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
