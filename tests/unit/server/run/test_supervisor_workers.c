// Tests of the supervisor with an executor whose jobs go to workers elsewhere: it takes as many as they have room for, what
// workers do wrong fails no run, and jobs outlive the daemon.

#include "tests/unit/server/helper_jobs.h"

#include "api/scenario/scenario.h"
#include "core/advice/plausible.h"

#include <math.h>
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
    helper_executor_end(f->executor, 0, API_JOB_EXITED);
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

// A solver that was stopped before its first step, as when its worker is drained while a large run is set up.
static void stop_at_once(helper_jobs *f, size_t index)
{
    const frame end = { .type = FRAME_END, .end = { .stopped = 1 } };

    helper_executor_begin(f->executor, index);
    helper_executor_send(f->executor, index, &end);
    helper_executor_end(f->executor, index, API_JOB_EXITED);
}

static api_run start_with_attempts(helper_jobs *f, uint64_t attempts_max)
{
    f->world->attempts_max = attempts_max;
    helper_world_reopen(f->world);
    helper_executor_employ(f->executor, 16);
    return helper_jobs_start(f);
}

// More often than a run may fail.
static void a_worker_that_is_drained_fails_no_run(void **state)
{
    helper_jobs *f = *state;
    const api_run solved = start_with_attempts(f, 2);

    for (size_t i = 0; i < 8; i++) {
        helper_executor_await(f->executor, i + 1);
        if (i % 2 == 0)
            stop_at_once(f, i);
        else
            helper_executor_end(f->executor, i, API_JOB_STOPPED); // it had not begun
    }
    helper_executor_await(f->executor, 9);
    assert_int_equal(helper_executor_job(f->executor, 0).n_blamed, 0);
    helper_executor_begin(f->executor, 8);
    helper_executor_finish(f->executor, 8, false);
    helper_await_state(f->world, solved.id, RUN_SUCCEEDED);
}

// A frame whose length has one wrong bit, and a stream that ends between two frames.
static void ends_of_a_workers_own_are_an_attempt_each(void **state)
{
    helper_jobs *f = *state;
    const frame progress = { .type = FRAME_PROGRESS, .progress = { .step = 5, .n_steps = 10 } };
    bf_buffer bytes = { 0 };
    const api_run solved = start_with_attempts(f, 4);

    helper_executor_begin(f->executor, 0);
    helper_encode(&progress, &bytes);
    bytes.bytes[15] ^= 1; // the highest byte of the length
    helper_executor_send_bytes(f->executor, 0, bytes.bytes, bytes.n);
    buffer_fini(&bytes);
    helper_executor_await(f->executor, 2);
    assert_int_equal(helper_executor_job(f->executor, 0).n_blamed, 1);
    helper_executor_begin(f->executor, 1);
    helper_executor_end(f->executor, 1, API_JOB_EXITED);
    helper_executor_await(f->executor, 3);
    assert_int_equal(helper_executor_job(f->executor, 1).n_blamed, 1);
    helper_executor_begin(f->executor, 2);
    helper_executor_end(f->executor, 2, API_JOB_KILLED); // by the kernel, for memory
    helper_executor_await(f->executor, 4);
    helper_executor_begin(f->executor, 3);
    helper_executor_lose(f->executor, 3);
    const api_run failed = helper_await_state(f->world, solved.id, RUN_FAILED);
    assert_int_equal(failed.error.code, BF_ELIMIT);
    assert_non_null(strstr(failed.error.text, "4 attempts at this run failed"));
    assert_non_null(strstr(failed.error.text, "the last one: whoever solved the run is gone"));
}

static void a_run_that_brings_something_new_has_all_its_attempts_again(void **state)
{
    helper_jobs *f = *state;
    const api_run solved = start_with_attempts(f, 2);

    for (size_t i = 0; i < 4; i++) {
        helper_executor_await(f->executor, i + 1);
        helper_executor_begin(f->executor, i);
        helper_executor_samples(f->executor, i, i, 1, 0);
        helper_await_samples(f->world, solved.id, i + 1);
        helper_executor_lose(f->executor, i);
    }
    helper_executor_await(f->executor, 5);
    helper_executor_lose(f->executor, 4);
    helper_executor_await(f->executor, 6);
    helper_executor_lose(f->executor, 5);
    helper_await_state(f->world, solved.id, RUN_FAILED);
}

