// The congested closure: free cargo, compaction, mass, symmetry, bad input. Expected values are derived. What threads,
// instruction sets and checkpoints must not change is in test_congested_state.c.

#include "core/base/memory.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "tests/unit/core/helper_congested.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const scene_pose somewhere = { 0.1, 0.1, 0.0 };
static const scene_rect everywhere = { -10.0, 10.0, -10.0, 10.0 };

static void close_edges(scene *s)
{
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = SCENE_EDGE_WALL;
}

static void assert_nowhere_negative(const macro_solver *s)
{
    const bf_grid *g = &s->def.grid;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            assert_true(macro_row(s, j)[i] >= 0.0);
}

// Upwind transport of cell (i, j) by a velocity >= 0, in Courant numbers.
static double carried(const bf_grid *g, const double *rho, size_t i, size_t j, vec2 courant)
{
    const double here = rho[j * g->n1 + i];
    const double west = i > 0 ? rho[j * g->n1 + i - 1] : 0.0;
    const double south = j > 0 ? rho[(j - 1) * g->n1 + i] : 0.0;

    return here - courant.x * (here - west) - courant.y * (here - south);
}

static void carry(const bf_grid *g, double *rho, double *next, vec2 courant)
{
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            next[j * g->n1 + i] = carried(g, rho, i, j, courant);
    memcpy(rho, next, grid_cells(g) * sizeof *rho);
}

// Transport by one velocity takes means of neighbours, so no cell ever reaches rho_j.
static void check_free_cargo(vec2 velocity)
{
    scene s;

    helper_scene_belt(&s, 0.8, 0.43, 0.01, &somewhere, 1);
    s.macro.closure = SCENE_CONGESTED;
    helper_scene_add_belt(&s, velocity, NULL, 0);
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s.edges[side] = SCENE_EDGE_OUTFLOW;
    helper_scene_resolve(&s);
    const bf_grid g = scene_grid(&s);
    double *rho = memory_alloc(grid_cells(&g), sizeof *rho);
    double *next = memory_alloc(grid_cells(&g), sizeof *next);
    macro_solver *solver = helper_macro_create(&s, 1);
    const vec2 courant = vec2_scale(velocity, scene_macro_step(&s) / 0.01);
    srand(3);
    for (size_t k = 0; k < grid_cells(&g); k++)
        rho[k] = rand() % 3 == 0 ? 0.0 : 0.899 * rand() / RAND_MAX;
    macro_set_density(solver, rho);
    for (int step = 0; step < 60; step++) {
        macro_step(solver);
        carry(&g, rho, next, courant);
        for (size_t j = 0; j < g.n2; j++)
            for (size_t i = 0; i < g.n1; i++)
                assert_near(macro_row(solver, j)[i], rho[j * g.n1 + i], 1e-14);
    }
    macro_destroy(solver);
    memory_free(rho);
    memory_free(next);
    scene_fini(&s);
}

static void free_cargo_is_carried_and_nothing_else(void **state)
{
    check_free_cargo((vec2){ 0.4, 0.0 });
    check_free_cargo((vec2){ 0.3, 0.2 });
    check_free_cargo((vec2){ 0.0, 0.4 });
}

// A belt of 1.2 m x 8 cm that runs along its long axis into a wall.
static void make_column(scene *s, double jam_density)
{
    helper_scene_belt(s, 1.2, 0.08, 0.01, &somewhere, 1);
    s->macro.closure = SCENE_CONGESTED;
    s->macro.jam_density = jam_density;
    s->edges[SCENE_EAST] = SCENE_EDGE_WALL;
    helper_scene_resolve(s);
}

// Where the density of a row rises from one level to another, m: the mass behind a sharp front.
static double front_of(const macro_solver *s, size_t row, double before, double behind)
{
    const bf_grid *g = &s->def.grid;
    double excess = 0.0;

    for (size_t i = g->n1 / 2; i < g->n1; i++)
        excess += (macro_row(s, row)[i] - before) * g->d1;
    return g->lower1 + (double)g->n1 * g->d1 - excess / (behind - before);
}

