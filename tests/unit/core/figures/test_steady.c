// Unit tests of the criterion by which a throughput is steady.

#include "core/figures/steady.h"

#include "core/base/random.h"
#include "tests/unit/core/helper_scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// Adds a sample a second, in each of which so many parts leave.
static void add_seconds(steady *s, const double *parts, size_t n)
{
    for (size_t k = 0; k < n; k++)
        steady_sample(s, s->t + 1.0, s->level + parts[k]);
}

static void nothing_is_said_of_fewer_than_twenty_batches(void **state)
{
    (void)state;
    steady s = steady_from(0.05, 0.0, 0.0);
    steady_sample(&s, 19.5, 100.0);
    assert_int_equal(s.n, 19);
    assert_true(isnan(s.estimate.half_width));
    assert_true(isnan(s.reached_at));
}

// n batches 4, 6, 4, 6, ...
static steady alternate(double precision, double t, size_t n)
{
    steady s = steady_from(precision, t, 100.0);

    for (size_t k = 0; k < n; k++)
        add_seconds(&s, &(double){ k % 2 == 0 ? 4.0 : 6.0 }, 1);
    return s;
}

// 20 of them: mean 5, sum of squares 20, of products -19; half width t sqrt(20/19/20) with t = 2.0930 for 19 degrees of
// freedom by a printed table: 0.48017.
static void the_interval_is_students(void **state)
{
    (void)state;
    const steady s = alternate(0.05, 0.0, 20);
    assert_near(s.estimate.mean, 5.0, 1e-14);
    assert_near(s.estimate.half_width, 0.48017, 1e-5);
    assert_near(s.estimate.correlation, -0.95, 1e-14);
    assert_true(isnan(s.reached_at)); // 9.6 % of the mean
}

// 30 of them: t sqrt(30/29/30) = 2.0452/sqrt(29) = 0.37978, 7.6 %; 25 have a mean of 4.96 and 0.4205, 8.5 %.
static void it_is_reached_at_the_test_that_finds_it(void **state)
{
    (void)state;
    assert_true(isnan(alternate(0.08, 7.0, 29).reached_at));
    assert_near(alternate(0.08, 7.0, 30).reached_at, 37.0, 0.0);
    assert_near(alternate(0.08, 7.0, 30).estimate.half_width, 0.37978, 1e-5);
}

// 40 batches of 1 s become 20 of 2 s: the means of pairs.
static void forty_batches_become_twenty_of_twice_the_length(void **state)
{
    (void)state;
    double parts[40];
    for (int k = 0; k < 40; k++)
        parts[k] = k;
    steady s = steady_from(1e-6, 0.0, 0.0);
    add_seconds(&s, parts, 40);
    assert_int_equal(s.n, 20);
    assert_near(s.length, 2.0, 0.0);
    for (int k = 0; k < 20; k++)
        assert_near(s.means[k], 2 * k + 0.5, 1e-13);
}

static void samples_are_joined_by_lines(void **state)
{
    (void)state;
    steady s = steady_from(0.05, 0.0, 0.0);
    steady_sample(&s, 12.5, 25.0);
    assert_int_equal(s.n, 12);
    assert_near(s.means[11], 2.0, 1e-13);
    assert_near(s.start, 12.0, 0.0);
}

static void a_throughput_of_nothing_is_never_steady(void **state)
{
    (void)state;
    steady s = steady_from(0.05, 0.0, 0.0);
    steady_sample(&s, 1000.0, 0.0);
    assert_true(isnan(s.reached_at));
}

// A rate that grows by 1 part/s each second: the interval is narrow, but successive batches are correlated.
static void a_drift_is_not_steady(void **state)
{
    (void)state;
    double parts[25];
    for (int k = 0; k < 25; k++)
        parts[k] = 100.0 + k;
    steady s = steady_from(0.05, 0.0, 0.0);
    add_seconds(&s, parts, 25);
    assert_true(s.estimate.half_width <= 0.05 * s.estimate.mean);
    assert_true(s.estimate.correlation > STEADY_CORRELATION_MAX);
    assert_true(isnan(s.reached_at));
}

// Rates that follow x' = rho x + u with u uniform in +-2, about 20 parts/s. Of 200 runs that end when the throughput is
// steady within 2 %, the number whose interval misses 20.
static int count_misses(double rho, uint64_t seed)
{
    enum { RUNS = 200, SECONDS = 20000 };
    int n_missed = 0;
    bf_random random;

    random_init(&random, seed);
    for (int run = 0; run < RUNS; run++) {
        steady s = steady_from(0.02, 0.0, 0.0);
        double x = 0.0;
        for (int k = 0; isnan(s.reached_at) && k < SECONDS; k++) {
            x = rho * x + 4.0 * random_unit(&random) - 2.0;
            steady_sample(&s, k + 1.0, s.level + 20.0 + x);
        }
        assert_true(!isnan(s.reached_at));
        assert_true(s.estimate.half_width <= 0.02 * s.estimate.mean);
        n_missed += fabs(s.estimate.mean - 20.0) > s.estimate.half_width ? 1 : 0;
    }
    return n_missed;
}

// 5 % by the interval, some more because it is tested several times.
static void independent_rates_are_in_their_interval(void **state)
{
    (void)state;
    assert_true(count_misses(0.0, 20260401) <= 20);
}

// Batches of 1 s would miss in more than half of the runs.
static void correlated_rates_wait_for_longer_batches(void **state)
{
    (void)state;
    assert_true(count_misses(0.8, 7) <= 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_said_of_fewer_than_twenty_batches),
        cmocka_unit_test(the_interval_is_students),
        cmocka_unit_test(it_is_reached_at_the_test_that_finds_it),
        cmocka_unit_test(forty_batches_become_twenty_of_twice_the_length),
        cmocka_unit_test(samples_are_joined_by_lines),
        cmocka_unit_test(a_throughput_of_nothing_is_never_steady),
        cmocka_unit_test(a_drift_is_not_steady),
        cmocka_unit_test(independent_rates_are_in_their_interval),
        cmocka_unit_test(correlated_rates_wait_for_longer_batches),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
