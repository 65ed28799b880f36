// The macroscopic model on paths. On a straight and on an arc alike all lanes need the same time, so that a heap goes along an S
// and keeps its shape; on straight belts of the same length the scheme is the same.

#include "core/base/memory.h"
#include "core/macro/macro.h"
#include "core/scene/belt.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#define SPEED     0.4
#define WIDTH     0.4
#define RADIUS    0.5
#define DEVIATION 0.06 // of a heap, m

// An S that turns by 40 degrees to the left and back, aslant to the grid in between.
static const vec2 s_points[] = { { 0.0, 0.3 }, { 0.7, 0.3 }, { 1.62, 1.07197 }, { 2.6, 1.07197 } };

static void make_s(scene *s, double cell, scene_scheme scheme)
{
    helper_scene_belt(s, 2.6, 1.4, cell, (scene_pose[]){ { 0.3, 0.3, 0.0 } }, 1);
    s->macro.closure = SCENE_CONGESTED;
    s->macro.scheme = scheme;
    helper_scene_add_path(s, SPEED, WIDTH, RADIUS, s_points, 4);
}

static bool is_on_belt(const scene *s, vec2 at)
{
    bool is_on = false;

    for (size_t k = 0; k < s->n_sections; k++)
        is_on = is_on || belt_holds(&s->belts[k], at);
    return is_on;
}

static double half_full(const scene *s, vec2 at)
{
    return is_on_belt(s, at) ? 0.5 : 0.0;
}

// The straight aslant, and how far along it a place lies, m.
static const scene_belt *find_slant(const scene *s, vec2 at, double *ret_along)
{
    const scene_belt *slant = NULL;

    for (size_t k = 0; k < s->n_sections; k++)
        if (s->belts[k].leg.is_given && belt_has_lanes(&s->belts[k]))
            slant = &s->belts[k];
    assert_non_null(slant);
    *ret_along = vec2_dot(vec2_sub(at, slant->leg.start), slant->leg.along);
    return slant;
}

// The flux out of a cell is the field's divergence times its area. At a joint v_T jumps.
static void the_field_of_a_path_crosses_no_border_and_is_free_of_divergence_on_each_section(
    void **state)
{
    helper_macro_world w;

    make_s(&w.s, 0.013, SCENE_SCHEME_ROE);
    helper_macro_world_init(&w, half_full, 1);
    const bf_grid *g = &w.f->grid;
    double passing = 0.0, middle;
    const scene_belt *slant = find_slant(&w.s, (vec2){ 0.0, 0.0 }, &middle);
    const vec2 centre =
        vec2_add(slant->leg.start, vec2_scale(slant->leg.along, 0.5 * slant->leg.length));
    const size_t column = (size_t)((centre.x - g->lower1) / g->d1);
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            const double *v1 = &w.f->faces[0].v[j * (g->n1 + 1) + i],
                         *v2 = &w.f->faces[1].v[j * g->n1 + i];
            const vec2 at = { grid_x1(g, i), grid_x2(g, j) };
            const double out = (v1[1] - v1[0]) * g->d2 + (v2[g->n1] - v2[0]) * g->d1;
            const bool is_on = is_on_belt(&w.s, at);
            size_t near = 0; // sections within two cells
            for (size_t k = 0; k < w.s.n_sections; k++)
                near += belt_holds(&w.s.belts[k], at) ||
                        belt_border_distance(&w.s.belts[k], at) < 2.0 * g->d1;
            assert_true(is_on ||
                        (v1[0] == 0.0 && v1[1] == 0.0 && v2[0] == 0.0 && v2[g->n1] == 0.0));
            assert_true(near > 1 || fabs(out) <= 2e-15);
            assert_true(fabs(v1[0]) <= 1.25 * SPEED * (RADIUS + 0.5 * WIDTH) / RADIUS);
            passing += i == column ? v1[0] * g->d2 : 0.0;
        }
    assert_near(passing, SPEED * WIDTH, 1e-14);
    helper_macro_world_fini(&w);
}

