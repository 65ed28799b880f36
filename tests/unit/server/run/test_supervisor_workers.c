// Tests of the supervisor with an executor whose jobs go to workers elsewhere: it takes as many as they have room for, what
// workers do wrong fails no run, and jobs outlive the daemon.

#include "tests/unit/server/helper_jobs.h"

#include <string.h>

static int setup(void **state)
{
    int result = helper_jobs_setup(state);
    helper_jobs *f = *state;

    f->world->options.n_workers = 1;
    helper_executor_employ(f->executor, 2);
    return result;
}

static void as_many_are_claimed_as_workers_take(void **state)
{
    helper_jobs *f = *state;
    api_run third;

    const api_run first = helper_jobs_start(f);
    const api_run second = helper_world_submit(f->world, helper_jobs_belt);
    helper_await_state(f->world, second.id, RUN_RUNNING);
    third = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 1, 0);
    helper_await_samples(f->world, first.id, 1);
    assert_int_equal(store_find(f->world->store, third.id, &third, NULL), BF_OK);
    assert_int_equal(third.state, RUN_QUEUED);
    helper_executor_employ(f->executor, 1);
    helper_await_state(f->world, third.id, RUN_RUNNING);
}

// The next attempt begins where the damage began, and counts.
static void assert_goes_on(helper_jobs *f, const char *id)
{
    helper_executor_await(f->executor, 2);
    assert_int_equal(helper_executor_job(f->executor, 0).n_blamed, 1);
    assert_int_equal(supervisor_ready(f->world->supervisor, NULL), BF_OK);
    helper_executor_begin(f->executor, 1);
    helper_executor_samples(f->executor, 1, 0, 3, 0);
    helper_executor_finish(f->executor, 1, false);
    helper_await_state(f->world, id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, id, 3, 0);
}

static void damage_is_the_workers(void **state)
{
    helper_jobs *f = *state;
    const frame progress = { .type = FRAME_PROGRESS, .progress = { .step = 5, .n_steps = 10 } };
    bf_buffer bytes = { 0 };

    const api_run solved = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 2, 0);
    helper_encode(&progress, &bytes);
    bytes.bytes[20] ^= 1;
    helper_executor_send_bytes(f->executor, 0, bytes.bytes, bytes.n);
    buffer_fini(&bytes);
    assert_goes_on(f, solved.id);
}

static void a_torn_end_is_the_workers(void **state)
{
    helper_jobs *f = *state;
    const frame end = { .type = FRAME_END, .end = { .n_steps = 10 } };
    bf_buffer bytes = { 0 };

    const api_run solved = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_encode(&end, &bytes);
    helper_executor_send_bytes(f->executor, 0, bytes.bytes, bytes.n - 8);
    helper_executor_end(f->executor, 0, EXECUTOR_EXITED);
    buffer_fini(&bytes);
    assert_goes_on(f, solved.id);
}

static void a_gap_is_the_workers(void **state)
{
    helper_jobs *f = *state;

    const api_run solved = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 7, 1, 0);
    assert_goes_on(f, solved.id);
}

// Of the 2 GiB that the header says, nothing else comes.
static void a_frame_without_measure_takes_no_memory(void **state)
{
    helper_jobs *f = *state;
    const frame begin = { .type = FRAME_PROGRESS, .progress = { .n_steps = 10 } };
    const uint64_t length = UINT64_C(1) << 31;
    bf_buffer bytes = { 0 };

    const api_run solved = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_encode(&begin, &bytes);
    memcpy(bytes.bytes + 8, &length, sizeof length);
    helper_executor_send_bytes(f->executor, 0, bytes.bytes, 24);
    buffer_fini(&bytes);
    assert_goes_on(f, solved.id);
}

static void a_lost_job_holds_nobody_up(void **state)
{
    helper_jobs *f = *state;

    const api_run solved = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_lose(f->executor, 0);
    helper_executor_await(f->executor, 2);
    helper_executor_begin(f->executor, 1);
    helper_executor_finish(f->executor, 1, false);
    helper_await_state(f->world, solved.id, RUN_SUCCEEDED);
}

static void jobs_are_left_to_the_daemon_after_this_one(void **state)
{
    helper_jobs *f = *state;
    store_running running = { .id = "" };
    size_t n = 0;

    const api_run solved = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 2, 0);
    helper_await_samples(f->world, solved.id, 2);
    helper_world_stop(f->world, 1000);
    const helper_job job = helper_executor_job(f->executor, 0);
    assert_true(job.is_released);
    assert_int_equal(job.n_now, 0);
    assert_int_equal(store_list_running(f->world->store, 1, &running, &n, NULL), BF_OK);
    assert_int_equal(n, 1);
    assert_string_equal(running.id, solved.id);
    assert_string_equal(running.external_id, "fake:0");
}

int main(void)
{
#define TEST(function) cmocka_unit_test_setup_teardown(function, setup, helper_jobs_teardown)
    const struct CMUnitTest tests[] = {
        TEST(as_many_are_claimed_as_workers_take),
        TEST(damage_is_the_workers),
        TEST(a_torn_end_is_the_workers),
        TEST(a_gap_is_the_workers),
        TEST(a_frame_without_measure_takes_no_memory),
        TEST(a_lost_job_holds_nobody_up),
        TEST(jobs_are_left_to_the_daemon_after_this_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
