// Unit tests of calibration. Curves are formulas of two or three parameters.

#include "core/study/calibration.h"

#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

enum { CURVES = 3, SAMPLES = 40 };

// Parts at t in [0, 1] by curve j: the first parameter is a rate, the second a delay, the third does nothing.
static double parts_at(const double *x, size_t j, double t)
{
    const double delay = 0.1 + 0.4 * x[1], rate = 100.0 + 100.0 * x[0];

    return fmax(0.0, 150.0 + 20.0 * (double)j - rate * fmax(0.0, t - delay));
}

// The first curve was measured with an error of three parts that the model cannot follow.
static void solve(const study *s, size_t trial, const double *truth, double error,
                  double *ret_values)
{
    const study_point p = study_point_at(s, study_trial_at(s, trial).point);

    for (size_t j = 0; j < CURVES; j++) {
        ret_values[j] = 0.0;
        for (size_t k = 0; k < SAMPLES; k++) {
            const double t = (double)k / (SAMPLES - 1);
            const double gap = parts_at(p.at, j, t) - parts_at(truth, j, t) -
                               (j == 0 ? error * sin(25.0 * t) : 0.0);
            ret_values[j] += gap * gap / SAMPLES;
        }
    }
}

static study *calibrate(size_t d, const double *truth, double error, size_t n_trials)
{
    const study_definition definition = { .method = STUDY_CALIBRATE,
                                          .d = d,
                                          .n_values = CURVES,
                                          .seed = 2,
                                          .n_trials_max = n_trials,
                                          .n_replications = 1,
                                          .n_points = 8,
                                          .tolerance = 1e-4,
                                          .confidence = 0.95,
                                          .n_independent = 30 };
    study *s = NULL;
    assert_int_equal(study_create(&definition, &s, NULL), BF_OK);
    for (size_t told = 0; !study_is_ended(s);) {
        assert_int_equal(study_advance(s, NULL), BF_OK);
        for (; told < study_trials(s); told++) {
            double values[CURVES];
            solve(s, told, truth, error, values);
            study_tell(s, told, values);
        }
    }
    assert_in_range(study_trials(s), 9, n_trials);
    return s;
}

static void parameters_are_found_again_and_one_without_effect_is_not_identifiable(void **state)
{
    static const double truth[3] = { 0.37, 0.62, 0.5 };
    study *s = calibrate(3, truth, 0.0, 2500);
    const study_point best = study_point_at(s, study_best(s));
    for (size_t i = 0; i < 2; i++) {
        const calibration_profile profile = calibration_profile_of(s, i);
        assert_near(best.at[i], truth[i], 0.002);
        assert_true(profile.is_identifiable);
        assert_true(profile.low < truth[i] && truth[i] < profile.high);
        assert_true(profile.high - profile.low < 0.1);
    }
    const calibration_profile profile = calibration_profile_of(s, 2);
    assert_false(profile.is_identifiable);
    assert_true(profile.low == 0.0 && profile.high == 1.0);
    study_destroy(s);
}

// With errors of three parts in the first curve the others are predicted without: its own mean square stays 9/2.
static void a_curve_that_is_left_out_shows_how_well_it_is_predicted(void **state)
{
    static const double truth[2] = { 0.37, 0.62 };
    study *s = calibrate(2, truth, 3.0, 400);
    const size_t without = calibration_without(s, 0);
    const study_point p = study_point_at(s, without);
    assert_near(p.at[0], truth[0], 0.002);
    assert_near(p.at[1], truth[1], 0.002);
    assert_near(study_sample(s, without, 0).mean, 4.5, 0.5);
    assert_true(study_sample(s, calibration_without(s, 1), 1).mean > 1e-4);
    study_destroy(s);
}

static double slope(double x)
{
    return 20.0 * (x - 0.5);
}

// As near at x = 0.4 and from 0.65 to 0.85.
static double two_valleys(double x)
{
    return x > 0.65 && x < 0.85 ? 0.01 : 20.0 * (x - 0.4);
}

