// The scheme muscl: order, bounds and edges. Exact solutions are those of the transport equation; that the solver
// computes the scheme as written is test_macro_reference.c, and what all schemes have in common test_macro.c.

#include "core/macro/macro.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A square or oblong grid with its arrays, which tests fill before they create the solver. No dispersion.
typedef struct world {
    macro_def def;
    double *v1, *v2, *rho;
} world;

static world make_world(size_t n1, size_t n2, double cell)
{
    world w = { .def = macro_def_default() };

    w.def.grid = (bf_grid){ .n1 = n1, .n2 = n2, .d1 = cell, .d2 = cell };
    w.def.scheme = SCENE_SCHEME_MUSCL;
    w.def.dispersion = 0.0;
    w.v1 = calloc((n1 + 1) * n2, sizeof *w.v1);
    w.v2 = calloc(n1 * (n2 + 1), sizeof *w.v2);
    w.rho = calloc(n1 * n2, sizeof *w.rho);
    assert_true(w.v1 != NULL && w.v2 != NULL && w.rho != NULL);
    w.def.faces[0].v = w.v1;
    w.def.faces[1].v = w.v2;
    // Reaches over one cell, as without dispersion it is not needed.
    w.def.mollifier = 16.0 / (cell * cell);
    return w;
}

static void free_world(world *w)
{
    free(w->v1);
    free(w->v2);
    free(w->rho);
}

static void carry_along_x1(world *w, double speed)
{
    for (size_t k = 0; k < (w->def.grid.n1 + 1) * w->def.grid.n2; k++)
        w->v1[k] = speed;
}

static macro_solver *start(const world *w)
{
    return helper_macro_start_with(&w->def, w->rho);
}

// Relative L1 error of a round heap of 8 cm after 0.4 m on a free belt, in cells of 5 mm and steps of 1.25 ms.
static double error_after_40_cm(scene_scheme scheme)
{
    const double belt = 0.4, deviation = 0.075;
    world w = make_world(280, 120, 5e-3);
    double error = 0.0, sum = 0.0;

    w.def.scheme = scheme;
    w.def.dt = 1.25e-3;
    carry_along_x1(&w, belt);
    const bf_grid *g = &w.def.grid;
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            w.rho[j * g->n1 + i] =
                helper_macro_bump(grid_x1(g, i) - 0.4, grid_x2(g, j) - 0.3, deviation);
    macro_solver *s = start(&w);
    helper_macro_advance(s, 800);
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            double exact = helper_macro_bump(grid_x1(g, i) - 0.8, grid_x2(g, j) - 0.3, deviation);
            error += fabs(macro_row(s, j)[i] - exact);
            sum += exact;
        }
    macro_destroy(s);
    free_world(&w);
    return error / sum;
}

static void a_heap_on_a_free_belt_keeps_its_shape(void **state)
{
    assert_true(error_after_40_cm(SCENE_SCHEME_ROE) > 0.12);
    assert_true(error_after_40_cm(SCENE_SCHEME_MUSCL) < 0.006);
}

// In the field v = (k x1 - w x2, w x1 + k x2) a density turns by w t and widens by e^(k t) in both directions:
//     rho(x, t) = e^(-2 k t) rho0( e^(-k t) R(-w t) x ).
static const double turn = 1.0, growth = 0.3;

static double exact_in_spiral(double x1, double x2, double t)
{
    const double c = cos(turn * t), s = sin(turn * t), scale = exp(-growth * t);
    const double from1 = scale * (c * x1 + s * x2), from2 = scale * (c * x2 - s * x1);

    return scale * scale * helper_macro_bump(from1 - 0.18, from2 - 0.05, 0.07);
}

