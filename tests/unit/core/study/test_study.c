// Unit tests of studies by rounds. Trials are solved by a formula.

#include "core/study/study.h"

#include "core/base/memory.h"
#include "core/study/variates.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

// Least at (0.3, 0.6), with noise of deviation 0.02 of which nine tenths are common to all points of a substream. The
// macroscopic model has none, and is off by 0.05 of a parameter. No run is valid where the first one is above 0.95.
static void solve(const study *s, size_t trial, double *ret_values)
{
    const study_trial t = study_trial_at(s, trial);
    const study_point p = study_point_at(s, t.point);
    const bool is_macro = p.model == STUDY_MACRO;
    const variates_key common = { 1, VARIATES_STEP, 0, t.substream };
    const variates_key own = { 2, VARIATES_STEP, t.point, t.substream };
    const double noise =
        0.02 * (sqrt(0.9) * variates_normal(&common, 0) + sqrt(0.1) * variates_normal(&own, 0));
    const double a = p.at[0] - (is_macro ? 0.35 : 0.3), b = p.at[1] - 0.6;

    ret_values[0] = p.at[0] > 0.95 ? (double)NAN : a * a + 2.0 * b * b + (is_macro ? 0 : noise);
    ret_values[1] = (double)trial;
}

// Tells the trials of a round from `from` on, every `stride`-th first.
static void tell(study *s, size_t from, size_t stride)
{
    double values[2];

    for (size_t first = 0; first < stride; first++)
        for (size_t trial = from + first; trial < study_trials(s); trial += stride) {
            solve(s, trial, values);
            study_tell(s, trial, values);
        }
}

static study *begin(const study_definition *definition)
{
    study *s = NULL;

    assert_int_equal(study_create(definition, &s, NULL), BF_OK);
    return s;
}

// Rounds until the end.
static size_t finish(study *s, size_t stride)
{
    for (size_t rounds = 0;; rounds++) {
        const size_t from = study_trials(s);
        assert_int_equal(study_advance(s, NULL), BF_OK);
        assert_true(study_is_ended(s) == (study_trials(s) == from));
        if (study_is_ended(s))
            return rounds;
        tell(s, from, stride);
    }
}

static const study_definition definitions[] = {
    { .method = STUDY_GRID, .steps = { 11, 6 }, .n_replications = 2, .n_trials_max = 132 },
    { .method = STUDY_LIST, .n_points = 5, .n_replications = 1, .n_trials_max = 5 },
    { .method = STUDY_LHS, .n_points = 30, .n_replications = 1, .n_trials_max = 30 },
    { .method = STUDY_SOBOL, .n_points = 32, .n_replications = 3, .n_trials_max = 96 },
    { .method = STUDY_DIRECT, .n_replications = 2, .n_trials_max = 200, .tolerance = 1e-3 },
    { .method = STUDY_CMAES, .n_replications = 1, .n_trials_max = 200, .tolerance = 1e-3 },
    { .method = STUDY_SCREEN,
      .sweep = STUDY_SOBOL,
      .n_points = 64,
      .n_replications = 5,
      .n_trials_max = 400,
      .n_confirmed = 8,
      .confidence = 0.95,
      .indifference = 0.003 },
    { .method = STUDY_CALIBRATE,
      .n_points = 8,
      .n_replications = 1,
      .n_trials_max = 200,
      .tolerance = 1e-3,
      .confidence = 0.95,
      .n_independent = 20 },
};

enum { DEFINITIONS = sizeof definitions / sizeof *definitions };

static study_definition definition_of(size_t k)
{
    study_definition d = definitions[k];

    d.d = d.n_values = 2;
    d.seed = 4;
    d.has_chance = true;
    d.confidence = 0.95;
    return d;
}

static bool is_same_trial(const study *a, const study *b, size_t trial)
{
    const study_trial x = study_trial_at(a, trial), y = study_trial_at(b, trial);
    const study_point p = study_point_at(a, x.point), q = study_point_at(b, y.point);

    return x.point == y.point && x.substream == y.substream && p.model == q.model &&
           memcmp(p.at, q.at, 2 * sizeof *p.at) == 0;
}

