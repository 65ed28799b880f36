// Unit tests of the comparison of densities: blocks whose distances are known in closed form.

#include "core/base/memory.h"
#include "core/compare/compare.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

enum { N1 = 40, N2 = 30 };
static const bf_grid grid = { .n1 = N1, .n2 = N2, .lower1 = -3.0, .d1 = 0.02, .d2 = 0.05 };

static float of_a[N1 * N2], of_b[N1 * N2];

// Density rho in the cells i0 <= i < i1, j0 <= j < j1, and nothing else.
static void put_block(float *cells, size_t i0, size_t i1, size_t j0, size_t j1, float rho)
{
    for (size_t k = 0; k < N1 * N2; k++) {
        size_t i = k % N1, j = k / N1;
        cells[k] = i >= i0 && i < i1 && j >= j0 && j < j1 ? rho : 0.0F;
    }
}

static compare_distance distance(void)
{
    compare_distance d;
    assert_int_equal(compare_densities(&grid, of_a, of_b, &d, NULL), BF_OK);
    return d;
}

static void a_density_is_at_no_distance_from_itself(void **state)
{
    put_block(of_a, 3, 9, 4, 20, 0.7F);
    memcpy(of_b, of_a, sizeof of_b);
    compare_distance d = distance();
    assert_near(d.mean_abs, 0.0, 0.0);
    assert_near(d.l1, 0.0, 0.0);
    assert_near(d.emd_x, 0.0, 0.0);
    assert_near(d.emd_y, 0.0, 0.0);
}

// Every part of the cargo has to be carried by the shift, however far that is.
static void a_shifted_block_is_as_far_as_its_shift(void **state)
{
    put_block(of_a, 3, 9, 4, 14, 0.7F);
    for (size_t shift = 1; shift <= 31; shift += 3) {
        put_block(of_b, 3 + shift, 9 + shift, 4, 14, 0.7F);
        compare_distance d = distance();
        assert_near(d.emd_x, 0.02 * (double)shift, 1e-12);
        assert_near(d.emd_y, 0.0, 1e-12);
        // Of six columns those beyond the shift lie on one another.
        assert_near(d.l1, shift < 6 ? (double)shift / 6.0 : 1.0, 1e-12);
    }
    put_block(of_b, 3, 9, 11, 21, 0.7F);
    compare_distance d = distance();
    assert_near(d.emd_x, 0.0, 1e-12);
    assert_near(d.emd_y, 7 * 0.05, 1e-12);
}

// Spread evenly over widths w and 2 w about the same middle, the cargo at share q of its way is
// (2 q - 1) w/2 off: on average over q, w/4.
static void a_block_that_spreads_is_carried_by_a_quarter_of_its_width(void **state)
{
    put_block(of_a, 15, 25, 0, N2, 0.8F);
    put_block(of_b, 10, 30, 0, N2, 0.4F);
    compare_distance d = distance();
    assert_near(d.emd_x, 10 * 0.02 / 4.0, 1e-7); // 0.8F and 0.4F are floats
    assert_near(d.emd_y, 0.0, 1e-12);
    assert_near(d.l1, 0.5, 1e-7);
}

// Twice the cargo in the same place: |1 - 2| / (1 + 2), and nothing to be carried.
static void unequal_masses_change_l1_alone(void **state)
{
    put_block(of_a, 3, 9, 4, 14, 0.25F);
    put_block(of_b, 3, 9, 4, 14, 0.5F);
    compare_distance d = distance();
    assert_near(d.l1, 1.0 / 3.0, 1e-15);
    assert_near(d.emd_x, 0.0, 1e-12);
    assert_near(d.emd_y, 0.0, 1e-12);
    // 60 of 1200 cells differ by 1/4.
    assert_near(d.mean_abs, 0.25 * 60.0 / 1200.0, 1e-15);
}

static void an_empty_belt_is_nowhere(void **state)
{
    put_block(of_a, 0, 0, 0, 0, 0.0F);
    put_block(of_b, 3, 9, 4, 14, 0.5F);
    compare_distance d = distance();
    assert_true(isnan(d.emd_x) && isnan(d.emd_y));
    assert_near(d.l1, 1.0, 0.0);
    put_block(of_b, 0, 0, 0, 0, 0.0F);
    d = distance();
    assert_true(isnan(d.l1) && isnan(d.emd_x) && isnan(d.emd_y));
    assert_near(d.mean_abs, 0.0, 0.0);
}

static void without_memory_nothing_is_compared(void **state)
{
    compare_distance d = { .l1 = -1.0 };
    memory_plan_fault(1, 0);
    bf_status status = compare_densities(&grid, of_a, of_b, &d, NULL);
    memory_plan_fault(0, 0);
    assert_int_equal(status, BF_ENOMEM);
    assert_near(d.l1, -1.0, 0.0);
}

static void grids_are_the_same_up_to_rounding(void **state)
{
    bf_grid other = grid;

    other.lower1 += 1e-12;
    other.d2 *= 1.0 + 1e-13;
    assert_true(compare_is_same_grid(&grid, &other));
    other.n1++;
    assert_false(compare_is_same_grid(&grid, &other));
    other = grid;
    other.lower2 += 0.5 * grid.d2;
    assert_false(compare_is_same_grid(&grid, &other));
    other = grid;
    other.d1 *= 1.0 + 1e-6; // over 40 columns this is 40 times as much
    assert_false(compare_is_same_grid(&grid, &other));
}

// Times among other things: every second number.
static void common_times_are_found_in_order(void **state)
{
    const double of_seconds[] = { 0.0, -1, 0.1, -1, 0.2, -1, 0.3, -1 };
    const double of_thirds[] = { 0.0, 0.15, 0.1 + 0.2 - 0.1, 0.25, 0.3 + 1e-12 };
    const compare_times a = { 4, of_seconds, 2 * sizeof(double) },
                        b = { 5, of_thirds, sizeof(double) };
    size_t i = 1, k = 1;

    assert_int_equal(compare_count_common(&a, &b), 3);
    assert_true(compare_next_common(&a, &b, &i, &k));
    assert_int_equal(i, 2);
    assert_int_equal(k, 2);
    i = k = 4;
    assert_false(compare_next_common(&a, &b, &i, &k));
}

static void a_mean_counts_what_is_known(void **state)
{
    compare_mean mean = { .n_l1 = 0 };

    compare_mean_add(&mean, &(compare_distance){ 1.0, 0.5, NAN, 0.1 });
    compare_mean_add(&mean, &(compare_distance){ 3.0, NAN, NAN, 0.3 });
    const compare_distance d = compare_mean_of(&mean);
    assert_near(d.mean_abs, 2.0, 1e-15);
    assert_near(d.l1, 0.5, 1e-15);
    assert_true(isnan(d.emd_x));
    assert_near(d.emd_y, 0.2, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_density_is_at_no_distance_from_itself),
        cmocka_unit_test(a_shifted_block_is_as_far_as_its_shift),
        cmocka_unit_test(a_block_that_spreads_is_carried_by_a_quarter_of_its_width),
        cmocka_unit_test(unequal_masses_change_l1_alone),
        cmocka_unit_test(an_empty_belt_is_nowhere),
        cmocka_unit_test(without_memory_nothing_is_compared),
        cmocka_unit_test(grids_are_the_same_up_to_rounding),
        cmocka_unit_test(common_times_are_found_in_order),
        cmocka_unit_test(a_mean_counts_what_is_known),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
