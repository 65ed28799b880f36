// Unit tests of the closed faces of a velocity field: no way leads through a line, and all others stay.

#include "core/macro/velocity_field.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/base/random.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

static const scene_pose somewhere = { 0.1, 0.1, 0.0 };

/// Mark every cell that open faces link with cell start. stack has room for all cells.
static void flood(const velocity_field *f, size_t start, uint8_t *reached, size_t *stack)
{
    size_t n1 = f->grid.n1, n2 = f->grid.n2, n = 0;

    stack[n++] = start;
    reached[start] = 1;
    while (n > 0) {
        size_t k = stack[--n], i = k % n1, j = k / n1;
        const size_t next[4] = { k - 1, k + 1, k - n1, k + n1 };
        const bool is_open[4] = { i > 0 && !f->faces[0].closed[j * (n1 + 1) + i],
                                  i + 1 < n1 && !f->faces[0].closed[j * (n1 + 1) + i + 1],
                                  j > 0 && !f->faces[1].closed[k],
                                  j + 1 < n2 && !f->faces[1].closed[k + n1] };
        for (int d = 0; d < 4; d++) {
            if (is_open[d] && !reached[next[d]]) {
                reached[next[d]] = 1;
                stack[n++] = next[d];
            }
        }
    }
}

static double distance_to_path(vec2 at, const vec2 *path, size_t n)
{
    double least = INFINITY;
    for (size_t k = 0; k + 1 < n; k++)
        least = fmin(least, polygon_segment_distance(at, path[k], path[k + 1]));
    return least;
}

/// A closed path around a centre, star-shaped, whose last point is its first.
static size_t draw_loop(bf_random *random, double cell, vec2 *ret_path)
{
    size_t n = 3 + random_bits(random) % 8;
    double turn = random_unit(random);

    for (size_t k = 0; k < n; k++) {
        double angle = 2.0 * M_PI * ((double)k + turn) / (double)n;
        double reach = 0.05 + 0.17 * random_unit(random);
        double x = 0.5 + 1.8 * reach * cos(angle), y = 0.25 + reach * sin(angle);
        ret_path[k] =
            (vec2){ helper_scene_draw(random, x, x, cell), helper_scene_draw(random, y, y, cell) };
    }
    ret_path[n] = ret_path[0];
    return n + 1;
}

