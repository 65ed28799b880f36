// The macroscopic model on arcs. Exact solutions are those of a solid rotation; on straight belts of the same length the
// scheme is the same, test_muscl.c.

#include "core/macro/macro.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define INNER     0.2
#define OUTER     0.6
#define SPEED     0.4
#define DEVIATION 0.06 // of a heap, m

// An arc in a domain of 1.4 m x 1.4 m about the origin; cells of `cell`, the closure and the scheme as given.
static void make_scene(scene *s, double from, double to, double cell, scene_closure closure,
                       scene_scheme scheme)
{
    helper_scene_belt(s, 1.4, 1.4, cell, (scene_pose[]){ { 0.4, 0.0, 0.0 } }, 1);
    s->domain = (scene_rect){ -0.7, 0.7, -0.7, 0.7 };
    s->macro.closure = closure;
    s->macro.scheme = scheme;
    helper_scene_add_arc(s, SPEED, INNER, OUTER, from, to);
}

// A rail of pieces on the whole circle of this radius.
static void add_rail(scene *s, double radius, int n_pieces)
{
    vec2 rail[91];

    for (int k = 0; k <= n_pieces; k++) {
        const double at = 2.0 * M_PI * k / n_pieces;
        rail[k] = (vec2){ radius * cos(at), radius * sin(at) };
    }
    (void)helper_scene_add_obstacle(s, rail, (size_t)n_pieces + 1, SCENE_SEALED);
}

static bool is_on_ring(vec2 at)
{
    return vec2_length(at) >= INNER && vec2_length(at) <= OUTER;
}

static double half_full(const scene *s, vec2 at)
{
    return is_on_ring(at) ? 0.5 : 0.0;
}

static double full(const scene *s, vec2 at)
{
    return is_on_ring(at) ? 0.95 : 0.0;
}

static int steps_of_a_turn(const helper_macro_world *w)
{
    return (int)lround(2.0 * M_PI / fabs(w->s.belts[0].turn) / scene_macro_step(&w->s));
}

// The largest change of a density since the start.
static double largest_change(const helper_macro_world *w)
{
    const bf_grid *g = &w->f->grid;
    double largest = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            largest = fmax(largest, fabs(macro_row(w->solver, j)[i] - w->rho[j * g->n1 + i]));
    return largest;
}

// The flux out of a cell is the field's divergence times its area.
static void the_field_of_an_arc_is_free_of_divergence_and_crosses_no_border_and_no_guide(
    void **state)
{
    helper_macro_world w;

    make_scene(&w.s, 0.0, 360.0, 0.013, SCENE_CONGESTED, SCENE_SCHEME_ROE);
    add_rail(&w.s, 0.47, 90);
    helper_macro_world_init(&w, half_full, 1);
    const bf_grid *g = &w.f->grid;
    double passing = 0.0, fastest = 0.0, worst = 0.0;
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            const double *v1 = &w.f->faces[0].v[j * (g->n1 + 1) + i],
                         *v2 = &w.f->faces[1].v[j * g->n1 + i];
            const bool is_on = is_on_ring((vec2){ grid_x1(g, i), grid_x2(g, j) });
            const double out = (v1[1] - v1[0]) * g->d2 + (v2[g->n1] - v2[0]) * g->d1;
            worst = fmax(worst, fabs(out));
            assert_true(is_on || (v1[0] == 0.0 && v1[1] == 0.0));
            assert_true(is_on || (v2[0] == 0.0 && v2[g->n1] == 0.0));
            fastest = fmax(fastest, fmax(fabs(v1[0]), fabs(v2[0])));
            if (j == g->n2 / 2 && grid_x1(g, i) > 0.0)
                passing += v2[0] * g->d1;
        }
    assert_true(worst <= 2e-15);
    // What goes through a radius is the integral of turn r.
    assert_near(passing, 0.5 * w.s.belts[0].turn * (OUTER * OUTER - INNER * INNER), 1e-14);
    assert_true(fastest <= 1.25 * w.s.belts[0].turn * OUTER);
    helper_macro_world_fini(&w);
}