// What the joint before it has made denser or less dense has not come there yet.
static void a_uniform_density_stays_uniform_on_a_straight_that_lies_aslant(void **state)
{
    for (int k = 0; k < 2; k++) {
        helper_macro_world w;
        make_s(&w.s, 0.01, k == 0 ? SCENE_SCHEME_ROE : SCENE_SCHEME_MUSCL);
        helper_macro_world_init(&w, half_full, 1);
        const bf_grid *g = &w.f->grid;
        const int n_steps = 4;
        // A cell depends on those two cells away before each stage, of which muscl has two in a step.
        const double reach = 4.0 * M_SQRT2 * n_steps * g->d1;
        size_t n_cells = 0;
        helper_macro_advance(w.solver, n_steps);
        for (size_t c = 0; c < grid_cells(g); c++) {
            const vec2 at = { grid_x1(g, c % g->n1), grid_x2(g, c / g->n1) };
            double along;
            const scene_belt *slant = find_slant(&w.s, at, &along);
            if (!belt_holds(slant, at) || along < reach || along > slant->leg.length - reach)
                continue;
            n_cells++;
            assert_near(macro_row(w.solver, c / g->n1)[c % g->n1], 0.5, 1e-12);
        }
        assert_true(n_cells > 1000);
        assert_true(macro_measure(w.solver).fallen == 0.0);
        helper_macro_world_fini(&w);
    }
}

static double heap(const scene *s, vec2 at)
{
    return helper_macro_bump(at.x - 0.3, at.y - 0.3, DEVIATION);
}

// The way of the centre line from x = 0.3 to x = 2.3: both corners cut 2 R tan(a/2) off the polyline and have arcs of R a.
static double way_along_s(void)
{
    const double angle = atan2(0.77197, 0.92);

    return 0.4 + hypot(0.92, 0.77197) + 0.68 + 2.0 * RADIUS * (angle - 2.0 * tan(0.5 * angle));
}

static double error_along(const vec2 *points, size_t n, vec2 domain, double cell, vec2 place)
{
    helper_macro_world w;

    helper_scene_belt(&w.s, domain.x, domain.y, cell, (scene_pose[]){ { 0.3, 0.3, 0.0 } }, 1);
    w.s.macro.closure = SCENE_CONGESTED;
    w.s.macro.scheme = SCENE_SCHEME_MUSCL;
    const int n_steps = (int)ceil(way_along_s() / (0.09 * cell));
    w.s.macro.step = way_along_s() / SPEED / n_steps;
    helper_scene_add_path(&w.s, SPEED, WIDTH, RADIUS, points, n);
    helper_macro_world_init(&w, heap, 1);
    helper_macro_advance(w.solver, n_steps);
    const double error = helper_macro_bump_error(&w, place, DEVIATION);
    helper_macro_world_fini(&w);
    return error;
}

static void a_heap_goes_along_an_s_as_precisely_as_it_moves_on_a_straight_belt(void **state)
{
    const vec2 straight[] = { { 0.0, 0.3 }, { 2.8, 0.3 } };
    const double cell = 0.014;

    const double s = error_along(s_points, 4, (vec2){ 2.6, 1.4 }, cell, (vec2){ 2.3, 1.07197 });
    const double belt =
        error_along(straight, 2, (vec2){ 2.8, 0.6 }, cell, (vec2){ 0.3 + way_along_s(), 0.3 });
    assert_true(s < 1.1 * belt);
}