// L1 error at t = 1 s of n x n cells of a square of 1 m about the origin.
static double error_in_spiral(size_t n)
{
    const double cell = 1.0 / (double)n;
    world w = make_world(n, n, cell);
    bf_grid *g = &w.def.grid;
    double error = 0.0;

    g->lower1 = g->lower2 = -0.5;
    w.def.dt = 0.25 * cell;
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i <= n; i++)
            w.v1[j * (n + 1) + i] = growth * (g->lower1 + (double)i * cell) - turn * grid_x2(g, j);
    for (size_t j = 0; j <= n; j++)
        for (size_t i = 0; i < n; i++)
            w.v2[j * n + i] = turn * grid_x1(g, i) + growth * (g->lower2 + (double)j * cell);
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < n; i++)
            w.rho[j * n + i] = exact_in_spiral(grid_x1(g, i), grid_x2(g, j), 0.0);
    macro_solver *s = start(&w);
    helper_macro_advance(s, 4 * (int)n);
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < n; i++)
            error += cell * cell *
                     fabs(macro_row(s, j)[i] - exact_in_spiral(grid_x1(g, i), grid_x2(g, j), 1.0));
    macro_destroy(s);
    free_world(&w);
    return error;
}

static void smooth_density_is_carried_with_second_order_in_a_field_that_turns_and_widens(
    void **state)
{
    double coarse = error_in_spiral(100), fine = error_in_spiral(200);

    assert_true(log2(coarse / fine) >= 1.8);
}

// A turning field has no divergence, on the faces of the cells either: what is constant stays so. A sweep along one
// axis after the other would not see that.
static void a_constant_density_stays_constant_in_a_turning_field(void **state)
{
    enum { N = 40 };
    world w = make_world(N, N, 0.01);
    w.def.dt = 0.02;
    for (size_t j = 0; j < N; j++)
        for (size_t i = 0; i <= N; i++)
            w.v1[j * (N + 1) + i] = -0.5 * (grid_x2(&w.def.grid, j) - 0.2);
    for (size_t j = 0; j <= N; j++)
        for (size_t i = 0; i < N; i++)
            w.v2[j * N + i] = 0.5 * (grid_x1(&w.def.grid, i) - 0.2);
    for (size_t k = 0; k < (size_t)N * N; k++)
        w.rho[k] = 0.7;
    macro_solver *s = start(&w);
    // What comes in at the edges is empty and moves by two cells a step at most.
    helper_macro_advance(s, 6);
    for (size_t j = 12; j < N - 12; j++)
        for (size_t i = 12; i < N - 12; i++)
            assert_true(fabs(macro_row(s, j)[i] - 0.7) < 1e-15);
    macro_destroy(s);
    free_world(&w);
}

// Harten: on a belt of one velocity no cell leaves the range of its neighbours while
// (1 + theta/2) dt v/dx <= 1, dt v/dx <= 4/7.
static void blocks_of_cargo_get_no_new_extrema(void **state)
{
    world w = make_world(120, 1, 5e-3);
    w.def.dt = 0.99 * 4.0 / 7.0 * 5e-3 / 0.4;
    // A stage takes the speed along both axes for the bound of stability; across there is none.
    carry_along_x1(&w, 0.4);
    for (size_t i = 10; i < 30; i++)
        w.rho[i] = i < 20 ? 0.6 : 0.2;
    macro_solver *s = start(&w);
    for (int step = 0; step < 100; step++) {
        macro_step(s);
        for (size_t i = 0; i < 120; i++)
            assert_true(macro_row(s, 0)[i] >= 0.0 && macro_row(s, 0)[i] <= 0.6 * (1.0 + 1e-15));
    }
    macro_destroy(s);
    free_world(&w);
}

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

static void assert_nowhere_negative(const macro_solver *s, const bf_grid *g)
{
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            assert_true(macro_row(s, j)[i] >= 0.0);
}

// Below dt = dx / (4 (eps + |v|)) no quarter of a cell can lose more than it has through its face, whatever the field.
static void density_stays_positive_below_the_bound_in_any_field(void **state)
{
    enum { N1 = 60, N2 = 24 };
    const double speed = 0.4, dispersion = 0.8;
    for (unsigned seed = 1; seed <= 6; seed++) {
        world w = make_world(N1, N2, 5e-3);
        srand(seed);
        w.def.mollifier = 10000.0;
        w.def.dispersion = dispersion;
        w.def.heaviside = (scene_heaviside)(seed % SCENE_HEAVISIDE_COUNT);
        w.def.dt = (1.0 - 1e-9) * 5e-3 / (4.0 * (dispersion + speed));
        for (size_t k = 0; k < (N1 + 1) * N2; k++)
            w.v1[k] = rand() % 2 == 0 ? speed : -speed;
        for (size_t k = 0; k < N1 * (N2 + 1); k++)
            w.v2[k] = rand() % 2 == 0 ? speed : -speed;
        for (size_t k = 0; k < (size_t)N1 * N2; k++)
            w.rho[k] = rand() % 3 == 0 ? 0.0 : uniform(0.0, 3.0);
        macro_solver *s = start(&w);
        for (int step = 0; step < 100; step++) {
            macro_step(s);
            assert_nowhere_negative(s, &w.def.grid);
        }
        macro_destroy(s);
        free_world(&w);
    }
}