// What a cell loses in a second through all its faces, in cells: at most the diagonal that the step is made for.
static void no_cell_of_an_arc_is_emptied_in_a_step_wherever_its_rails_stand(void **state)
{
    static const double cells[] = { 0.035, 0.02, 0.013, 0.007 };
    static const double rails[] = { OUTER, OUTER - 0.003, OUTER - 0.02, INNER + 0.012, 0.52, 0.4 };
    double largest = 0.0;

    for (size_t k = 0; k < sizeof cells / sizeof *cells; k++)
        for (size_t m = 0; m < sizeof rails / sizeof *rails; m++) {
            helper_macro_world w;
            make_scene(&w.s, 0.0, 360.0, cells[k], SCENE_CONGESTED, SCENE_SCHEME_ROE);
            add_rail(&w.s, rails[m], 90);
            helper_macro_world_init(&w, half_full, 1); // which refuses a step that is too long
            const bf_grid *g = &w.f->grid;
            const double dt = scene_macro_step(&w.s);
            for (size_t j = 0; j < g->n2; j++)
                for (size_t i = 0; i < g->n1; i++) {
                    const double *v1 = &w.f->faces[0].v[j * (g->n1 + 1) + i],
                                 *v2 = &w.f->faces[1].v[j * g->n1 + i];
                    const double out = fmax(-v1[0], 0.0) + fmax(v1[1], 0.0) + fmax(-v2[0], 0.0) +
                                       fmax(v2[g->n1], 0.0);
                    largest = fmax(largest, out * dt / g->d1);
                }
            helper_macro_world_fini(&w);
        }
    assert_true(largest > 0.8 && largest <= 1.0);
}

static void check_uniform(scene_closure closure, scene_scheme scheme, double to, double most)
{
    helper_macro_world w;

    make_scene(&w.s, 0.0, to, 0.04, closure, scheme);
    helper_macro_world_init(&w, half_full, 1);
    const double mass = macro_measure(w.solver).mass;
    helper_macro_advance(w.solver, steps_of_a_turn(&w));
    assert_true(largest_change(&w) <= most);
    assert_near(macro_measure(w.solver).mass, mass, 1e-13);
    assert_true(macro_measure(w.solver).fallen == 0.0);
    helper_macro_world_fini(&w);
}

// The sweeps of `roe` with the closure `dispersive` take one axis after the other, each with a divergence of its own
// beside the borders.
static void a_uniform_density_stays_uniform_on_a_ring(void **state)
{
    for (int k = 0; k < 2; k++) {
        const double to = k == 0 ? 360.0 : -360.0;
        check_uniform(SCENE_CONGESTED, SCENE_SCHEME_ROE, to, 1e-12);
        check_uniform(SCENE_CONGESTED, SCENE_SCHEME_MUSCL, to, 1e-12);
        check_uniform(SCENE_DISPERSIVE, SCENE_SCHEME_MUSCL, to, 1e-12);
        check_uniform(SCENE_DISPERSIVE, SCENE_SCHEME_ROE, to, 0.1);
    }
}

// The pieces of the rails are chords up to 2.3 mm beside the borders of the belt.
static void a_packed_ring_turns_with_its_belt_and_falls_nowhere(void **state)
{
    helper_macro_world w;

    make_scene(&w.s, 0.0, 360.0, 0.02, SCENE_CONGESTED, SCENE_SCHEME_ROE);
    add_rail(&w.s, INNER, 36);
    add_rail(&w.s, OUTER, 36);
    helper_macro_world_init(&w, full, 1);
    const double mass = macro_measure(w.solver).mass;
    helper_macro_advance(w.solver, steps_of_a_turn(&w) / 4);
    assert_near(macro_measure(w.solver).mass, mass, 1e-12);
    assert_true(macro_measure(w.solver).fallen == 0.0);
    assert_true(macro_measure(w.solver).peak < 1.0);
    helper_macro_world_fini(&w);
}

static double heap(const scene *s, vec2 at)
{
    return helper_macro_bump(at.x - 0.4, at.y, DEVIATION);
}

static double heap_on_belt(const scene *s, vec2 at)
{
    return helper_macro_bump(at.x + 0.4, at.y, DEVIATION);
}

// After a turn of a ring.
static double error_on_ring(double cell)
{
    helper_macro_world w;

    make_scene(&w.s, 0.0, 360.0, cell, SCENE_CONGESTED, SCENE_SCHEME_MUSCL);
    w.s.macro.step = 0.09 * cell / SPEED;
    helper_macro_world_init(&w, heap, 1);
    helper_macro_advance(w.solver, steps_of_a_turn(&w));
    const double error = helper_macro_bump_error(&w, (vec2){ 0.4, 0.0 }, DEVIATION);
    helper_macro_world_fini(&w);
    return error;
}

