// Tests of a supervisor that finds runs which a daemon before left running.

#include "tests/unit/server/helper_jobs.h"

// A run that the daemon before left running, with its job's name in the store.
static api_run leave_running(helper_jobs *f, const char *external_id)
{
    store_job job = { .step = 0 };

    api_run record = helper_world_submit(f->world, helper_jobs_belt);
    assert_int_equal(store_claim(f->world->store, true, &job, NULL), BF_OK);
    store_job_fini(&job);
    assert_int_equal(store_set_external_id(f->world->store, record.id, external_id, NULL), BF_OK);
    return record;
}

static void a_job_that_goes_on_is_taken_over(void **state)
{
    helper_jobs *f = *state;
    helper_executor *e = f->executor;

    api_run record = leave_running(f, "fake:1");
    // Two jobs of one run: only the one that the store names counts.
    (void)helper_executor_add(e, record.id);
    (void)helper_executor_add(e, record.id);
    helper_executor_begin(e, 0);
    helper_executor_samples(e, 0, 0, 9, 1000.0);
    helper_world_reopen(f->world);
    assert_int_equal(store_find(f->world->store, record.id, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_RUNNING);
    helper_supervise(f->world);
    helper_executor_begin(e, 1);
    helper_executor_samples(e, 1, 0, 4, 0.0);
    helper_executor_finish(e, 1, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, record.id, 4, 0);
    api_run next = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_await(e, 3);
    assert_string_equal(helper_executor_job(e, 2).run_id, next.id);
}

static void a_run_whose_job_is_gone_is_queued_again(void **state)
{
    helper_jobs *f = *state;

    api_run record = leave_running(f, "fake:77");
    helper_world_reopen(f->world);
    assert_int_equal(store_find(f->world->store, record.id, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_QUEUED);
    helper_supervise(f->world);
    helper_executor_await(f->executor, 1);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 4, 0.0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, record.id, 4, 0);
}

// The daemon ended after it had accepted the request and before the run had stopped.
static void a_stop_request_outlives_the_daemon(void **state)
{
    helper_jobs *f = *state;

    api_run gone = leave_running(f, "fake:77"), there = leave_running(f, "fake:0");
    (void)helper_executor_add(f->executor, there.id);
    helper_world_cancel(f->world, gone.id);
    helper_world_cancel(f->world, there.id);
    helper_world_reopen(f->world);
    assert_int_equal(store_find(f->world->store, gone.id, &gone, NULL), BF_OK);
    assert_int_equal(gone.state, RUN_CANCELLED);
    helper_executor_begin(f->executor, 0);
    helper_supervise(f->world);
    helper_await_state(f->world, there.id, RUN_CANCELLED);
    assert_int_equal(helper_executor_job(f->executor, 0).n_graceful, 1);
    // Neither is solved again: the next job is of the next run.
    api_run next = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_await(f->executor, 2);
    assert_string_equal(helper_executor_job(f->executor, 1).run_id, next.id);
}

int main(void)
{
#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_jobs_setup, helper_jobs_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_job_that_goes_on_is_taken_over),
        TEST(a_run_whose_job_is_gone_is_queued_again),
        TEST(a_stop_request_outlives_the_daemon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