// One cell from which everything flows away at full speed. Between empty cells it has no slope, so a stage leaves
// 1 - 4 dt v/dx of it, and the step the mean of 1 and the square of that: 1/2 at the bound of positivity, and 1 again at
// that of stability, beyond which a step is refused.
static void the_bounds_are_those_of_a_cell_that_empties_through_all_its_faces(void **state)
{
    enum { N = 9, MIDDLE = 4 };
    static const double parts_of_stable[] = { 0.5, 0.75, 1.0 };
    for (int k = 0; k < 3; k++) {
        world w = make_world(N, N, 0.01);
        w.v1[MIDDLE * (N + 1) + MIDDLE] = w.v2[MIDDLE * N + MIDDLE] = -0.5;
        w.v1[MIDDLE * (N + 1) + MIDDLE + 1] = w.v2[(MIDDLE + 1) * N + MIDDLE] = 0.5;
        w.rho[MIDDLE * N + MIDDLE] = 0.8;
        w.def.dt = parts_of_stable[k] * 0.01 / (2.0 * 0.5);
        macro_solver *s = start(&w);
        const double left = 1.0 - 2.0 * parts_of_stable[k];
        macro_step(s);
        assert_true(fabs(macro_row(s, MIDDLE)[MIDDLE] - 0.8 * 0.5 * (1.0 + left * left)) < 1e-15);
        macro_destroy(s);
        free_world(&w);
    }
}