// After the same way, the circumference of the circle through the heap's middle, on a straight belt.
static double error_on_belt(double cell)
{
    const double way = 2.0 * M_PI * 0.4;
    helper_macro_world w;

    helper_scene_belt(&w.s, 1.0, 1.0, cell, (scene_pose[]){ { 0.0, 0.0, 0.0 } }, 1);
    w.s.domain = (scene_rect){ -0.7, 2.464, -0.28, 0.28 };
    w.s.macro.closure = SCENE_CONGESTED;
    w.s.macro.scheme = SCENE_SCHEME_MUSCL;
    w.s.macro.step = 0.09 * cell / SPEED;
    helper_scene_add_belt(&w.s, (vec2){ SPEED, 0.0 }, NULL, 0);
    helper_macro_world_init(&w, heap_on_belt, 1);
    helper_macro_advance(w.solver, (int)lround(way / SPEED / w.s.macro.step));
    const double error = helper_macro_bump_error(&w, (vec2){ way - 0.4, 0.0 }, DEVIATION);
    helper_macro_world_fini(&w);
    return error;
}

static void a_heap_comes_back_after_a_turn_as_precisely_as_it_moves_on_a_straight_belt(void **state)
{
    const double ring = error_on_ring(0.028), finer = error_on_ring(0.014);
    const double belt = error_on_belt(0.028), finer_belt = error_on_belt(0.014);

    assert_true(finer < 1.1 * finer_belt);
    assert_true(log2(ring / finer) > log2(belt / finer_belt) - 0.1);
}

static double half_full_in_quarter(const scene *s, vec2 at)
{
    return at.x > 0.0 && at.y > 0.0 ? half_full(s, at) : 0.0;
}

// A quarter that ends at a wall, the west side of the domain. The shock turns against the belt with the angular velocity
// turn rho_0/(rho_j - rho_0), at all radii, and the area behind it grows by half of that times R^2 - r^2.
static void a_queue_on_an_arc_grows_with_the_speed_of_its_shock(void **state)
{
    helper_macro_world w;

    make_scene(&w.s, 0.0, 90.0, 0.01, SCENE_CONGESTED, SCENE_SCHEME_ROE);
    w.s.domain = (scene_rect){ 0.0, 0.7, 0.0, 0.7 };
    w.s.edges[SCENE_WEST] = SCENE_EDGE_WALL;
    w.s.edges[SCENE_SOUTH] = SCENE_EDGE_INFLOW;
    add_rail(&w.s, INNER, 90);
    add_rail(&w.s, OUTER, 90);
    helper_macro_world_init(&w, half_full_in_quarter, 1);
    const double dt = scene_macro_step(&w.s);
    helper_macro_advance(w.solver, (int)lround(0.2 / dt));
    const double before = helper_macro_jammed_area(&w), t = macro_time(w.solver);
    helper_macro_advance(w.solver, (int)lround(0.4 / dt));
    const double growth = (helper_macro_jammed_area(&w) - before) / (macro_time(w.solver) - t);
    const double expected = w.s.belts[0].turn * 0.5 / (w.s.macro.jam_density - 0.5) * 0.5 *
                            (OUTER * OUTER - INNER * INNER);
    assert_near(growth / expected, 1.0, 0.02);
    helper_macro_world_fini(&w);
}

static void make_quarter(scene *s)
{
    make_scene(s, 0.0, 90.0, 0.01, SCENE_CONGESTED, SCENE_SCHEME_ROE);
    s->edges[SCENE_WEST] = SCENE_EDGE_WALL;
    s->domain.x_min = 0.0;
}

static void threads_and_resumes_change_no_bit_on_an_arc(void **state)
{
    helper_macro_check_resumes(make_quarter, full);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            the_field_of_an_arc_is_free_of_divergence_and_crosses_no_border_and_no_guide),
        cmocka_unit_test(no_cell_of_an_arc_is_emptied_in_a_step_wherever_its_rails_stand),
        cmocka_unit_test(a_uniform_density_stays_uniform_on_a_ring),
        cmocka_unit_test(a_packed_ring_turns_with_its_belt_and_falls_nowhere),
        cmocka_unit_test(
            a_heap_comes_back_after_a_turn_as_precisely_as_it_moves_on_a_straight_belt),
        cmocka_unit_test(a_queue_on_an_arc_grows_with_the_speed_of_its_shock),
        cmocka_unit_test(threads_and_resumes_change_no_bit_on_an_arc),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
