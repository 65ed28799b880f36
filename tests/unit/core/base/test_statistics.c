// Unit tests of intervals of replications.

#include "core/base/statistics.h"

#include "core/study/variates.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

// By mpmath with 30 digits; the first five agree with printed tables: 12.706, 2.228, 4.032, 2.093, 1.6973. For one degree of
// freedom t is tan(pi (1/2 - tail)), for two (1 - 2 tail)/sqrt(2 tail (1 - tail)).
static void students_quantiles_are_those_of_tables(void **state)
{
    static const struct {
        double tail, freedom, t;
    } cases[] = {
        { 0.025, 1, 12.706204736174705 },  { 0.025, 10, 2.2281388519862747 },
        { 0.005, 5, 4.0321429835552281 },  { 0.025, 19, 2.0930240544083098 },
        { 0.05, 30, 1.6972608865939578 },  { 0.025, 2.5, 3.5746548420036832 },
        { 0.0005, 2, 31.599054576443621 }, { 0.025, 1e5, 1.9599877075346096 },
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        assert_near(statistics_student(cases[k].tail, cases[k].freedom), cases[k].t,
                    1e-10 * cases[k].t);
    assert_near(statistics_student(0.001, 1), tan(M_PI * 0.499), 1e-7);
    assert_near(statistics_student(0.3, 2), 0.4 / sqrt(2 * 0.3 * 0.7), 1e-10);
    assert_true(statistics_student(0.5, 7) == 0.0);
}

static void normal_quantiles_are_those_of_tables(void **state)
{
    assert_near(statistics_normal(0.025), 1.959963984540054, 1e-10);
    assert_near(statistics_normal(0.005), 2.5758293035489004, 1e-10);
    assert_true(statistics_normal(0.5) == 0.0);
}

// 2, 4, 4, 4, 5, 5, 7, 9: mean 5, sum of squares 32, deviation sqrt(32/7); t(0.975; 7) = 2.3646 by a printed table.
static void deviation_and_half_width_are_students(void **state)
{
    static const double values[] = { 2, 4, 4, 4, 5, 5, 7, 9 };
    statistics_sample s = { 0 };
    assert_true(isnan(statistics_deviation(&s)));
    statistics_add(&s, values[0]);
    assert_true(isnan(statistics_half_width(&s, 0.95)));
    for (size_t k = 1; k < 8; k++)
        statistics_add(&s, values[k]);
    assert_near(s.mean, 5.0, 1e-14);
    assert_near(statistics_deviation(&s), sqrt(32.0 / 7.0), 1e-14);
    assert_near(statistics_half_width(&s, 0.95), 2.3646 * sqrt(32.0 / 7.0 / 8.0), 1e-4);
}

// R. G. Newcombe: Two-sided confidence intervals for the single proportion, Statistics in Medicine 17 (1998), table I,
// method 3.
static void wilsons_intervals_are_the_published_ones(void **state)
{
    static const struct {
        uint64_t hits, n;
        double low, high;
    } cases[] = {
        { 81, 263, 0.2553, 0.3662 },
        { 15, 148, 0.0624, 0.1605 },
        { 0, 20, 0.0, 0.1611 },
        { 1, 29, 0.0061, 0.1718 },
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const statistics_range range = statistics_wilson(cases[k].hits, cases[k].n, 0.95);
        assert_near(range.low, cases[k].low, 5e-5);
        assert_near(range.high, cases[k].high, 5e-5);
        const statistics_range other =
            statistics_wilson(cases[k].n - cases[k].hits, cases[k].n, 0.95);
        assert_near(other.low, 1.0 - range.high, 1e-12);
        assert_near(other.high, 1.0 - range.low, 1e-12);
    }
    const statistics_range nothing = statistics_wilson(0, 0, 0.95);
    assert_true(nothing.low == 0.0 && nothing.high == 1.0);
}

// 1,000 studies of ten replications about 40 with a deviation of 3: the number of intervals that have 40 in them is
// 950 with a deviation of 7. Wilson's, of 40 replications that jam with probability 0.3, are discrete, and hold it in
// 95 % of them nearly.
static void intervals_hold_the_truth_in_93_to_97_percent_of_studies(void **state)
{
    enum { STUDIES = 1000, REPLICATIONS = 10, TRIES = 40 };
    int n_means = 0, n_jams = 0;
    for (uint64_t study = 0; study < STUDIES; study++) {
        const variates_key key = { .seed = 13, .purpose = VARIATES_STEP, .set = study };
        statistics_sample s = { 0 };
        uint64_t hits = 0;
        for (uint64_t k = 0; k < REPLICATIONS; k++)
            statistics_add(&s, 40.0 + 3.0 * variates_normal(&key, k));
        for (uint64_t k = 0; k < TRIES; k++)
            hits += variates_unit(&key, 1000 + k) < 0.3;
        const statistics_range jams = statistics_wilson(hits, TRIES, 0.95);
        n_means += fabs(s.mean - 40.0) <= statistics_half_width(&s, 0.95);
        n_jams += jams.low <= 0.3 && 0.3 <= jams.high;
    }
    assert_in_range(n_means, 930, 970);
    assert_in_range(n_jams, 930, 970);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(students_quantiles_are_those_of_tables),
        cmocka_unit_test(normal_quantiles_are_those_of_tables),
        cmocka_unit_test(deviation_and_half_width_are_students),
        cmocka_unit_test(wilsons_intervals_are_the_published_ones),
        cmocka_unit_test(intervals_hold_the_truth_in_93_to_97_percent_of_studies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