static double jumps(double x)
{
    return 8.0 * sin(1e5 * x);
}

// A calibration of one parameter to one curve, which is off by error(x) parts.
static study *calibrate_one(size_t n_points, double tolerance, double n_independent,
                            double (*error)(double x))
{
    const study_definition definition = { .method = STUDY_CALIBRATE,
                                          .d = 1,
                                          .n_values = 1,
                                          .seed = 2,
                                          .n_trials_max = 200,
                                          .n_replications = 1,
                                          .n_points = n_points,
                                          .tolerance = tolerance,
                                          .confidence = 0.95,
                                          .n_independent = n_independent };
    study *s = NULL;
    assert_int_equal(study_create(&definition, &s, NULL), BF_OK);
    for (size_t told = 0; !study_is_ended(s);) {
        assert_int_equal(study_advance(s, NULL), BF_OK);
        for (; told < study_trials(s); told++) {
            const double e = error(study_point_at(s, study_trial_at(s, told).point).at[0]);
            study_tell(s, told, &(double){ e * e });
        }
    }
    return s;
}

// One parameter x whose curve is off by 20 (x - 1/2) parts: mse = 400 (x - 1/2)^2. Next to the answer, 1/500 away, it is
// 0.0016, the near cost two thirds of that. At the first places, 1/16 away, mse is 1.5625 and the distance sqrt(30 ln
// ((1.5625 + 1/12)/(0.0032/3 + 1/12))) = 9.440; 1.96 of it is at 1/16 1.96/9.440 = 0.01298.
static void the_profile_of_one_parameter_is_the_one_derived_by_hand(void **state)
{
    study *s = calibrate_one(4, 1e-6, 30, slope);
    const calibration_profile profile = calibration_profile_of(s, 0);
    assert_near(study_point_at(s, study_best(s)).at[0], 0.5, 1e-5);
    assert_near(profile.low, 0.5 - 0.01298, 1e-4);
    assert_near(profile.high, 0.5 + 0.01298, 1e-4);
    assert_true(calibration_without(s, 0) == SIZE_MAX);
    study_destroy(s);
}

// The curve jumps by 8 to either side from place to place, by whatever the parameter is but near the truth: the search finds
// one place where it does not, and does not claim that this one is the truth.
static void a_lucky_point_of_a_curve_that_jumps_is_not_identified(void **state)
{
    study *s = calibrate_one(32, 1e-4, 20, jumps);
    assert_true(study_sample(s, study_best(s), 0).mean < 1.0);
    assert_false(calibration_profile_of(s, 0).is_identifiable);
    study_destroy(s);
}

// The first place of a profile is far off on either side of both valleys, and says nothing of the other one.
static void what_was_tried_and_agrees_lies_in_the_interval(void **state)
{
    study *s = calibrate_one(8, 1e-6, 30, two_valleys);
    const calibration_profile profile = calibration_profile_of(s, 0);
    assert_true(profile.low <= 0.4 && profile.low > 0.3);
    assert_true(profile.high >= 0.65 && profile.high < 0.9);
    assert_true(profile.is_identifiable);
    study_destroy(s);
}

static void a_calibration_short_of_trials_ends_and_claims_nothing(void **state)
{
    static const double truth[2] = { 0.37, 0.62 };
    study *s = calibrate(2, truth, 0.0, 14);
    assert_true(study_best(s) != SIZE_MAX);
    for (size_t i = 0; i < 2; i++)
        assert_false(calibration_profile_of(s, i).is_identifiable);
    study_destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parameters_are_found_again_and_one_without_effect_is_not_identifiable),
        cmocka_unit_test(a_curve_that_is_left_out_shows_how_well_it_is_predicted),
        cmocka_unit_test(the_profile_of_one_parameter_is_the_one_derived_by_hand),
        cmocka_unit_test(a_lucky_point_of_a_curve_that_jumps_is_not_identified),
        cmocka_unit_test(what_was_tried_and_agrees_lies_in_the_interval),
        cmocka_unit_test(a_calibration_short_of_trials_ends_and_claims_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
