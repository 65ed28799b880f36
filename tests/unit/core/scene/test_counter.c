// Unit tests of counters: a cell counts if its centre is inside.

#include "core/scene/counter.h"

#include "core/base/random.h"
#include "tests/unit/helper_cmocka.h"

static const bf_grid grid = { 200, 120, 0.0, 0.0, 0.005, 0.005 };

static counter_cells cells_of(scene_rect rect)
{
    scene_counter counter = { .rect = rect };
    return counter_cells_of(&counter, &grid);
}

static void the_papers_counter_has_the_150_columns_upstream_of_the_exit(void **state)
{
    counter_cells c = cells_of((scene_rect){ 0.0, 0.75, 0.0, 0.6 });
    assert_int_equal(c.i_min, 0);
    assert_int_equal(c.i_max, 150);
    assert_int_equal(c.j_min, 0);
    assert_int_equal(c.j_max, 120);
}

static void a_counter_larger_than_the_domain_has_all_cells(void **state)
{
    counter_cells c = cells_of((scene_rect){ -1e5, 1e5, -1e5, 1e5 });
    assert_int_equal(c.i_min, 0);
    assert_int_equal(c.i_max, 200);
    assert_int_equal(c.j_min, 0);
    assert_int_equal(c.j_max, 120);
}

static void a_counter_between_centres_or_outside_has_no_cells(void **state)
{
    counter_cells c = cells_of((scene_rect){ 0.101, 0.1012, -3.0, -2.0 });
    assert_int_equal(c.i_min, c.i_max);
    assert_int_equal(c.j_min, c.j_max);
    c = cells_of((scene_rect){ 2.0, 3.0, 0.5975, 0.6 });
    assert_int_equal(c.i_min, c.i_max);
    assert_int_equal(c.j_max - c.j_min, 1);
}

static void cells_and_points_are_counted_by_the_same_rule(void **state)
{
    bf_random random;

    random_init(&random, 5);
    for (int n = 0; n < 200; n++) {
        double x = random_unit(&random), y = random_unit(&random);
        scene_counter counter = { .rect = { x, x + random_unit(&random), y, y + 0.05 } };
        // Borders on centres are the hard cases: the lower one belongs to the counter.
        if (n % 2 == 0)
            counter.rect.x_min = grid_x1(&grid, (size_t)(x * 199.0));
        if (n % 3 == 0)
            counter.rect.y_max = grid_x2(&grid, (size_t)(y * 119.0));
        counter_cells c = counter_cells_of(&counter, &grid);
        for (size_t j = 0; j < grid.n2; j++) {
            for (size_t i = 0; i < grid.n1; i++) {
                bool is_in = c.i_min <= i && i < c.i_max && c.j_min <= j && j < c.j_max;
                vec2 centre = { grid_x1(&grid, i), grid_x2(&grid, j) };
                assert_int_equal(counter_holds(&counter, centre), is_in);
            }
        }
    }
}

static void a_counter_holds_its_lower_borders_only(void **state)
{
    scene_counter counter = { .rect = { 0.0, 1.0, 2.0, 3.0 } };

    assert_true(counter_holds(&counter, (vec2){ 0.0, 2.0 }));
    assert_false(counter_holds(&counter, (vec2){ 1.0, 2.0 }));
    assert_false(counter_holds(&counter, (vec2){ 0.0, 3.0 }));
    assert_false(counter_holds(&counter, (vec2){ -0.1, 2.5 }));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_papers_counter_has_the_150_columns_upstream_of_the_exit),
        cmocka_unit_test(a_counter_larger_than_the_domain_has_all_cells),
        cmocka_unit_test(a_counter_between_centres_or_outside_has_no_cells),
        cmocka_unit_test(cells_and_points_are_counted_by_the_same_rule),
        cmocka_unit_test(a_counter_holds_its_lower_borders_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