// What a solver elsewhere says of a run is compared with the scenario, and with what came: not even one who knows the
// forms of both ends gets a run done without results.
static void an_end_without_results_is_no_success(void **state)
{
    helper_jobs *f = *state;
    frame begin = { .type = FRAME_BEGIN, .begin = { .model = RUN_MACRO } };
    frame end = { .type = FRAME_END };
    scene s;

    helper_executor_base(f->executor)->is_elsewhere = true;
    const api_run solved = start_with_attempts(f, 3);
    helper_executor_begin(f->executor, 0); // of ten steps, which the scenario has not
    helper_executor_finish(f->executor, 0, false);
    helper_executor_await(f->executor, 2);
    assert_int_equal(helper_executor_job(f->executor, 0).n_blamed, 1);

    bf_buffer text = { 0 };
    assert_int_equal(store_read_text(f->world->store, solved.id, API_TEXT_SCENARIO, &text, NULL),
                     BF_OK);
    assert_int_equal(scenario_read_resolved(text.bytes, text.n, &s, NULL), BF_OK);
    buffer_fini(&text);
    const double dt = scene_macro_step(&s);
    begin.begin.n_columns = 2;
    begin.begin.dt = dt;
    begin.begin.n_steps = (uint64_t)ceil(s.duration / dt - 1e-9);
    begin.begin.duration = (double)begin.begin.n_steps * dt;
    begin.begin.grid = scene_grid(&s);
    begin.begin.definition = run_definition(&s, RUN_MACRO);
    end.end = (frame_end){ .n_steps = begin.begin.n_steps,
                           .t = begin.begin.duration,
                           .n_cells = grid_cells(&begin.begin.grid),
                           .n_samples = 41,
                           .n_snapshots = 11 };
    bf_error why = { 0 };
    if (plausible_end(&s, RUN_MACRO, &begin.begin, &end.end, &why) != BF_OK)
        fail_msg("%s", why.text);
    scene_fini(&s);
    for (size_t i = 1; i < 3; i++) {
        helper_executor_await(f->executor, i + 1);
        helper_executor_send(f->executor, i, &begin);
        if (i == 2) // all samples, no snapshot
            helper_executor_samples(f->executor, i, 0, 41, 0);
        helper_executor_send(f->executor, i, &end);
        helper_executor_end(f->executor, i, API_JOB_EXITED);
    }
    const api_run failed = helper_await_state(f->world, solved.id, RUN_FAILED);
    assert_non_null(strstr(failed.error.text, "41 samples and 11 snapshots, of which"));
}

static void send_error(helper_jobs *f, size_t index)
{
    frame error = { .type = FRAME_ERROR };

    (void)bf_fail(&error.error, BF_EINPUT, "/belts/0", "the belt cannot be solved");
    helper_executor_send(f->executor, index, &error);
    helper_executor_end(f->executor, index, API_JOB_FAILED);
}

static void a_failure_that_another_does_not_have_fails_no_run(void **state)
{
    helper_jobs *f = *state;
    const api_run solved = start_with_attempts(f, 5);

    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 2, 0);
    send_error(f, 0);
    helper_executor_await(f->executor, 2);
    assert_int_equal(helper_executor_job(f->executor, 0).n_blamed, 0); // nobody knows yet
    helper_executor_begin(f->executor, 1);
    helper_executor_finish(f->executor, 1, false);
    helper_await_state(f->world, solved.id, RUN_SUCCEEDED);
}

static void a_failure_that_others_have_is_the_runs(void **state)
{
    helper_jobs *f = *state;
    const api_run solved = start_with_attempts(f, 5);

    for (size_t i = 0; i < 2; i++) {
        helper_executor_await(f->executor, i + 1);
        if (i == 0)
            helper_executor_begin(f->executor, i);
        send_error(f, i);
    }
    const api_run failed = helper_await_state(f->world, solved.id, RUN_FAILED);
    assert_int_equal(failed.error.code, BF_EINPUT);
    assert_string_equal(failed.error.pointer, "/belts/0");
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
        TEST(a_worker_that_is_drained_fails_no_run),
        TEST(ends_of_a_workers_own_are_an_attempt_each),
        TEST(a_run_that_brings_something_new_has_all_its_attempts_again),
        TEST(an_end_without_results_is_no_success),
        TEST(a_failure_that_another_does_not_have_fails_no_run),
        TEST(a_failure_that_others_have_is_the_runs),
        TEST(jobs_are_left_to_the_daemon_after_this_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