static void nothing_is_linked_across_a_closed_line(void **state)
{
    static const double cells[] = { 0.05, 0.02, 0.01, 0.005 };
    bf_random random;

    random_init(&random, 2);
    for (int round = 0; round < 600; round++) {
        double cell = cells[round % 4];
        vec2 path[16];
        scene s;
        size_t n = draw_loop(&random, cell, path);
        helper_scene_belt(&s, 1.0, 0.5, cell, &somewhere, 1);
        helper_scene_add_obstacle(&s, path, n, round % 2 == 0 ? SCENE_SEALED : SCENE_WALL);
        helper_scene_resolve(&s);
        velocity_field *f = helper_macro_field(&s);
        size_t n_cells = grid_cells(&f->grid);
        uint8_t *reached = memory_alloc(n_cells, 1), *is_inside = memory_alloc(n_cells, 1);
        size_t *stack = memory_alloc(n_cells, sizeof *stack);
        // Cells on the line itself belong to one of its sides; the others to the one they are on.
        for (size_t k = 0; k < n_cells; k++) {
            vec2 at = { grid_x1(&f->grid, k % f->grid.n1), grid_x2(&f->grid, k / f->grid.n1) };
            is_inside[k] = distance_to_path(at, path, n) < 1e-7  ? 2
                           : polygon_holds(path, n - 1, at, 0.0) ? 1
                                                                 : 0;
        }
        for (size_t k = 0; k < n_cells; k++) {
            if (is_inside[k] == 1 && !reached[k])
                flood(f, k, reached, stack);
        }
        for (size_t k = 0; k < n_cells; k++)
            assert_false(reached[k] && is_inside[k] == 0);
        memory_free(reached);
        memory_free(is_inside);
        memory_free(stack);
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

static void no_way_leads_behind_a_line_from_wall_to_wall(void **state)
{
    static const double cell = 0.01;
    bf_random random;

    random_init(&random, 4);
    for (int round = 0; round < 300; round++) {
        // From the south wall to the north one, by way of points that may be centres or faces.
        vec2 path[6];
        size_t n = 2 + random_bits(&random) % 5;
        scene s;
        for (size_t k = 0; k < n; k++)
            path[k] = (vec2){ helper_scene_draw(&random, 0.2, 0.8, cell),
                              0.5 * (double)k / (double)(n - 1) };
        helper_scene_belt(&s, 1.0, 0.5, cell, &somewhere, 1);
        helper_scene_add_obstacle(&s, path, n, SCENE_SEALED);
        helper_scene_resolve(&s);
        velocity_field *f = helper_macro_field(&s);
        size_t n_cells = grid_cells(&f->grid);
        uint8_t *reached = memory_alloc(n_cells, 1);
        size_t *stack = memory_alloc(n_cells, sizeof *stack);
        flood(f, 0, reached, stack);
        for (size_t k = 0; k < n_cells; k++) {
            if (k % f->grid.n1 >= 81) // east of x = 0.81 m
                assert_false(reached[k]);
            if (k % f->grid.n1 < 19)
                assert_true(reached[k]);
        }
        memory_free(reached);
        memory_free(stack);
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

static void cells_on_the_line_lie_upstream_and_are_not_cut_off(void **state)
{
    // 45 degrees through the diagonal of cells: their centres are on the line to rounding.
    scene s;

    for (int reversed = 0; reversed < 2; reversed++) {
        vec2 path[] = { { 0.2, 0.0 }, { 0.5, 0.3 } };
        vec2 swapped[] = { path[1], path[0] };
        helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
        helper_scene_add_obstacle(&s, reversed ? swapped : path, 2, SCENE_SEALED);
        helper_scene_resolve(&s);
        velocity_field *f = helper_macro_field(&s);
        size_t n1 = f->grid.n1;
        for (size_t j = 1; j < 59; j++) {
            size_t i = 40 + j;
            assert_false(f->faces[0].closed[j * (n1 + 1) + i]);    // to the west, upstream
            assert_true(f->faces[0].closed[j * (n1 + 1) + i + 1]); // to the east
            assert_false(f->faces[1].closed[(j + 1) * n1 + i]);    // to the north, upstream
            assert_true(f->faces[1].closed[j * n1 + i]);           // to the south
        }
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

static void a_line_along_faces_shuts_just_these(void **state)
{
    scene s;

    helper_scene_example(&s, 90.0, SCENE_SEALED);
    velocity_field *f = helper_macro_field(&s);
    size_t n1 = f->grid.n1, n2 = f->grid.n2;
    for (size_t j = 0; j < n2; j++) {
        for (size_t i = 0; i <= n1; i++)
            assert_int_equal(f->faces[0].closed[j * (n1 + 1) + i], i == 150 && j < 100);
    }
    for (size_t j = 0; j <= n2; j++) {
        for (size_t i = 0; i < n1; i++)
            assert_int_equal(f->faces[1].closed[j * n1 + i], j == 0 || j == n2);
    }
    velocity_field_destroy(f);
    scene_fini(&s);
}

static void the_papers_field_shuts_nothing_but_walls(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_FIELD);
    velocity_field *f = helper_macro_field(&s);
    for (size_t k = 0; k < (f->grid.n1 + 1) * f->grid.n2; k++)
        assert_false(f->faces[0].closed[k]);
    velocity_field_destroy(f);
    scene_fini(&s);
}

static void open_edges_carry_and_walls_do_not(void **state)
{
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.05, &somewhere, 1);
    helper_scene_add_belt(&s, (vec2){ 0.3, 0.1 }, NULL, 0);
    s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
    helper_scene_resolve(&s);
    velocity_field *f = helper_macro_field(&s);
    size_t n1 = f->grid.n1, n2 = f->grid.n2;
    for (size_t j = 0; j < n2; j++) {
        assert_true(f->faces[0].v[j * (n1 + 1)] == 0.3 && !f->faces[0].closed[j * (n1 + 1)]);
        assert_true(f->faces[0].v[j * (n1 + 1) + n1] == 0.3 &&
                    !f->faces[0].closed[j * (n1 + 1) + n1]);
    }
    for (size_t i = 0; i < n1; i++) {
        assert_true(f->faces[1].v[i] == 0.0 && f->faces[1].closed[i]);
        assert_true(f->faces[1].v[n2 * n1 + i] == 0.1 && !f->faces[1].closed[n2 * n1 + i]);
    }
    velocity_field_destroy(f);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_linked_across_a_closed_line),
        cmocka_unit_test(no_way_leads_behind_a_line_from_wall_to_wall),
        cmocka_unit_test(cells_on_the_line_lie_upstream_and_are_not_cut_off),
        cmocka_unit_test(a_line_along_faces_shuts_just_these),
        cmocka_unit_test(the_papers_field_shuts_nothing_but_walls),
        cmocka_unit_test(open_edges_carry_and_walls_do_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
