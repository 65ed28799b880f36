// Unit tests of the cells that a line crosses.

#include "core/feed/line_cells.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

// 6 x 4 cells of 0.5 m x 0.25 m from (-1, 1).
static const bf_grid grid = { 6, 4, -1.0, 1.0, 0.5, 0.25 };

static void check_cells(vec2 start, vec2 end, const line_cell *expected, size_t n_expected)
{
    line_cell *cells = NULL;
    size_t n = 0;

    assert_int_equal(line_cells_find(&grid, start, end, &cells, &n, NULL), BF_OK);
    assert_int_equal(n, n_expected);
    for (size_t k = 0; k < n; k++) {
        assert_int_equal(cells[k].cell, expected[k].cell);
        assert_near(cells[k].length, expected[k].length, 1e-12);
    }
    memory_free(cells);
}

static void lines_along_the_axes_are_cut_at_the_borders(void **state)
{
    check_cells((vec2){ -0.75, 1.6 }, (vec2){ 0.6, 1.6 },
                (line_cell[]){ { 12, 0.25 }, { 13, 0.5 }, { 14, 0.5 }, { 15, 0.1 } }, 4);
    check_cells((vec2){ 0.1, 2.0 }, (vec2){ 0.1, 1.3 },
                (line_cell[]){ { 20, 0.25 }, { 14, 0.25 }, { 8, 0.2 } }, 3);
    check_cells((vec2){ 1.9, 1.1 }, (vec2){ 1.8, 1.1 }, (line_cell[]){ { 5, 0.1 } }, 1);
}

// Along y = 1.5, a border: the cells above it. On the upper end of the grid: those below.
static void a_line_on_a_border_lies_in_one_row(void **state)
{
    check_cells((vec2){ -1.0, 1.5 }, (vec2){ 0.0, 1.5 }, (line_cell[]){ { 12, 0.5 }, { 13, 0.5 } },
                2);
    check_cells((vec2){ 0.0, 2.0 }, (vec2){ -1.0, 2.0 }, (line_cell[]){ { 19, 0.5 }, { 18, 0.5 } },
                2);
}

// From (-1, 1) with slope 1/4 in metres: in cells (a, a/2), so x borders are met at a = 1, 2, 3 and y borders at a = 2.
// Each piece of a cell in x is hypot(0.5, 0.125) m long; at a = 2 both are met in one point.
static void a_diagonal_changes_rows_in_corners(void **state)
{
    const double piece = sqrt(0.25 + 0.015625);
    check_cells((vec2){ -1.0, 1.0 }, (vec2){ 1.0, 1.5 },
                (line_cell[]){ { 0, piece }, { 1, piece }, { 8, piece }, { 9, piece } }, 4);
    check_cells((vec2){ 1.0, 1.5 }, (vec2){ -1.0, 1.0 },
                (line_cell[]){ { 9, piece }, { 8, piece }, { 1, piece }, { 0, piece } }, 4);
}

static void a_point_has_one_cell_and_what_is_outside_the_nearest(void **state)
{
    check_cells((vec2){ 0.3, 1.3 }, (vec2){ 0.3, 1.3 }, (line_cell[]){ { 8, 1.0 } }, 1);
    check_cells((vec2){ 2.0, 2.0 }, (vec2){ 2.0, 2.0 }, (line_cell[]){ { 23, 1.0 } }, 1);
    check_cells((vec2){ -2.0, 1.1 }, (vec2){ -0.9, 1.1 }, (line_cell[]){ { 0, 1.1 } }, 1);
}

// The lengths in all cells add up, each cell is met once, and the next one is beside the last.
static void any_line_is_covered_once(void **state)
{
    for (int k = 0; k < 1000; k++) {
        const vec2 start = { -1.0 + 0.003 * (k * 37 % 1000), 1.0 + 0.001 * (k * 91 % 1000) };
        const vec2 end = { -1.0 + 0.003 * (k * 53 % 1000), 1.0 + 0.001 * (k * 17 % 1000) };
        const double length = vec2_length(vec2_sub(end, start));
        line_cell *cells = NULL;
        size_t n = 0;
        double sum = 0.0;
        assert_int_equal(line_cells_find(&grid, start, end, &cells, &n, NULL), BF_OK);
        for (size_t i = 0; i < n; i++) {
            sum += cells[i].length;
            const size_t before = cells[i > 0 ? i - 1 : 0].cell, cell = cells[i].cell;
            const size_t columns =
                cell % 6 > before % 6 ? cell % 6 - before % 6 : before % 6 - cell % 6;
            const size_t rows =
                cell / 6 > before / 6 ? cell / 6 - before / 6 : before / 6 - cell / 6;
            assert_true(cell < 24 && columns <= 1 && rows <= 1 && (i == 0 || columns + rows > 0));
        }
        assert_near(sum, length > 0.0 ? length : 1.0, 1e-8);
        memory_free(cells);
    }
}

static void out_of_memory_is_an_error(void **state)
{
    line_cell *cells = NULL;
    size_t n;
    memory_plan_fault(1, 0);
    assert_int_equal(
        line_cells_find(&grid, (vec2){ 0.0, 1.0 }, (vec2){ 1.0, 1.0 }, &cells, &n, NULL),
        BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_null(cells);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_along_the_axes_are_cut_at_the_borders),
        cmocka_unit_test(a_line_on_a_border_lies_in_one_row),
        cmocka_unit_test(a_diagonal_changes_rows_in_corners),
        cmocka_unit_test(a_point_has_one_cell_and_what_is_outside_the_nearest),
        cmocka_unit_test(any_line_is_covered_once),
        cmocka_unit_test(out_of_memory_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