// Steps until the jam's front or the empty end of the column has come 0.3 m, so that they stay apart.
static void grow(macro_solver *s, double speed, double belt)
{
    while (fmax(speed, belt) * macro_time(s) < 0.3)
        macro_step(s);
}

// What arrives, rho_0 v, and what the front passes, rho_0 w, becomes rho_j w: w = rho_0 v/(rho_j - rho_0).
static void check_compaction(double density, double jam_density)
{
    const double belt = 0.395, speed = density * belt / (jam_density - density);
    scene s;

    make_column(&s, jam_density);
    macro_solver *solver = helper_macro_create(&s, 1);
    helper_congested_fill(&s, everywhere, density, solver);
    grow(solver, speed, belt);
    const double front = 1.2 - speed * macro_time(solver);
    for (size_t row = 0; row < 8; row++) {
        assert_near(front_of(solver, row, density, jam_density), front, 0.01);
        for (size_t i = 60; i < 120; i++) {
            const double x = ((double)i + 0.5) * 0.01, rho = macro_row(solver, row)[i];
            // The front is in one cell.
            if (x > front + 0.01)
                assert_near(rho, jam_density, 0.01 * jam_density);
            if (x < front - 0.01)
                assert_near(rho, density, 1e-6);
        }
    }
    macro_destroy(solver);
    scene_fini(&s);
}

static void a_jam_at_a_wall_grows_by_what_arrives(void **state)
{
    check_compaction(0.2, 0.9);
    check_compaction(0.45, 0.9);
    check_compaction(0.35, 0.7);
}

// Densities stay below this, whatever the pressure leaves.
static const double most_density = 1.1;