// The shock goes up the belt at v rho_0/(rho_j - rho_0).
static void a_queue_on_a_straight_aslant_grows_with_the_speed_of_its_shock(void **state)
{
    const vec2 along = { 0.8, 0.6 }, points[] = { { -0.2, -0.0 }, { 1.4, 1.2 } };
    helper_macro_world w;

    helper_scene_belt(&w.s, 1.2, 1.5, 0.01, (scene_pose[]){ { 0.3, 0.3, 0.0 } }, 1);
    w.s.macro.closure = SCENE_CONGESTED;
    helper_scene_add_path(&w.s, SPEED, WIDTH, RADIUS, points, 2);
    for (int k = 0; k < 3; k++) {
        const vec2 aside = vec2_scale(vec2_turn_left(along), 0.5 * WIDTH * (k - 1));
        const vec2 end = vec2_add((vec2){ 0.84, 0.78 }, aside);
        const vec2 rail[] = { vec2_sub(end, vec2_scale(along, 0.8)), end };
        const vec2 gate[] = { vec2_sub(end, vec2_scale(vec2_turn_left(along), 0.5 * WIDTH)),
                              vec2_add(end, vec2_scale(vec2_turn_left(along), 0.5 * WIDTH)) };
        helper_scene_add_obstacle(&w.s, k == 1 ? gate : rail, 2, SCENE_SEALED);
    }
    helper_macro_world_init(&w, half_full, 1);
    const double dt = scene_macro_step(&w.s);
    helper_macro_advance(w.solver, (int)lround(0.3 / dt));
    const double before = helper_macro_jammed_area(&w), t = macro_time(w.solver);
    helper_macro_advance(w.solver, (int)lround(0.5 / dt));
    const double growth = (helper_macro_jammed_area(&w) - before) / (macro_time(w.solver) - t);
    assert_near(growth / (SPEED * 0.5 / (w.s.macro.jam_density - 0.5) * WIDTH), 1.0, 0.02);
    assert_true(macro_measure(w.solver).fallen == 0.0);
    helper_macro_world_fini(&w);
}

// With a corner at which it goes straight on.
static void a_straight_path_has_the_field_of_a_straight_belt(void **state)
{
    const vec2 path[] = { { 0.0, 0.3 }, { 0.9, 0.3 }, { 1.4, 0.3 } };
    const vec2 polygon[] = { { 0.0, 0.1 }, { 1.4, 0.1 }, { 1.4, 0.5 }, { 0.0, 0.5 } };
    velocity_field *fields[2];
    scene scenes[2];

    for (int k = 0; k < 2; k++) {
        helper_scene_belt(&scenes[k], 1.4, 0.7, 0.023, (scene_pose[]){ { 0.3, 0.3, 0.0 } }, 1);
        scenes[k].macro.closure = SCENE_CONGESTED;
        if (k == 0)
            helper_scene_add_path(&scenes[k], SPEED, WIDTH, RADIUS, path, 3);
        else
            helper_scene_add_belt(&scenes[k], (vec2){ SPEED, 0.0 }, polygon, 4);
        helper_scene_resolve(&scenes[k]);
        fields[k] = helper_macro_field(&scenes[k]);
    }
    const bf_grid *g = &fields[0]->grid;
    assert_memory_equal(fields[0]->faces[0].v, fields[1]->faces[0].v,
                        (g->n1 + 1) * g->n2 * sizeof(double));
    assert_memory_equal(fields[0]->faces[1].v, fields[1]->faces[1].v,
                        g->n1 * (g->n2 + 1) * sizeof(double));
    assert_memory_equal(fields[0]->off, fields[1]->off, grid_cells(g));
    assert_true(scene_macro_step(&scenes[0]) == scene_macro_step(&scenes[1]));
    for (int k = 0; k < 2; k++) {
        velocity_field_destroy(fields[k]);
        scene_fini(&scenes[k]);
    }
}

static void make_coarse_s(scene *s)
{
    make_s(s, 0.02, SCENE_SCHEME_ROE);
}

static void threads_and_resumes_change_no_bit_on_a_path(void **state)
{
    helper_macro_check_resumes(make_coarse_s, half_full);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            the_field_of_a_path_crosses_no_border_and_is_free_of_divergence_on_each_section),
        cmocka_unit_test(a_uniform_density_stays_uniform_on_a_straight_that_lies_aslant),
        cmocka_unit_test(a_heap_goes_along_an_s_as_precisely_as_it_moves_on_a_straight_belt),
        cmocka_unit_test(a_queue_on_a_straight_aslant_grows_with_the_speed_of_its_shock),
        cmocka_unit_test(a_straight_path_has_the_field_of_a_straight_belt),
        cmocka_unit_test(threads_and_resumes_change_no_bit_on_a_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
