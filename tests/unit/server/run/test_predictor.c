// The predictor: runs that wait get a prediction when somebody asks for it.

#include "server/run/predictor.h"

#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include <math.h>

static double await_seconds(predictor *p, const char *run_id)
{
    double seconds;

    HELPER_AWAIT(!isnan(seconds = predictor_seconds(p, run_id, "")));
    return seconds;
}

static void test_runs_that_wait_are_predicted_when_asked_for(void **state)
{
    helper_store *h = *state;
    prediction_speed speed;
    predictor *p;

    const api_run first = helper_submit_solvable(h->store),
                  second = helper_submit_solvable(h->store);
    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    const double seconds = await_seconds(p, first.id);
    assert_true(seconds > 0.0 && seconds < 60.0);
    HELPER_AWAIT(predictor_speed(p, &speed));
    for (size_t k = 0; k < PREDICTION_KIND_COUNT; k++)
        assert_true(speed.factors[k] > 0.0);
    assert_true(await_seconds(p, second.id) == seconds);
    assert_null(predictor_stop(p));
}

static void test_runs_that_do_not_wait_are_not_predicted(void **state)
{
    helper_store *h = *state;
    predictor *p;

    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    const api_run gone = helper_submit_solvable(h->store);
    assert_int_equal(store_remove(h->store, gone.id, API_ANY_REVISION, NULL), BF_OK);
    assert_true(isnan(predictor_seconds(p, gone.id, "")));
    const api_run waiting = helper_submit_solvable(h->store);
    assert_true(await_seconds(p, waiting.id) > 0.0); // and the one before it was looked at
    assert_true(isnan(predictor_seconds(p, gone.id, "")));
    assert_null(predictor_stop(p));
}

// Of 1, 2, ..., 16 the mean is 8.5; after that a trial counts for a sixteenth.
static void test_trials_take_as_long_on_average_as_those_before_them(void **state)
{
    static const char id[API_ID_SIZE] = "01890a5d-ac96-774b-bcce-b302099a8057";
    helper_store *h = *state;
    predictor *p;

    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    const api_run trial = helper_submit_solvable(h->store);
    for (int n = 1; n <= 16; n++)
        predictor_learn(p, id, n);
    assert_true(fabs(predictor_seconds(p, trial.id, id) - 8.5) < 1e-12);
    predictor_learn(p, id, 24.5);
    assert_true(fabs(predictor_seconds(p, trial.id, id) - 9.5) < 1e-12);
    assert_null(predictor_stop(p));
}

// What all corrections of the costs add up to.
static double corrections_of(predictor *p)
{
    prediction_speed speed;
    double sum = 0.0;

    HELPER_AWAIT(predictor_speed(p, &speed));
    for (size_t k = 0; k < PREDICTION_KIND_COUNT; k++)
        for (size_t i = 0; i < PREDICTION_TERM_COUNT; i++)
            sum += speed.corrections[k][i];
    return sum;
}

// A run that took four times as long as predicted: the next one is predicted to take longer. A predictor that starts later learns from
// it, too; it measures the machine anew, so only the sign of what it learns is certain.
static void test_what_runs_took_corrects_what_is_predicted(void **state)
{
    helper_store *h = *state;
    predictor *p;

    const api_run first = helper_submit_solvable(h->store),
                  second = helper_submit_solvable(h->store);
    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    const double before = await_seconds(p, first.id);
    (void)helper_claim(h->store);
    const store_ending ending = { .run_id = first.id,
                                  .state = RUN_SUCCEEDED,
                                  .cpu_s = 4.0 * before };
    api_run ended;
    assert_int_equal(store_finish(h->store, &ending, &ended, NULL), BF_OK);
    const double after = await_seconds(p, second.id);
    assert_true(after > sqrt(2.0) * before && after < 4.0 * before);
    assert_null(predictor_stop(p));
    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    (void)await_seconds(p, second.id);
    assert_true(corrections_of(p) > 0.0);
    assert_null(predictor_stop(p));
}

static void test_the_queue_takes_as_long_as_its_oldest_runs_on_average(void **state)
{
    helper_store *h = *state;
    predictor *p;

    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    assert_true(predictor_queue_seconds(p, 0) == 0.0);
    const api_run first = helper_submit_solvable(h->store);
    (void)helper_submit_solvable(h->store);
    assert_true(isnan(predictor_queue_seconds(p, 2))); // asked for now
    const double seconds = await_seconds(p, first.id);
    assert_true(predictor_queue_seconds(p, 4) == 4.0 * seconds);
    assert_null(predictor_stop(p));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_runs_that_wait_are_predicted_when_asked_for,
                                        helper_store_setup, helper_store_teardown),
        cmocka_unit_test_setup_teardown(test_trials_take_as_long_on_average_as_those_before_them,
                                        helper_store_setup, helper_store_teardown),
        cmocka_unit_test_setup_teardown(test_what_runs_took_corrects_what_is_predicted,
                                        helper_store_setup, helper_store_teardown),
        cmocka_unit_test_setup_teardown(test_the_queue_takes_as_long_as_its_oldest_runs_on_average,
                                        helper_store_setup, helper_store_teardown),
        cmocka_unit_test_setup_teardown(test_runs_that_do_not_wait_are_not_predicted,
                                        helper_store_setup, helper_store_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
