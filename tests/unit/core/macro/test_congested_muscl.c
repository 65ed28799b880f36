// The scheme muscl under the congested closure: order, bounds and edges of its transport. Where no cargo is packed the
// closure is the transport equation by the belt, and so is the dispersive closure without dispersion, whose scheme is
// held to exact solutions in test_muscl.c.

#include "core/base/buffer.h"
#include "core/macro/macro.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/helper_cmocka.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MANY = 5 }; // threads that divide no number of rows here

// A grid over one belt with its arrays, which tests fill before they create the solver.
typedef struct world {
    macro_def def;
    double *rho;
    scene_belt belt;
} world;

static void *zeros(size_t n, size_t size)
{
    void *all = calloc(n, size);

    assert_non_null(all);
    return all;
}

static double *ones(size_t n)
{
    double *all = zeros(n, sizeof *all);

    for (size_t k = 0; k < n; k++)
        all[k] = 1.0;
    return all;
}

static void make_world(world *w, size_t n1, size_t n2, double cell, double speed)
{
    *w = (world){ .def = macro_def_default(), .belt = { .velocity = { speed, 0.0 } } };
    w->def.grid = (bf_grid){ .n1 = n1, .n2 = n2, .d1 = cell, .d2 = cell };
    w->def.closure = SCENE_CONGESTED;
    w->def.scheme = SCENE_SCHEME_MUSCL;
    w->def.dispersion = 0.0;
    for (int axis = 0; axis < 2; axis++) {
        velocity_field_faces *faces = &w->def.faces[axis];
        const size_t n = grid_faces(&w->def.grid, axis);
        faces->v = zeros(n, sizeof *faces->v);
        faces->aperture = ones(n);
        faces->transverse = zeros(n, sizeof *faces->transverse);
        faces->closed = zeros(n, sizeof *faces->closed);
        faces->belt = zeros(n, sizeof *faces->belt);
        for (size_t k = 0; k < n; k++)
            (axis == 0 ? faces->v : faces->transverse)[k] = speed;
    }
    w->def.n_belts = 1;
    w->def.belts = &w->belt;
    w->rho = zeros(n1 * n2, sizeof *w->rho);
}

static void free_world(const world *w)
{
    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *faces = &w->def.faces[axis];
        free(faces->v);
        free(faces->aperture);
        free(faces->transverse);
        free(faces->closed);
        free(faces->belt);
    }
    free(w->rho);
}

static void close_face1(const world *w, size_t i, size_t j)
{
    w->def.faces[0].closed[j * (w->def.grid.n1 + 1) + i] = 1;
    w->def.faces[0].aperture[j * (w->def.grid.n1 + 1) + i] = 0.0;
    w->def.faces[0].v[j * (w->def.grid.n1 + 1) + i] = 0.0;
}

static macro_solver *start(const world *w)
{
    return helper_macro_start_with(&w->def, w->rho);
}

static void put_bump(const world *w, double x1, double x2, double deviation)
{
    const bf_grid *g = &w->def.grid;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            w->rho[j * g->n1 + i] =
                helper_macro_bump(grid_x1(g, i) - x1, grid_x2(g, j) - x2, deviation);
}

// L1 error of the bump at (x1, x2), m2.
static double error_of(const macro_solver *s, const bf_grid *g, double x1, double x2,
                       double deviation)
{
    double error = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            error += g->d1 * g->d2 *
                     fabs(macro_row(s, j)[i] -
                          helper_macro_bump(grid_x1(g, i) - x1, grid_x2(g, j) - x2, deviation));
    return error;
}

// Relative L1 error of a round heap of 8 cm after 0.4 m on a free belt, as in test_muscl.c.
static double error_after_40_cm(scene_scheme scheme)
{
    const double speed = 0.4, deviation = 0.075;
    world w;

    make_world(&w, 280, 120, 5e-3, speed);
    w.def.scheme = scheme;
    w.def.dt = 1.25e-3;
    put_bump(&w, 0.4, 0.3, deviation);
    macro_solver *s = start(&w);
    const double mass = macro_measure(s).mass;
    helper_macro_advance(s, 800);
    const double error = error_of(s, &w.def.grid, 0.8, 0.3, deviation) / mass;
    macro_destroy(s);
    free_world(&w);
    return error;
}

static void a_heap_on_a_free_belt_keeps_its_shape(void **state)
{
    assert_true(error_after_40_cm(SCENE_SCHEME_ROE) > 0.12);
    assert_true(error_after_40_cm(SCENE_SCHEME_MUSCL) < 0.006);
}

// L1 error after 0.4 m at 0.4 m/s, m2, with cells of 0.01/refinement m.
static double error_at(size_t refinement)
{
    const double cell = 0.01 / (double)refinement, deviation = 0.08;
    world w;

    make_world(&w, 120 * refinement, 80 * refinement, cell, 0.4);
    w.def.dt = 0.625 * cell;
    put_bump(&w, 0.4, 0.4, deviation);
    macro_solver *s = start(&w);
    helper_macro_advance(s, 160 * (int)refinement);
    const double error = error_of(s, &w.def.grid, 0.8, 0.4, deviation);
    macro_destroy(s);
    free_world(&w);
    return error;
}

