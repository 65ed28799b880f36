// The predictor: runs that wait get a prediction when somebody asks for it.

#include "server/run/predictor.h"

#include "api/scenario/scenario.h"
#include "api/scenario/submission.h"
#include "server/base/clock.h"
#include "tests/unit/server/helper_store.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

enum { PATIENCE_MS = 60000 };

static const char document[] =
    "{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
    "\"belts\":[{\"velocity_m_s\":[0.4,0]}],"
    "\"initial\":{\"hexagonal\":{\"rows\":4,\"columns\":4,\"first_m\":[0.1,0.1],"
    "\"spacing_m\":0.03}},\"cargo\":{\"shape\":{\"type\":\"cylinder\"}},\"macro\":{\"step_s\":"
    "\"auto\"}}";

static api_run submit_scene(store *s)
{
    api_submission submission;
    bf_faults faults = { 0 };
    scene of;

    assert_int_equal(scenario_read(document, sizeof document - 1, &of, &faults, NULL), BF_OK);
    assert_int_equal(submission_make(&of, RUN_MACRO, &submission, NULL), BF_OK);
    scene_fini(&of);
    const api_run record = helper_accept(s, &submission);
    submission_fini(&submission);
    return record;
}

static double await_seconds(predictor *p, const char *run_id)
{
    const int64_t until_ms = clock_monotonic_ms() + PATIENCE_MS;
    double seconds;

    while (isnan(seconds = predictor_seconds(p, run_id)) && clock_monotonic_ms() < until_ms)
        usleep(1000);
    return seconds;
}

static void test_runs_that_wait_are_predicted_when_asked_for(void **state)
{
    helper_store *h = *state;
    prediction_speed speed;
    predictor *p;

    const api_run first = submit_scene(h->store), second = submit_scene(h->store);
    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    const double seconds = await_seconds(p, first.id);
    assert_true(seconds > 0.0 && seconds < 60.0);
    assert_true(predictor_speed(p, &speed));
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
    const api_run gone = submit_scene(h->store);
    assert_int_equal(store_remove(h->store, gone.id, API_ANY_REVISION, NULL), BF_OK);
    assert_true(isnan(predictor_seconds(p, gone.id)));
    const api_run waiting = submit_scene(h->store);
    assert_true(await_seconds(p, waiting.id) > 0.0); // and the one before it was looked at
    assert_true(isnan(predictor_seconds(p, gone.id)));
    assert_null(predictor_stop(p));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_runs_that_wait_are_predicted_when_asked_for,
                                        helper_store_setup, helper_store_teardown),
        cmocka_unit_test_setup_teardown(test_runs_that_do_not_wait_are_not_predicted,
                                        helper_store_setup, helper_store_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