static void mass_is_conserved_in_a_closed_box(void **state)
{
    for (int axis = 0; axis < 2; axis++) {
        scene s;
        helper_congested_saturated(&s, 60.0);
        close_edges(&s);
        s.belts[0].velocity = axis == 0 ? (vec2){ 0.395, 0.0 } : (vec2){ 0.28, -0.28 };
        macro_solver *solver = helper_macro_start(&s, 1);
        const double mass = macro_measure(solver).mass;
        for (int step = 0; step < HELPER_AMOUNT(600, 100); step++) {
            macro_step(solver);
            assert_nowhere_negative(solver);
            assert_true(macro_measure(solver).peak <= most_density);
        }
        assert_near(macro_measure(solver).mass, mass, 1e-12 * mass);
        assert_int_equal(macro_check(solver, NULL), BF_OK);
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// A solver of this density everywhere, whose cells are longer along x2 by a quarter, and the domain with them.
static macro_solver *start_stretched(const scene *s, double density)
{
    velocity_field *f = helper_macro_field(s);
    macro_def def = helper_macro_def(s, f);
    double *rho = memory_alloc(grid_cells(&def.grid), sizeof *rho);

    assert_non_null(rho);
    for (size_t k = 0; k < grid_cells(&def.grid); k++)
        rho[k] = density;
    def.grid.d2 *= 1.25;
    macro_solver *solver = helper_macro_start_with(&def, rho);
    memory_free(rho);
    velocity_field_destroy(f);
    return solver;
}

static void mass_is_conserved_in_cells_that_are_not_square(void **state)
{
    static const vec2 velocities[] = { { 0.395, 0.0 }, { 0.28, -0.28 }, { 0.0, 0.395 } };

    for (size_t k = 0; k < sizeof velocities / sizeof *velocities; k++) {
        scene s;
        helper_congested_saturated(&s, 60.0);
        close_edges(&s);
        s.belts[0].velocity = velocities[k];
        macro_solver *solver = start_stretched(&s, 0.6);
        const double mass = macro_measure(solver).mass;
        for (int step = 0; step < HELPER_AMOUNT(300, 60); step++) {
            macro_step(solver);
            assert_nowhere_negative(solver);
            assert_true(macro_measure(solver).peak <= most_density);
        }
        assert_near(macro_measure(solver).mass, mass, 1e-12 * mass);
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// As in check_compaction(), along x2: the jam's front at a wall, 1.5 m of cells of 12.5 mm away.
static void a_jam_grows_alike_in_cells_that_are_not_square(void **state)
{
    const double density = 0.45, jam_density = 0.9,
                 speed = density * 0.395 / (jam_density - density);
    scene s;

    helper_scene_belt(&s, 0.08, 1.2, 0.01, &somewhere, 1);
    s.macro.closure = SCENE_CONGESTED;
    s.macro.jam_density = jam_density;
    helper_scene_add_belt(&s, (vec2){ 0.0, 0.395 }, NULL, 0);
    s.edges[SCENE_WEST] = s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    s.edges[SCENE_SOUTH] = SCENE_EDGE_INFLOW;
    helper_scene_resolve(&s);
    macro_solver *solver = start_stretched(&s, density);
    grow(solver, speed, 0.395);
    const double front = 1.5 - speed * macro_time(solver);
    for (size_t row = 60; row < 120; row++) {
        const double y = ((double)row + 0.5) * 0.0125, rho = macro_row(solver, row)[4];
        if (y > front + 0.0125)
            assert_near(rho, jam_density, 0.01 * jam_density);
        if (y < front - 0.0125)
            assert_near(rho, density, 1e-6);
    }
    macro_destroy(solver);
    scene_fini(&s);
}

// What a step took over the west and east edges, m2: carried by the belt from the densities before it, and corrected.
static double carried_out(const macro_solver *s)
{
    const bf_grid *g = &s->def.grid;
    double rate = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        rate += macro__row(s, s->faces1.v, (ptrdiff_t)j)[g->n1 - 1] * macro_row(s, j)[g->n1 - 1];
    return rate * s->def.dt * g->d2;
}

static double corrected_out(const macro_solver *s)
{
    const bf_grid *g = &s->def.grid;
    const congested *c = s->congested;
    double rate = 0.0;

    for (ptrdiff_t j = 0; j < (ptrdiff_t)g->n2; j++)
        rate += (double)*CONGESTED_FACE1(c, flux, (ptrdiff_t)g->n1, j) -
                (double)*CONGESTED_FACE1(c, flux, 0, j);
    return rate * s->def.dt * g->d2;
}

static void check_outlet(void (*make)(scene *s, double angle_deg), double angle_deg)
{
    scene s;

    make(&s, angle_deg);
    macro_solver *solver = helper_macro_start(&s, 1);
    const double mass = macro_measure(solver).mass;
    double left = 0.0;
    for (int step = 0; step < HELPER_AMOUNT(600, 150); step++) {
        left += carried_out(solver);
        macro_step(solver);
        left += corrected_out(solver);
        assert_nowhere_negative(solver);
        assert_true(macro_measure(solver).peak <= most_density);
        assert_near(macro_measure(solver).mass + left, mass, 1e-12 * mass);
    }
    assert_true(left > HELPER_AMOUNT(0.3, 0.0) * mass);
    macro_destroy(solver);
    scene_fini(&s);
}

static void what_is_not_on_the_belt_has_left_over_its_end(void **state)
{
    check_outlet(helper_congested_example, 60.0);
    check_outlet(helper_congested_example, 90.0);
    check_outlet(helper_congested_saturated, 60.0);
    check_outlet(helper_congested_saturated, 90.0);
}

// A thin stream of density rho_0 = 0.05 comes against a plate at 60 degrees. As far as it comes from the wall to y, it goes along
// the plate in a layer that is packed and moves at v_T cos(theta), h = rho_0 y/(rho_j cos(theta)) thick; beyond it there is the stream alone.
// So what is in the way of the layer is h/2 from the plate; cells count by their centres, within a cell's diagonal.
static void check_thin_stream(scene_scheme scheme)
{
    const double stream = 0.05, cosine = 0.5, sine = sqrt(0.75), cell = 0.01, top = 0.2;
    const double layer = stream * top / (0.93 * cosine); // at y = top
    const vec2 path[] = { { 1.0, 0.0 }, { 1.0 + 0.3 / sqrt(3.0), 0.3 } };
    double weight = 0.0, away = 0.0, beyond = 0.0;
    scene s;

    helper_scene_belt(&s, 1.4, 0.4, cell, &somewhere, 1);
    s.macro.closure = SCENE_CONGESTED;
    s.macro.scheme = scheme;
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, NULL, 0);
    helper_scene_add_obstacle(&s, path, 2, SCENE_WALL);
    helper_scene_resolve(&s);
    macro_solver *solver = helper_macro_create(&s, 1);
    helper_congested_fill(&s, everywhere, stream, solver);
    while (macro_time(solver) < 1.5)
        macro_step(solver);
    for (size_t j = 0; grid_x2(&solver->def.grid, j) < top; j++)
        for (size_t i = 0; i < solver->def.grid.n1; i++) {
            const double x = grid_x1(&solver->def.grid, i), y = grid_x2(&solver->def.grid, j);
            const double d = (1.0 - x) * sine + y * cosine, more = macro_row(solver, j)[i] - stream;
            if (x < 0.8 || d < 0.0)
                continue;
            weight += more;
            away += more * d;
            beyond = d > layer + 2.0 * cell ? fmax(beyond, fabs(more)) : beyond;
        }
    // The mean over y of h/2, weighted by h.
    assert_near(away / weight, layer / 3.0, cell);
    assert_near(beyond, 0.0, 0.1 * stream);
    macro_destroy(solver);
    scene_fini(&s);
}

static void a_thin_stream_lies_against_a_plate(void **state)
{
    check_thin_stream(SCENE_SCHEME_ROE);
    check_thin_stream(SCENE_SCHEME_MUSCL);
}

// A heap that a plate turns aside. What lies beside the plate slides at v_T cos(theta), however little it is, so that nothing stays there;
// before the extension of the plate's end some does.
static void check_last_of_heap(double angle_deg, bool is_back)
{
    const double angle = angle_deg * M_PI / 180.0, speed = 0.4, cell = 0.01, top = 0.2, foot = 0.5;
    const double tip = foot + top / tan(angle);
    const double time = foot / speed + top / sin(angle) / (speed * cos(angle)) + 0.3 / speed;
    const double end = tip + 0.2, near = is_back ? end - 0.1 : 0.1, far = is_back ? end - 0.3 : 0.3;
    const vec2 path[] = { { is_back ? end - foot : foot, 0.0 },
                          { is_back ? end - tip : tip, top } };
    const scene_rect heap = { fmin(near, far), fmax(near, far), 0.0, top };
    scene s;

    helper_scene_belt(&s, end, 0.5, cell, &somewhere, 1);
    s.macro.closure = SCENE_CONGESTED;
    s.edges[SCENE_WEST] = s.edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    helper_scene_add_belt(&s, (vec2){ is_back ? -speed : speed, 0.0 }, NULL, 0);
    helper_scene_add_obstacle(&s, path, 2, SCENE_WALL);
    helper_scene_resolve(&s);
    macro_solver *solver = helper_macro_create(&s, 1);
    helper_congested_fill(&s, heap, 0.5, solver);
    while (macro_time(solver) < 2.0 * time)
        macro_step(solver);
    for (size_t j = 0; grid_x2(&solver->def.grid, j) < top - 2.0 * cell; j++)
        for (size_t i = 0; i < solver->def.grid.n1; i++)
            assert_true(macro_row(solver, j)[i] < 1e-3);
    macro_destroy(solver);
    scene_fini(&s);
}

static void nothing_of_a_heap_stays_beside_a_plate(void **state)
{
    const double angles_deg[] = { 30.0, 45.0, 52.0, 60.0, 75.0 };

    for (int k = 0; k < 5; k++)
        check_last_of_heap(angles_deg[k], k % 2 != 0);
}

// What slides along them comes from, or leaves to, beyond the grid.
static void plates_may_begin_and_end_at_open_sides(void **state)
{
    const vec2 directions[] = {
        { 0.4, 0.0 }, { -0.4, 0.0 }, { 0.0, 0.4 }, { 0.0, -0.4 }, { 0.3, -0.2 }
    };
    const vec2 rising[] = { { 0.0, 0.0 }, { 0.4, 0.4 } },
               falling[] = { { 0.02, 0.38 }, { 0.38, 0.02 } };

    for (size_t k = 0; k < 5; k++) {
        scene s;
        helper_scene_belt(&s, 0.4, 0.4, 0.01, &somewhere, 1);
        s.macro.closure = SCENE_CONGESTED;
        for (int side = 0; side < SCENE_SIDE_COUNT; side++)
            s.edges[side] = SCENE_EDGE_OUTFLOW;
        helper_scene_add_belt(&s, directions[k], NULL, 0);
        helper_scene_add_obstacle(&s, rising, 2, SCENE_WALL);
        helper_scene_add_obstacle(&s, falling, 2, SCENE_WALL);
        helper_scene_resolve(&s);
        macro_solver *solver = helper_macro_create(&s, 1);
        helper_congested_fill(&s, everywhere, 0.5, solver);
        const double mass = macro_measure(solver).mass;
        while (macro_time(solver) < 0.5)
            macro_step(solver);
        assert_true(macro_measure(solver).mass < mass);
        assert_nowhere_negative(solver);
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// Packed cargo on a belt of 0.4 m/s, L long, goes onto one that all but stands across its way, is full over its width D, and ends
// in an open edge. All moves at u: the first belt drives it by chi (v - u) over L, the other one brakes it by u over D. So
// u = chi v L/(chi L + D), and as dL/dt = -u, chi (L_0 - L) + D ln(L_0/L) = chi v t. The first belt has these corners, or lies
// everywhere, also under the second one.
static void check_transfer(const vec2 *corners, size_t n_corners)
{
    const double v = 0.4, chi = 10.0 * v / tanh(10.0 * v), border = 0.5, end = 0.7;
    const double from = 0.4, to = 0.25, width = 0.1, across = end - border;
    const double time = (chi * (from - to) + across * log(from / to)) / (chi * v);
    const vec2 second[] = { { border, 0.0 }, { end, 0.0 }, { end, width }, { border, width } };
    scene s;

    helper_scene_belt(&s, end, width, 0.01, &somewhere, 1);
    s.macro.closure = SCENE_CONGESTED;
    close_edges(&s);
    s.edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    helper_scene_add_belt(&s, (vec2){ v, 0.0 }, corners, n_corners);
    helper_scene_add_belt(&s, (vec2){ 0.0, 0.001 }, second, 4);
    helper_scene_resolve(&s);
    macro_solver *solver = helper_macro_create(&s, 1);
    helper_congested_fill(&s, (scene_rect){ border - from, end, 0.0, width }, 0.93, solver);
    const double mass = macro_measure(solver).mass;
    while (macro_time(solver) < time)
        macro_step(solver);
    const double gone = mass - macro_measure(solver).mass;
    assert_near(gone, 0.93 * width * (from - to), 0.03 * gone);
    macro_destroy(solver);
    scene_fini(&s);
}

static void what_comes_onto_another_belt_is_braked_less_than_slip_by_slip(void **state)
{
    const vec2 first[] = { { 0.0, 0.0 }, { 0.5, 0.0 }, { 0.5, 0.1 }, { 0.0, 0.1 } };

    check_transfer(first, 4);
    check_transfer(NULL, 0);
}

// A full belt of n x n cells that runs against a closed end, both of its sides open.
static void check_open_sides(vec2 velocity, size_t n)
{
    static const double left = 0.012; // above rho_j: the iteration leaves 0.006 a step
    const bool is_along_x = velocity.x != 0.0;
    const double edge = 0.01 * (double)n;
    scene s;

    helper_scene_belt(&s, edge, edge, 0.01, &somewhere, 1);
    s.macro.closure = SCENE_CONGESTED;
    s.edges[SCENE_WEST] = s.edges[SCENE_EAST] = is_along_x ? SCENE_EDGE_WALL : SCENE_EDGE_OUTFLOW;
    s.edges[SCENE_SOUTH] = s.edges[SCENE_NORTH] = is_along_x ? SCENE_EDGE_OUTFLOW : SCENE_EDGE_WALL;
    helper_scene_add_belt(&s, velocity, NULL, 0);
    helper_scene_resolve(&s);
    macro_solver *solver = helper_macro_create(&s, 1);
    helper_congested_fill(&s, everywhere, 0.93, solver);
    while (macro_time(solver) < 0.5) {
        const double before = macro_measure(solver).mass;
        macro_step(solver);
        assert_true(macro_measure(solver).mass < before);
        // The pressures of a whole heap that comes to stop take more than one step.
        assert_true(macro_time(solver) < 0.1 || macro_measure(solver).peak <= 0.93 + left);
    }
    assert_nowhere_negative(solver);
    macro_destroy(solver);
    scene_fini(&s);
}

// Of the cells at the sides of the grid every second one is black, with a face of a cell beyond the grid.
static void what_is_pushed_against_a_closed_end_leaves_over_every_cell_of_open_sides(void **state)
{
    const vec2 directions[] = { { 0.4, 0.0 }, { -0.4, 0.0 }, { 0.0, 0.4 }, { 0.0, -0.4 } };
    const size_t n[] = { 31, 32, 33 }; // cells 31 and 32 of a row are in different units

    for (size_t k = 0; k < 4; k++)
        for (size_t m = 0; m < 3; m++)
            check_open_sides(directions[k], n[m]);
}

// Plates from wall to wall; the belt moves straight or obliquely.
static void nothing_leaks_through_a_plate_that_closes_the_belt(void **state)
{
    static const double angles[] = { 35.0, 60.0, 90.0, 120.0 };
    for (size_t k = 0; k < 2 * sizeof angles / sizeof *angles; k += HELPER_AMOUNT(1, 3)) {
        const double angle = angles[k / 2] * M_PI / 180.0;
        const vec2 path[] = { { 0.9 - 0.3 / tan(angle), 0.0 }, { 0.9 + 0.3 / tan(angle), 0.6 } };
        const vec2 along = vec2_sub(path[1], path[0]);
        scene s;
        helper_scene_belt(&s, 1.8, 0.6, 0.01, &somewhere, 1);
        s.macro.closure = SCENE_CONGESTED;
        helper_scene_add_obstacle(&s, path, 2, SCENE_WALL);
        helper_scene_add_belt(&s, k % 2 == 0 ? (vec2){ 0.4, 0.0 } : (vec2){ 0.35, 0.15 }, NULL, 0);
        helper_scene_resolve(&s);
        macro_solver *solver = helper_macro_create(&s, 1);
        helper_congested_fill(&s, (scene_rect){ 0.05, 0.4, 0.05, 0.55 }, 0.8, solver);
        helper_macro_advance(solver, HELPER_AMOUNT(400, 150));
        const bf_grid g = scene_grid(&s);
        size_t n_behind = 0;
        for (size_t j = 0; j < g.n2; j++)
            for (size_t i = 0; i < g.n1; i++) {
                const vec2 to = vec2_sub((vec2){ grid_x1(&g, i), grid_x2(&g, j) }, path[0]);
                if (vec2_cross(along, to) > -1e-9)
                    continue;
                n_behind++;
                assert_true(macro_row(solver, j)[i] == 0.0);
            }
        assert_true(n_behind > 1000);
        assert_true(macro_measure(solver).peak <= most_density);
        macro_destroy(solver);
        scene_fini(&s);
    }
}

// Largest difference of two densities: cell (i, j) of one is (i, n2 - 1 - j) or, if transposed, (j, i) of the other.
static double largest_difference(const macro_solver *a, const macro_solver *b, bool is_transposed)
{
    const bf_grid *g = &a->def.grid;
    double largest = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            const double other =
                is_transposed ? macro_row(b, i)[j] : macro_row(b, g->n2 - 1 - j)[i];
            largest = fmax(largest, fabs(macro_row(a, j)[i] - other));
        }
    return largest;
}

// An oblique plate before which a heap jams, in a box with an open end at x1 = 1 m, and its image. Mirrored: in the
// middle line; transposed: in the diagonal, so that the belt runs along +x2.
static void make_image(scene *s, double width, bool is_image, bool is_transposed)
{
    vec2 path[] = { { 0.5, 0.0 }, { 0.7, 0.4 } };
    const bool is_turned = is_image && is_transposed;

    for (int k = 0; is_image && k < 2; k++)
        path[k] =
            is_transposed ? (vec2){ path[k].y, path[k].x } : (vec2){ path[k].x, width - path[k].y };
    helper_scene_belt(s, is_turned ? width : 1.0, is_turned ? 1.0 : width, 0.01, &somewhere, 1);
    s->macro.closure = SCENE_CONGESTED;
    close_edges(s);
    s->edges[is_turned ? SCENE_NORTH : SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    helper_scene_add_belt(s, is_turned ? (vec2){ 0.0, 0.4 } : (vec2){ 0.4, 0.0 }, NULL, 0);
    helper_scene_add_obstacle(s, path, 2, SCENE_WALL);
    helper_scene_resolve(s);
}

// Both runs side by side; the largest difference of their densities, and of the mass that has left, a part of all.
static void check_image(double width, bool is_transposed, double most_difference, double most_mass)
{
    const scene_rect heap = { 0.0, 0.45, 0.0, width }, turned = { 0.0, width, 0.0, 0.45 };
    scene s, image;

    make_image(&s, width, false, is_transposed);
    make_image(&image, width, true, is_transposed);
    macro_solver *solver = helper_macro_create(&s, 1);
    macro_solver *other = helper_macro_create(&image, 1);
    helper_congested_fill(&s, heap, 0.8, solver);
    helper_congested_fill(&image, is_transposed ? turned : heap, 0.8, other);
    const double mass = macro_measure(solver).mass;
    for (int k = 0; k < 40; k++) {
        helper_macro_advance(solver, 5);
        helper_macro_advance(other, 5);
        assert_true(largest_difference(solver, other, is_transposed) <= most_difference);
        assert_near(macro_measure(solver).mass, macro_measure(other).mass, most_mass * mass);
    }
    assert_true(macro_measure(solver).mass < 0.9 * mass);
    macro_destroy(solver);
    macro_destroy(other);
    scene_fini(&s);
    scene_fini(&image);
}

// What the iteration may leave of a density. Where red cells become red ones the order of its sums alone differs.
static const double left_of_density = 3e-3;

// With an even number of rows red cells become black ones, which are relaxed later: cells at the rim of the jam may differ,
// and what leaves by as much as the iteration leaves of the densities at the outlet.
static void a_mirrored_scene_gives_the_mirrored_density(void **state)
{
    check_image(0.51, false, left_of_density, 1e-5);
    check_image(0.5, false, 0.1, 1e-4);
}

// The belt along +x2 is computed by the laws for any direction, which are coupled.
static void a_belt_along_the_other_axis_gives_the_transposed_density(void **state)
{
    check_image(0.51, true, left_of_density, 1e-5);
    check_image(0.5, true, left_of_density, 1e-5);
}

// Against a wall comes rho v, and rho_j (1 + lateral) v is the most that a jam sends back: from two thirds more than
// rho_j on it grows without bound.
static void cargo_without_a_way_out_fails_with_place_and_time(void **state)
{
    scene s;
    bf_error err = { 0 };
    make_column(&s, 0.9);
    macro_solver *solver = helper_macro_create(&s, 1);
    helper_congested_fill(&s, everywhere, 2.0, solver);
    const double mass = macro_measure(solver).mass;
    assert_int_equal(macro_check(solver, NULL), BF_OK);
    while (macro_measure(solver).peak <= 2.0 * 2.0)
        macro_step(solver);
    assert_int_equal(macro_check(solver, &err), BF_ENUMERIC);
    char time[40];
    (void)snprintf(time, sizeof time, "(t = %.6g s)", macro_time(solver));
    assert_non_null(strstr(err.text, "at x = 1.195 m, y = "));
    assert_non_null(strstr(err.text, time));
    assert_near(macro_measure(solver).mass, mass, 1e-12 * mass);
    assert_nowhere_negative(solver);
    macro_destroy(solver);
    scene_fini(&s);
}

// The belt moves at 0.395 m/s along x1: a longer step would take more out of a cell than it holds.
static void an_unstable_step_is_refused(void **state)
{
    scene s;
    velocity_field *f = NULL;
    macro_solver *solver = NULL;
    bf_error err = { 0 };

    helper_congested_example(&s, 45.0);
    assert_int_equal(velocity_field_create(&s, &f, NULL), BF_OK);
    macro_def def = helper_macro_def(&s, f);
    def.dt = 1.501 * 0.01 / ((1.0 + 0.5) * 0.395);
    assert_int_equal(macro_create(&def, &solver, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/macro/step_s");
    assert_null(solver);
    // Were loose cargo carried twice as fast, no more than half of that step.
    for (size_t k = 0; k < (f->grid.n1 + 1) * f->grid.n2; k++)
        f->faces[0].loose[k] *= 2.0;
    def.dt = 0.75 * 0.01 / 0.395;
    assert_int_equal(macro_create(&def, &solver, &err), BF_EINPUT);
    velocity_field_destroy(f);
    scene_fini(&s);
}

static void out_of_memory_anywhere_is_an_error_and_nothing_leaks(void **state)
{
    scene s;

    helper_congested_example(&s, 60.0);
    helper_macro_lack_memory(&s);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_cargo_is_carried_and_nothing_else),
        cmocka_unit_test(a_jam_at_a_wall_grows_by_what_arrives),
        cmocka_unit_test(mass_is_conserved_in_a_closed_box),
        cmocka_unit_test(mass_is_conserved_in_cells_that_are_not_square),
        cmocka_unit_test(a_jam_grows_alike_in_cells_that_are_not_square),
        cmocka_unit_test(what_is_not_on_the_belt_has_left_over_its_end),
        cmocka_unit_test(a_thin_stream_lies_against_a_plate),
        cmocka_unit_test(nothing_of_a_heap_stays_beside_a_plate),
        cmocka_unit_test(plates_may_begin_and_end_at_open_sides),
        cmocka_unit_test(what_comes_onto_another_belt_is_braked_less_than_slip_by_slip),
        cmocka_unit_test(what_is_pushed_against_a_closed_end_leaves_over_every_cell_of_open_sides),
        cmocka_unit_test(nothing_leaks_through_a_plate_that_closes_the_belt),
        cmocka_unit_test(a_mirrored_scene_gives_the_mirrored_density),
        cmocka_unit_test(a_belt_along_the_other_axis_gives_the_transposed_density),
        cmocka_unit_test(cargo_without_a_way_out_fails_with_place_and_time),
        cmocka_unit_test(an_unstable_step_is_refused),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error_and_nothing_leaks),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