static void what_is_not_packed_is_carried_with_second_order(void **state)
{
    const double coarse = error_at(1), fine = error_at(2);

    assert_true(log2(coarse / fine) >= 1.8);
}

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

// A field with random faces, nowhere against the belt, some of them closed, under densities that are packed nowhere in the steps of a test.
static void put_random_field(const world *w, double most)
{
    const bf_grid *g = &w->def.grid;

    for (size_t k = 0; k < (g->n1 + 1) * g->n2; k++) {
        w->def.faces[0].closed[k] = rand() % 8 == 0;
        w->def.faces[0].aperture[k] = w->def.faces[0].closed[k] ? 0.0 : 1.0;
        w->def.faces[0].v[k] = uniform(0.0, most);
    }
    for (size_t k = 0; k < g->n1 * (g->n2 + 1); k++) {
        w->def.faces[1].closed[k] = rand() % 8 == 0;
        w->def.faces[1].aperture[k] = w->def.faces[1].closed[k] ? 0.0 : 1.0;
        w->def.faces[1].v[k] = uniform(-most, most);
    }
    for (size_t k = 0; k < g->n1 * g->n2; k++)
        w->rho[k] = rand() % 3 == 0 ? 0.0 : uniform(0.0, 0.3);
}

// Without a pressure both closures are d(rho)/dt + div(rho v_stat) = 0, by the same states and order of sums.
static void where_nothing_is_packed_both_closures_give_the_same_bits(void **state)
{
    for (unsigned seed = 1; seed <= 4; seed++) {
        world w;
        srand(seed);
        make_world(&w, 70 + seed, 24, 5e-3, 0.4);
        w.def.dt = 2e-3;
        put_random_field(&w, 0.4);
        w.def.n_threads = 2;
        macro_solver *congested = start(&w);
        w.def.closure = SCENE_DISPERSIVE;
        macro_solver *dispersive = start(&w);
        for (int step = 0; step < 8; step++) {
            macro_step(congested);
            macro_step(dispersive);
            assert_true(macro_measure(dispersive).peak < w.def.jam_density);
            assert_true(macro_digest(congested) == macro_digest(dispersive));
        }
        macro_destroy(congested);
        macro_destroy(dispersive);
        free_world(&w);
    }
}

// A wall across half of the belt, 13 cells from the east edge, with a dense heap before it.
static void put_jam(world *w)
{
    const bf_grid *g = &w->def.grid;

    for (size_t j = 0; j < g->n2 / 2; j++)
        close_face1(w, g->n1 - 13, j);
    for (size_t j = 2; j + 2 < g->n2; j++)
        for (size_t i = g->n1 - 50; i < g->n1 - 20; i++)
            w->rho[j * g->n1 + i] = 0.7;
}

static void a_jam_loses_no_mass_and_no_density_is_negative(void **state)
{
    world w;

    make_world(&w, 90, 40, 1e-2, 0.4);
    // The largest step that is accepted: 4 dt v <= dx, v1 and v2 alike.
    for (size_t k = 0; k < 90 * 41; k++)
        w.def.faces[1].v[k] = k >= 90 && k < 90 * 40 && k % 7 == 0 ? -0.4 : 0.0;
    w.def.dt = 1e-2 / (4.0 * 0.4);
    put_jam(&w);
    for (size_t j = 0; j < 40; j++)
        close_face1(&w, 90, j);
    for (int side = 0; side < 4; side++)
        w.def.one_way[side] = true;
    macro_solver *s = start(&w);
    const double mass = macro_measure(s).mass;
    for (int step = 0; step < 300; step++) {
        macro_step(s);
        for (size_t j = 0; j < 40; j++)
            for (size_t i = 0; i < 90; i++)
                assert_true(macro_row(s, j)[i] >= 0.0);
        assert_true(fabs(macro_measure(s).mass - mass) <= 1e-12 * mass);
    }
    assert_true(macro_measure(s).peak > 0.9);
    macro_destroy(s);
    free_world(&w);
}

// A wall across the whole belt: in front of it a jam, behind it nothing, at any time.
static void nothing_leaks_through_a_closed_wall(void **state)
{
    world w;

    make_world(&w, 60, 30, 1e-2, 0.4);
    w.def.dt = 5e-3;
    for (size_t j = 0; j < 30; j++) {
        close_face1(&w, 40, j);
        for (size_t i = 15; i < 35; i++)
            w.rho[j * 60 + i] = 0.8;
    }
    macro_solver *s = start(&w);
    helper_macro_advance(s, 200);
    for (size_t j = 0; j < 30; j++)
        for (size_t i = 40; i < 60; i++)
            assert_true(macro_row(s, j)[i] == 0.0);
    macro_destroy(s);
    free_world(&w);
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    world w;

    make_world(&w, 90, 41, 1e-2, 0.4);
    w.def.dt = 5e-3;
    put_jam(&w);
    macro_solver *one = start(&w);
    w.def.n_threads = MANY;
    macro_solver *many = start(&w);
    for (int step = 0; step < 200; step++) {
        macro_step(one);
        macro_step(many);
        assert_true(macro_digest(one) == macro_digest(many));
    }
    macro_destroy(one);
    macro_destroy(many);
    free_world(&w);
}