static void an_unstable_step_is_refused_with_the_largest_stable_one(void **state)
{
    world w = make_world(20, 20, 5e-3);
    macro_solver *s = NULL;
    bf_error err = { 0 };
    // dt ((0.4 + 0.8)/dx + 0.8/dx) <= 1: 2.5 ms.
    w.def.dispersion = 0.8;
    carry_along_x1(&w, 0.4);
    w.def.dt = 0.00251;
    assert_int_equal(macro_create(&w.def, &s, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/macro/step_s");
    assert_non_null(strstr(err.text, "(CFL) is 0.0025 s"));
    w.def.dt = 0.0025;
    assert_int_equal(macro_create(&w.def, &s, NULL), BF_OK);
    macro_destroy(s);
    free_world(&w);
}

// Both axes are treated alike: a scene that is mirrored at the diagonal gives the mirrored density, up to the order of
// sums. The densities stay below 1, so that rounding cannot change H.
static void a_transposed_scene_gives_the_transposed_density(void **state)
{
    enum { N = 30 };
    world w = make_world(N, N, 5e-3), t = make_world(N, N, 5e-3);
    uint8_t closed1[(N + 1) * N] = { 0 }, closed2[(N + 1) * N] = { 0 };
    uint8_t turned1[(N + 1) * N] = { 0 }, turned2[(N + 1) * N] = { 0 };
    srand(5);
    for (size_t j = 0; j < N; j++)
        for (size_t i = 0; i <= N; i++) {
            size_t face1 = j * (N + 1) + i, face2 = i * N + j;
            t.v2[face2] = w.v1[face1] = uniform(-0.4, 0.4);
            t.v1[face1] = w.v2[face2] = uniform(-0.4, 0.4);
            turned2[face2] = closed1[face1] = rand() % 10 == 0;
            turned1[face1] = closed2[face2] = rand() % 10 == 0;
        }
    for (size_t j = 0; j < N; j++)
        for (size_t i = 0; i < N; i++)
            t.rho[i * N + j] = w.rho[j * N + i] = uniform(0.0, 0.2);
    w.def.faces[0].closed = closed1;
    w.def.faces[1].closed = closed2;
    t.def.faces[0].closed = turned1;
    t.def.faces[1].closed = turned2;
    macro_solver *s = start(&w), *turned = start(&t);
    helper_macro_advance(s, 20);
    helper_macro_advance(turned, 20);
    assert_true(macro_measure(s).peak < 1.0);
    for (size_t j = 0; j < N; j++)
        for (size_t i = 0; i < N; i++)
            assert_true(fabs(macro_row(s, j)[i] - macro_row(turned, i)[j]) < 1e-13);
    macro_destroy(s);
    macro_destroy(turned);
    free_world(&w);
    free_world(&t);
}

// Parts of the mass of a heap that have passed x1 = 1 m by t: the heap's deviation is 5 cm, its way there 0.6 m.
static double passed(double t, double belt)
{
    return 0.5 * erfc((0.6 - belt * t) / (0.05 * sqrt(2.0)));
}

static void cargo_leaves_over_an_open_edge_and_none_comes_in(void **state)
{
    world w = make_world(200, 1, 5e-3);
    w.def.dt = 2.5e-3;
    carry_along_x1(&w, 0.4);
    for (size_t i = 0; i < 200; i++)
        w.rho[i] = helper_macro_bump(grid_x1(&w.def.grid, i) - 0.4, 0.0, 0.05);
    macro_solver *s = start(&w);
    const double before = macro_measure(s).mass;
    for (int k = 0; k < 12; k++) {
        double expected = before * (1.0 - passed(macro_time(s), 0.4));
        assert_true(fabs(macro_measure(s).mass - expected) < 0.01 * before);
        helper_macro_advance(s, 80);
    }
    assert_true(macro_measure(s).mass < 1e-3 * before);
    macro_destroy(s);
    free_world(&w);
}

// A closed face stands between a jam and an empty half: no slope sees through it, so the empty side stays exactly
// empty, and the full one is as if there were no other.
static void nothing_is_seen_through_a_closed_face(void **state)
{
    enum { N1 = 24, N2 = 6 };
    world w = make_world(N1, N2, 5e-3);
    uint8_t closed1[(N1 + 1) * N2] = { 0 };
    w.def.dt = 2e-3;
    carry_along_x1(&w, 0.4);
    for (size_t j = 0; j < N2; j++)
        closed1[j * (N1 + 1) + 12] = 1;
    w.def.faces[0].closed = closed1;
    for (size_t j = 0; j < N2; j++)
        for (size_t i = 0; i < 12; i++)
            w.rho[j * N1 + i] = 0.1 + 0.05 * (double)i;
    macro_solver *alone = start(&w);
    for (size_t j = 0; j < N2; j++)
        for (size_t i = 12; i < N1; i++)
            w.rho[j * N1 + i] = 0.9;
    macro_solver *beside = start(&w);
    helper_macro_advance(alone, 30);
    helper_macro_advance(beside, 30);
    for (size_t j = 0; j < N2; j++) {
        assert_memory_equal(macro_row(alone, j), macro_row(beside, j), 12 * sizeof(double));
        for (size_t i = 12; i < N1; i++)
            assert_true(macro_row(alone, j)[i] == 0.0);
    }
    macro_destroy(alone);
    macro_destroy(beside);
    free_world(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_heap_on_a_free_belt_keeps_its_shape),
        cmocka_unit_test(
            smooth_density_is_carried_with_second_order_in_a_field_that_turns_and_widens),
        cmocka_unit_test(a_constant_density_stays_constant_in_a_turning_field),
        cmocka_unit_test(blocks_of_cargo_get_no_new_extrema),
        cmocka_unit_test(density_stays_positive_below_the_bound_in_any_field),
        cmocka_unit_test(the_bounds_are_those_of_a_cell_that_empties_through_all_its_faces),
        cmocka_unit_test(an_unstable_step_is_refused_with_the_largest_stable_one),
        cmocka_unit_test(a_transposed_scene_gives_the_transposed_density),
        cmocka_unit_test(cargo_leaves_over_an_open_edge_and_none_comes_in),
        cmocka_unit_test(nothing_is_seen_through_a_closed_face),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
