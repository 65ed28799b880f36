// Unit tests of the selection of the best system, and of pruning.

#include "core/study/selection.h"

#include "core/study/pruning.h"
#include "core/study/variates.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

// The system with the least sum of those left, the first one where several have it.
static size_t best_of(size_t k, const selection_known *known, const bool *is_left)
{
    double least = INFINITY;
    size_t best = k;

    for (size_t i = 0; i < k; i++) {
        double sum = 0.0;
        for (size_t r = 0; r < known->n; r++)
            sum += known->values[i * known->stride + r];
        if (is_left[i] && sum < least) {
            least = sum;
            best = i;
        }
    }
    return best;
}

// Three replications of two systems whose differences 1, 3, 5 have the mean 3 and the variance 4: with alpha 0.1,
// h^2 = 2 (0.1^-1 - 1) = 18; with delta 2 the width is 2/6 (18*4/4 - 3) = 5, with delta 4 4/6 (18*4/16 - 3) = 1. A fourth
// difference of 3 leaves a variance of 8/3, h^2 = 3 (0.1^(-2/3) - 1) = 10.9, and with delta 2 2/8 (7.3 - 4) = 0.8.
static void a_system_is_dropped_beyond_the_width_of_the_procedure(void **state)
{
    static const double values[] = { 1, 3, 5, 3, 0, 0, 0, 0 };
    const selection near = { 2, 3, 0.9, 2.0 }, far = { 2, 3, 0.9, 4.0 };
    bool is_left[2] = { true, true };
    assert_false(selection_drop(&near, &(selection_known){ values, 4, 3 }, is_left));
    assert_true(is_left[0] && is_left[1]);
    assert_true(selection_drop(&near, &(selection_known){ values, 4, 4 }, is_left));
    assert_true(!is_left[0] && is_left[1]);
    is_left[0] = true;
    assert_true(selection_drop(&far, &(selection_known){ values, 4, 3 }, is_left));
    assert_true(!is_left[0] && is_left[1]);
    assert_int_equal(best_of(2, &(selection_known){ values, 4, 3 }, is_left), 1);
}

static void equal_systems_end_with_the_first_and_one_system_at_once(void **state)
{
    static const double values[] = { 2, 1, 3, 2, 1, 3 };
    const selection_known known = { values, 3, 3 };
    const selection pair = { 2, 3, 0.95, 0.5 }, single = { 1, 3, 0.95, 0.5 };
    bool is_left[2] = { true, true };
    assert_true(selection_drop(&pair, &known, is_left));
    assert_int_equal(best_of(2, &known, is_left), 0);
    assert_true(selection_drop(&single, &known, is_left) && is_left[0]);
}

enum { SYSTEMS_MAX = 8, REPLICATIONS_MAX = 500 };

// Selects among systems of deviation 1, the last of which is better than all others by the indifference; `common` of the
// variance is that of noise that all share. Adds the replications to *n.
static bool is_selected_right(const selection *choice, uint64_t experiment, double common,
                              size_t *n)
{
    static double values[SYSTEMS_MAX * REPLICATIONS_MAX];
    bool is_left[SYSTEMS_MAX];

    for (size_t i = 0; i < choice->k; i++)
        is_left[i] = true;
    for (size_t r = 0; r < REPLICATIONS_MAX; r++) {
        const variates_key key = { 3, VARIATES_STEP, experiment, r };
        for (size_t i = 0; i < choice->k; i++) {
            values[i * REPLICATIONS_MAX + r] = sqrt(common) * variates_normal(&key, SYSTEMS_MAX) +
                                               sqrt(1 - common) * variates_normal(&key, i) -
                                               (i + 1 == choice->k ? choice->indifference : 0.0);
            *n += is_left[i];
        }
        const selection_known known = { values, REPLICATIONS_MAX, r + 1 };
        if (r + 1 >= choice->n_first && selection_drop(choice, &known, is_left))
            return best_of(choice->k, &known, is_left) + 1 == choice->k;
    }
    return false;
}

// In the least favourable cases the procedure selects right in 95 % of experiments at least. Of 400 these are 380 with a
// deviation of 4.4. Four fifths of common noise leave a fifth of the variance of differences. The variances of the first
// replications alone, as in the procedure of 2001, would take 164, 53, 26, 2,600 and 53 replications a selection.
static void selections_are_right_with_the_confidence_asked_for(void **state)
{
    enum { EXPERIMENTS = 400 };
    static const struct {
        selection choice;
        double common;
        size_t n_most; // replications, of all systems
    } cases[] = { { { 5, 10, 0.95, 0.5 }, 0.0, 150 },
                  { { 5, 10, 0.95, 0.5 }, 0.8, 60 },
                  { { 2, 3, 0.95, 1.0 }, 0.0, 20 },
                  { { 8, 3, 0.95, 0.5 }, 0.0, 260 },
                  { { 8, 5, 0.95, 2.0 }, 0.0, 52 } };

    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        size_t n_right = 0, n = 0;
        for (uint64_t k = 0; k < EXPERIMENTS; k++)
            n_right += is_selected_right(&cases[c].choice, k, cases[c].common, &n);
        assert_true(n_right >= 380);
        assert_true(n <= EXPERIMENTS * cases[c].n_most);
    }
}

static void runs_that_cannot_win_any_more_are_hopeless(void **state)
{
    const pruning_state jams = { FIGURE_JAM_TOTAL, false, 30.0, 12.0 };
    assert_true(pruning_is_hopeless(&jams, 11.9));
    assert_false(pruning_is_hopeless(&jams, 12.0));
    assert_false(pruning_is_hopeless(&jams, (double)NAN));
    // It may rise yet.
    assert_false(pruning_is_hopeless(&(pruning_state){ FIGURE_JAM_TOTAL, true, 30, 12 }, 100));
    // Not drained at 30 s; and drained at 20 s.
    const pruning_state not_drained = { FIGURE_DRAINED_AT, false, 30.0, (double)NAN };
    assert_true(pruning_is_hopeless(&not_drained, 29.0));
    assert_false(pruning_is_hopeless(&not_drained, 31.0));
    assert_false(pruning_is_hopeless(&(pruning_state){ FIGURE_DRAINED_AT, false, 30, 20 }, 25));
    // The smallest gap only falls; nothing is known yet; a mean does both.
    assert_true(pruning_is_hopeless(&(pruning_state){ FIGURE_GAP_MIN, true, 30, 0.1 }, 0.2));
    assert_false(pruning_is_hopeless(&(pruning_state){ FIGURE_GAP_MIN, true, 30, NAN }, 0.2));
    assert_false(pruning_is_hopeless(&(pruning_state){ FIGURE_THROUGHPUT, true, 30, 1 }, 9e9));
    assert_false(pruning_is_hopeless(&(pruning_state){ FIGURE_THROUGHPUT, false, 30, 9e9 }, 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_system_is_dropped_beyond_the_width_of_the_procedure),
        cmocka_unit_test(equal_systems_end_with_the_first_and_one_system_at_once),
        cmocka_unit_test(selections_are_right_with_the_confidence_asked_for),
        cmocka_unit_test(runs_that_cannot_win_any_more_are_hopeless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
