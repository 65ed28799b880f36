// Unit tests of the subset that has the best system, and of what 1,000 studies of known means find.

#include "core/study/subset.h"

#include "core/base/random.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

// Two systems, differences 1, 3, 2, 2: mean 2, S^2 = 2/3, width t(0.05; 3) sqrt(S^2/4) = 2.3534 0.40825 = 0.9608 by a printed
// table. So the second one is out, unless what does not matter is 2.
static void a_system_is_out_beyond_the_width(void **state)
{
    static const double a[] = { 1.0, 2.0, 3.0, 4.0 }, b[] = { 2.0, 5.0, 5.0, 6.0 },
                        c[] = { 1.3, 4.3, 3.3, 3.8 }; // c - a: mean 0.675, S^2 1.2292, width 1.3046
    const subset_system pair[] = { { a, 4 }, { b, 4 } }, close[] = { { c, 4 }, { a, 4 } };
    bool is_in[2];
    assert_int_equal(subset_find(&(subset){ 2, 0.95, 0.0 }, pair, is_in), 0);
    assert_true(is_in[0] && !is_in[1]);
    subset_find(&(subset){ 2, 0.95, 2.0 }, pair, is_in);
    assert_true(is_in[0] && is_in[1]);
    assert_int_equal(subset_find(&(subset){ 2, 0.95, 0.0 }, close, is_in), 1);
    assert_true(is_in[0] && is_in[1]);
}

static void without_replications_the_indifference_decides(void **state)
{
    static const double values[] = { 5.0, 4.0, 4.5, 9.0 };
    const subset_system systems[] = {
        { values, 1 }, { values + 1, 1 }, { values + 2, 1 }, { values + 3, 1 }
    };
    bool is_in[4];
    assert_int_equal(subset_find(&(subset){ 4, 0.95, 0.5 }, systems, is_in), 1);
    assert_true(!is_in[0] && is_in[1] && is_in[2] && !is_in[3]);
    subset_find(&(subset){ 1, 0.95, 0.0 }, systems, is_in);
    assert_true(is_in[0]);
}

// ---- 1,000 studies

enum { STUDIES = 1000, POINTS_MAX = 30, RUNS_MAX = 20 };

static double normal(bf_random *random)
{
    const double radius = sqrt(-2.0 * log(1.0 - random_unit(random)));

    return radius * cos(2.0 * M_PI * random_unit(random));
}

static size_t between(bf_random *random, size_t least, size_t most)
{
    return least + (size_t)(random_unit(random) * (double)(most - least + 1));
}

// How the true means lie.
typedef enum layout { SPREAD, EQUAL, STANDS_OUT } layout;

// A study: means, deviations that differ by factors up to 4, and a part of the noise that all points share.
typedef struct synthetic {
    size_t k, n;
    double means[POINTS_MAX];
    double values[POINTS_MAX][RUNS_MAX];
} synthetic;

static size_t make(synthetic *s, layout l, bf_random *random)
{
    double deviations[POINTS_MAX];
    const double common = 0.4 * (double)between(random, 0, 2);

    s->k = between(random, 2, POINTS_MAX);
    s->n = between(random, l == STANDS_OUT ? 2 : 1, RUNS_MAX);
    const size_t best = between(random, 0, s->k - 1);
    for (size_t i = 0; i < s->k; i++)
        deviations[i] = exp2(2.0 * random_unit(random) - 1.0);
    for (size_t i = 0; i < s->k; i++) {
        const double error =
            sqrt((1.0 - common) / (double)s->n) * hypot(deviations[i], deviations[best]);
        s->means[i] = i == best     ? 0.0
                      : l == SPREAD ? fabs(normal(random))
                      : l == EQUAL  ? 1e-9
                                    : 3.0 * error;
    }
    for (size_t r = 0; r < s->n; r++) {
        const double shared = sqrt(common) * normal(random);
        for (size_t i = 0; i < s->k; i++)
            s->values[i][r] =
                s->means[i] + shared + sqrt(1.0 - common) * deviations[i] * normal(random);
    }
    return best;
}

// Studies of a layout in which the best point is in the set, and in which the set is not all points.
static void count(layout l, uint64_t seed, size_t *ret_right, size_t *ret_smaller)
{
    static synthetic s;
    subset_system systems[POINTS_MAX];
    bool is_in[POINTS_MAX];
    bf_random random;

    *ret_right = *ret_smaller = 0;
    random_init(&random, seed);
    for (int study = 0; study < STUDIES; study++) {
        const size_t best = make(&s, l, &random);
        size_t n_in = 0;
        for (size_t i = 0; i < s.k; i++)
            systems[i] = (subset_system){ s.values[i], s.n };
        // With one replication nothing is known of chance: study_choose() does not ask then.
        if (s.n >= 2)
            subset_find(&(subset){ s.k, 0.95, 0.0 }, systems, is_in);
        for (size_t i = 0; i < s.k; i++)
            n_in += s.n < 2 || is_in[i];
        *ret_right += s.n < 2 || is_in[best];
        *ret_smaller += n_in < s.k;
    }
}

// In 95 % the best point is in the set; where it stands out from each by 3 standard errors of the difference, the set is not
// all points in 80 %.
static void the_best_of_a_thousand_studies_is_in_the_set(void **state)
{
    static const char *const names[] = { "spread", "equal", "standing out" };
    for (layout l = SPREAD; l <= STANDS_OUT; l++) {
        size_t n_right, n_smaller;
        count(l, 31 + l, &n_right, &n_smaller);
        print_message("means %s: best in the set in %.1f %%, not all points in %.1f %%\n", names[l],
                      0.1 * (double)n_right, 0.1 * (double)n_smaller);
        assert_true(n_right >= 950);
        assert_true(l != STANDS_OUT || n_smaller >= 800);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_system_is_out_beyond_the_width),
        cmocka_unit_test(without_replications_the_indifference_decides),
        cmocka_unit_test(the_best_of_a_thousand_studies_is_in_the_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