static void trials_do_not_depend_on_the_order_in_which_others_end(void **state)
{
    for (size_t k = 0; k < DEFINITIONS; k++) {
        const study_definition d = definition_of(k);
        study *a = begin(&d), *b = begin(&d);
        assert_int_equal(finish(a, 1), finish(b, 3));
        assert_int_equal(study_trials(a), study_trials(b));
        assert_in_range(study_trials(a), 5, d.n_trials_max);
        for (size_t trial = 0; trial < study_trials(a); trial++)
            assert_true(is_same_trial(a, b, trial));
        assert_int_equal(study_best(a), study_best(b));
        study_destroy(a);
        study_destroy(b);
    }
}

// A study of which the first n trials are known makes the others as the one that was not cut, for each n.
static void a_study_that_was_cut_goes_on_with_the_same_trials(void **state)
{
    for (size_t k = 0; k < DEFINITIONS; k++) {
        const study_definition d = definition_of(k);
        study *whole = begin(&d);
        finish(whole, 1);
        for (size_t n = 0; n <= study_trials(whole); n++) {
            study *s = begin(&d);
            size_t from = 0;
            do {
                from = study_trials(s);
                assert_int_equal(study_advance(s, NULL), BF_OK);
                for (size_t t = from; t < study_trials(s) && t < n; t++)
                    study_tell(s, t, study_values(whole, t));
            } while (study_trials(s) <= n && study_trials(s) > from);
            for (size_t t = 0; t < study_trials(s); t++)
                assert_true(is_same_trial(whole, s, t));
            assert_true(study_trials(s) > n || study_is_ended(s));
            study_destroy(s);
        }
        study_destroy(whole);
    }
}

static void sweeps_have_all_points_at_once_with_common_substreams(void **state)
{
    const study_definition d = definition_of(0);
    study *s = begin(&d);
    assert_int_equal(finish(s, 1), 1);
    assert_int_equal(study_points(s), 66);
    assert_int_equal(study_trials(s), 132);
    for (size_t k = 0; k < 132; k++) {
        assert_int_equal(study_trial_at(s, k).point, k / 2);
        assert_int_equal(study_trial_at(s, k).substream, k % 2);
    }
    // (0.3, 0.6) is a point of the grid: 3 of 0, 0.1, ... and 3 of 0, 0.2, ...
    assert_int_equal(study_best(s), 3 * 6 + 3);
    const statistics_sample sample = study_sample(s, 21, 0), numbers = study_sample(s, 21, 1);
    assert_near(sample.mean, 0.5 * (study_values(s, 42)[0] + study_values(s, 43)[0]), 1e-15);
    assert_near(numbers.mean, 42.5, 1e-15);
    assert_int_equal(study_sample(s, 65, 0).n, 0); // at 1, where no run is valid
    study_destroy(s);
}

static void the_largest_is_best_where_more_is_better(void **state)
{
    study_definition d = definition_of(0);
    d.is_maximized = true;
    study *s = begin(&d);
    finish(s, 1);
    assert_int_equal(study_best(s), 9 * 6); // (0.9, 0): 0.36 + 0.72
    study_destroy(s);
}

// Noise of 0.02 hides the gap of points nearer than sqrt(0.02).
static void searches_come_near_the_best_point(void **state)
{
    for (size_t k = 4; k < 6; k++) {
        const study_definition d = definition_of(k);
        study *s = begin(&d);
        finish(s, 1);
        const study_point best = study_point_at(s, study_best(s));
        assert_near(best.at[0], 0.3, 0.14);
        assert_near(best.at[1], 0.6, 0.1);
        study_destroy(s);
    }
}

// The macroscopic model's best points are near (0.35, 0.6); of those the one is selected whose noiseless value is within
// the indifference of the best.
static void screening_confirms_the_best_points_of_a_sweep(void **state)
{
    const study_definition d = definition_of(6);
    study *s = begin(&d);
    finish(s, 1);
    assert_int_equal(study_points(s), 64 + 8);
    assert_true(study_is_decided(s));
    double least = INFINITY, last = 0.0;
    for (size_t k = 64; k < 72; k++) {
        const study_point p = study_point_at(s, k);
        assert_true(p.model == STUDY_MICRO && p.confirmed < 64 && p.n_trials >= 5);
        assert_memory_equal(p.at, study_point_at(s, p.confirmed).at, 2 * sizeof *p.at);
        const double macro = study_sample(s, p.confirmed, 0).mean;
        assert_true(macro >= last);
        last = macro;
        least = fmin(least, pow(p.at[0] - 0.3, 2) + 2 * pow(p.at[1] - 0.6, 2));
    }
    const study_point best = study_point_at(s, study_best(s));
    assert_true(!best.is_dropped && best.model == STUDY_MICRO);
    assert_true(pow(best.at[0] - 0.3, 2) + 2 * pow(best.at[1] - 0.6, 2) <= least + 0.003);
    study_destroy(s);
}

