// Unit tests of the mollifier's weights.

#include "core/macro/mollifier.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const double sigma = 10000.0, cell = 5e-3;

// 4 standard deviations of 0.01 m are 8 cells of 5 mm, 4 of 0.0316 m are 25.3.
static void the_weights_end_at_four_standard_deviations(void **state)
{
    assert_int_equal(mollifier_reach(1e4, 5e-3), 8);
    assert_int_equal(mollifier_reach(1e4, 1e-2), 4);
    assert_int_equal(mollifier_reach(1e3, 5e-3), 26);
    assert_int_equal(mollifier_reach(1e12, 1.0), 1);
}

// The integral weights are the probabilities of the cells in +-(S + 1/2) cells of a normal distribution.
static void the_integral_weights_sum_to_the_probability_of_the_range(void **state)
{
    mollifier m;
    double sum = 0.0;
    mollifier_init(&m, sigma, cell);
    for (int k = 0; k <= 2 * m.reach; k++)
        sum += m.integral[k];
    assert_true(fabs(sum - erf(8.5 * cell * sqrt(sigma / 2.0))) < 1e-15);
}

// A telescoping sum: g((S + 1) d) - g(-S d).
static void the_slopes_sum_to_the_difference_of_the_ends(void **state)
{
    mollifier m;
    double sum = 0.0, g0 = sqrt(sigma / (2.0 * M_PI));
    mollifier_init(&m, sigma, cell);
    for (int k = 0; k <= 2 * m.reach; k++)
        sum += m.gradient[k];
    double expected =
        g0 * (exp(-0.5 * sigma * 81 * cell * cell) - exp(-0.5 * sigma * 64 * cell * cell));
    assert_true(fabs(sum - expected) < 1e-14);
}

// rho = x1 has gradient 1 everywhere, and the mollified gradient of a line is its own, but for the
// mass of the Gaussian beyond the cut-off: at 4 standard deviations below 1e-3.
static void the_gradient_of_a_line_is_its_slope(void **state)
{
    mollifier m;
    double gradient = 0.0;
    mollifier_init(&m, sigma, cell);
    for (int k = 0; k <= 2 * m.reach; k++) {
        int p = m.reach - k;
        gradient += m.gradient[k] * (-p - 0.5) * cell; // cell i - p seen from the face i + 1/2
    }
    assert_true(fabs(gradient - 1.0) < 1e-3);
}

static void integral_weights_are_even_and_gradient_weights_odd_about_the_face(void **state)
{
    mollifier m;
    mollifier_init(&m, sigma, cell);
    for (int p = 0; p < m.reach; p++) {
        assert_true(m.integral[m.reach - p] == m.integral[m.reach + p]);
        assert_true(m.gradient[m.reach - p] == -m.gradient[m.reach + p + 1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_weights_end_at_four_standard_deviations),
        cmocka_unit_test(the_integral_weights_sum_to_the_probability_of_the_range),
        cmocka_unit_test(the_slopes_sum_to_the_difference_of_the_ends),
        cmocka_unit_test(the_gradient_of_a_line_is_its_slope),
        cmocka_unit_test(integral_weights_are_even_and_gradient_weights_odd_about_the_face),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