// Behind a heap the density of a cell falls by the same factor in every step; here the heap has long gone.
static void check_tail(scene_closure closure, scene_scheme scheme)
{
    enum { LENGTH = 20, WIDTH = 11 };
    world w;

    make_world(&w, LENGTH, WIDTH, 1e-2, 0.4);
    w.def.closure = closure;
    w.def.scheme = scheme;
    w.def.dt = 1e-2 / (4.0 * 0.4);
    for (size_t k = 0; k < LENGTH * WIDTH; k++)
        w.rho[k] = 1e-306 * (double)(k % 5);
    macro_solver *one = start(&w);
    w.def.n_threads = MANY;
    macro_solver *many = start(&w);
    for (int step = 0; step < 60; step++) {
        macro_step(one);
        macro_step(many);
        assert_true(macro_digest(one) == macro_digest(many));
        for (size_t k = 0; k < LENGTH * WIDTH; k++)
            assert_int_not_equal(fpclassify(macro_row(one, k / LENGTH)[k % LENGTH]), FP_SUBNORMAL);
    }
    macro_destroy(one);
    macro_destroy(many);
    free_world(&w);
}

static void a_tail_is_never_subnormal_and_has_the_same_bits_for_any_number_of_threads(void **state)
{
    volatile double least = DBL_MIN;

    check_tail(SCENE_CONGESTED, SCENE_SCHEME_ROE);
    check_tail(SCENE_CONGESTED, SCENE_SCHEME_MUSCL);
    check_tail(SCENE_DISPERSIVE, SCENE_SCHEME_MUSCL);
    assert_true(least / 2.0 > 0.0); // this thread's arithmetic is what it was
}

static void a_run_that_is_resumed_has_the_same_bits(void **state)
{
    world w;
    bf_buffer bytes = { 0 };

    make_world(&w, 90, 40, 1e-2, 0.4);
    w.def.dt = 5e-3;
    put_jam(&w);
    macro_solver *whole = start(&w), *resumed = start(&w);
    helper_macro_advance(whole, 80);
    assert_int_equal(macro_save(whole, &bytes, NULL), BF_OK);
    assert_int_equal(macro_load(resumed, bytes.bytes, bytes.n, NULL), BF_OK);
    for (int step = 0; step < 80; step++) {
        macro_step(whole);
        macro_step(resumed);
        assert_true(macro_digest(whole) == macro_digest(resumed));
    }
    buffer_fini(&bytes);
    macro_destroy(whole);
    macro_destroy(resumed);
    free_world(&w);
}

// One cell from which everything flows away, without a correction as the belt stands: a stage leaves 1 - 4 dt v/dx of it, which is nothing at the largest step,
// and the step half of it. A longer step is refused.
static void the_bound_is_that_of_a_cell_that_empties_through_all_its_faces(void **state)
{
    enum { N = 9, MIDDLE = 4 };
    world w;
    macro_solver *s = NULL;
    bf_error err = { 0 };

    make_world(&w, N, N, 0.01, 0.0);
    w.def.faces[0].v[MIDDLE * (N + 1) + MIDDLE] = w.def.faces[1].v[MIDDLE * N + MIDDLE] = -0.5;
    w.def.faces[0].v[MIDDLE * (N + 1) + MIDDLE + 1] = w.def.faces[1].v[(MIDDLE + 1) * N + MIDDLE] =
        0.5;
    w.rho[MIDDLE * N + MIDDLE] = 0.8;
    w.def.dt = 0.01 / (4.0 * 0.5);
    s = start(&w);
    macro_step(s);
    assert_true(fabs(macro_row(s, MIDDLE)[MIDDLE] - 0.4) < 1e-15);
    macro_destroy(s);
    w.def.dt *= 1.001;
    assert_int_equal(macro_create(&w.def, &s, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/macro/step_s");
    free_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_heap_on_a_free_belt_keeps_its_shape),
        cmocka_unit_test(what_is_not_packed_is_carried_with_second_order),
        cmocka_unit_test(where_nothing_is_packed_both_closures_give_the_same_bits),
        cmocka_unit_test(a_jam_loses_no_mass_and_no_density_is_negative),
        cmocka_unit_test(nothing_leaks_through_a_closed_wall),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(a_tail_is_never_subnormal_and_has_the_same_bits_for_any_number_of_threads),
        cmocka_unit_test(a_run_that_is_resumed_has_the_same_bits),
        cmocka_unit_test(the_bound_is_that_of_a_cell_that_empties_through_all_its_faces),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