// Room for the first replications of 8 points, and not for more: it ends, and says that it is not sure.
static void a_selection_that_lacks_trials_is_not_decided(void **state)
{
    study_definition d = definition_of(6);
    d.n_trials_max = 64 + 8 * 5;
    d.indifference = 1e-6;
    study *s = begin(&d);
    finish(s, 1);
    assert_int_equal(study_trials(s), 104);
    assert_false(study_is_decided(s));
    assert_true(study_best(s) >= 64);
    study_destroy(s);
}

static void a_study_of_runs_that_all_fail_ends_without_a_best_point(void **state)
{
    static const double nothing[2] = { NAN, NAN };
    for (size_t k = 0; k < DEFINITIONS; k++) {
        const study_definition d = definition_of(k);
        study *s = begin(&d);
        for (size_t told = 0; !study_is_ended(s);) {
            assert_int_equal(study_advance(s, NULL), BF_OK);
            for (; told < study_trials(s); told++)
                study_tell(s, told, nothing);
        }
        assert_true(study_best(s) == SIZE_MAX);
        study_destroy(s);
    }
}

static void studies_beyond_their_limits_are_refused(void **state)
{
    study_definition d = definition_of(0);
    study *s;
    bf_error err;
    d.n_trials_max = 131;
    assert_int_equal(study_create(&d, &s, &err), BF_ELIMIT);
    d.n_trials_max = 1000000000;
    assert_int_equal(study_create(&d, &s, &err), BF_ELIMIT);
    d.n_trials_max = STUDY_TRIALS_MAX;
    d.steps[0] = d.steps[1] = SIZE_MAX / 2;
    assert_int_equal(study_create(&d, &s, &err), BF_ELIMIT);
}

// Of 5,000 trials DIRECT alone would make half.
static void a_search_ends_with_its_most_points(void **state)
{
    study_definition d = definition_of(4);
    d.n_replications = 1;
    d.n_trials_max = 5000;
    d.d = 5;
    study *s = begin(&d);
    finish(s, 1);
    assert_in_range(study_points(s), STUDY_SEARCH_MAX / 2, STUDY_SEARCH_MAX);
    study_destroy(s);
}

// Each allocation of two rounds fails once; the study is as it was, and goes on.
static void without_memory_a_study_stays_as_it_was(void **state)
{
    for (size_t k = 0; k < DEFINITIONS; k++) {
        const study_definition d = definition_of(k);
        study *whole = begin(&d), *s = begin(&d);
        finish(whole, 1);
        for (size_t told = 0, n_fault = 1; told < 60 && !study_is_ended(s); n_fault++) {
            memory_plan_fault(n_fault, 0);
            const bf_status status = study_advance(s, NULL);
            memory_plan_fault(0, 0);
            if (status != BF_OK) {
                assert_int_equal(status, BF_ENOMEM);
                assert_int_equal(study_trials(s), told);
                continue;
            }
            tell(s, told, 1);
            told = study_trials(s);
            n_fault = 0;
        }
        for (size_t t = 0; t < study_trials(s); t++)
            assert_true(is_same_trial(whole, s, t));
        study_destroy(whole);
        study_destroy(s);
    }
    study *s;
    const study_definition d = definition_of(0);
    memory_plan_fault(1, 0);
    assert_int_equal(study_create(&d, &s, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trials_do_not_depend_on_the_order_in_which_others_end),
        cmocka_unit_test(a_study_that_was_cut_goes_on_with_the_same_trials),
        cmocka_unit_test(sweeps_have_all_points_at_once_with_common_substreams),
        cmocka_unit_test(the_largest_is_best_where_more_is_better),
        cmocka_unit_test(searches_come_near_the_best_point),
        cmocka_unit_test(screening_confirms_the_best_points_of_a_sweep),
        cmocka_unit_test(a_selection_that_lacks_trials_is_not_decided),
        cmocka_unit_test(a_study_of_runs_that_all_fail_ends_without_a_best_point),
        cmocka_unit_test(studies_beyond_their_limits_are_refused),
        cmocka_unit_test(a_search_ends_with_its_most_points),
        cmocka_unit_test(without_memory_a_study_stays_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
