// The predictor when a kind of solver cannot be measured: this prediction_measure() stands in the library's place.

#include "core/advice/prediction.h"
#include "server/run/predictor.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include <math.h>
#include <stdatomic.h>

static atomic_int n_measured;

bf_status prediction_measure(prediction_kind kind, double (*cpu_s)(void), double least_s,
                             double *ret_factor, bf_error *err)
{
    (void)cpu_s;
    if (atomic_fetch_add(&n_measured, 1) == 0)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    *ret_factor = 1.0;
    return BF_OK;
}

static void test_after_a_failure_the_next_run_is_predicted(void **state)
{
    helper_store *h = *state;
    predictor *p;

    const api_run first = helper_submit_solvable(h->store);
    const api_run second = helper_submit_solvable(h->store);
    assert_int_equal(predictor_start(h->store, &p, NULL), BF_OK);
    assert_true(isnan(predictor_seconds(p, first.id, "")));
    HELPER_AWAIT(atomic_load(&n_measured) == 1);
    HELPER_AWAIT(!isnan(predictor_seconds(p, second.id, "")));
    assert_null(predictor_stop(p));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_after_a_failure_the_next_run_is_predicted,
                                        helper_store_setup, helper_store_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
