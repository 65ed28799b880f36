// Tests of the supervisor, with a real store, against jobs that are lost, late, truncated, repeated or unresponsive:
// no sample is stored twice, none is missing (I4), and each run ends in exactly one state.

#include "tests/unit/server/helper_jobs.h"

// ------------------------------------------------------------------------ what jobs send

static void a_lost_job_is_started_again_and_gives_the_same_data(void **state)
{
    helper_jobs *f = *state;
    helper_executor *e = f->executor;

    api_run record = helper_jobs_start(f);
    helper_executor_begin(e, 0);
    helper_executor_samples(e, 0, 0, 5, 0.0);
    helper_executor_snapshot(e, 0, 0);
    helper_executor_checkpoint(e, 0, 5);
    helper_executor_samples(e, 0, 5, 3, 0.0);
    helper_executor_lose(e, 0);
    helper_executor_await(e, 2);
    assert_true(helper_executor_job(e, 0).is_released);
    assert_string_equal(helper_executor_job(e, 1).run_id, record.id);
    assert_int_equal(helper_executor_job(e, 1).first_step, 5);
    // What it sent after the checkpoint is stored, and comes again.
    helper_executor_begin(e, 1);
    helper_executor_samples(e, 1, 5, 5, 0.0);
    helper_executor_snapshot(e, 1, 1);
    helper_executor_finish(e, 1, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, record.id, 10, 2);
}

static uint64_t charged_s(const helper_world *w)
{
    api_quotas quotas;

    assert_int_equal(store_read_quotas(w->store, "", &quotas, NULL), BF_OK);
    return quotas.cpu_s.used;
}

// I16: with a batch, with the loss of a job, and with the end.
static void the_cpu_time_of_all_attempts_is_charged(void **state)
{
    helper_jobs *f = *state;
    helper_executor *e = f->executor;

    api_run record = helper_jobs_start(f);
    helper_executor_use(e, 0, 2.0);
    helper_executor_begin(e, 0);
    helper_executor_samples(e, 0, 0, 5, 0.0);
    helper_await_samples(f->world, record.id, 5);
    assert_int_equal(charged_s(f->world), 2);
    helper_executor_use(e, 0, 4.0);
    helper_executor_lose(e, 0);
    helper_executor_await(e, 2);
    assert_int_equal(charged_s(f->world), 4);
    helper_executor_use(e, 1, 3.0);
    helper_executor_begin(e, 1);
    helper_executor_samples(e, 1, 0, 10, 0.0);
    helper_executor_finish(e, 1, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    assert_int_equal(charged_s(f->world), 7);
}

static void frames_that_come_twice_are_stored_once(void **state)
{
    helper_jobs *f = *state;

    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    for (int i = 0; i < 2; i++) {
        helper_executor_samples(f->executor, 0, 0, 5, 0.0);
        helper_executor_snapshot(f->executor, 0, 0);
        helper_executor_checkpoint(f->executor, 0, 5);
    }
    helper_executor_samples(f->executor, 0, 3, 4, 0.0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, record.id, 7, 1);
}

static void a_gap_fails_the_run(void **state)
{
    helper_jobs *f = *state;

    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 5, 0.0);
    helper_await_samples(f->world, record.id, 5);
    helper_executor_samples(f->executor, 0, 6, 1, 0.0);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ECORRUPT);
    helper_jobs_assert_data(f->world, record.id, 5, 0);
}

static void late_frames_of_a_job_before_are_ignored(void **state)
{
    helper_jobs *f = *state;
    helper_executor *e = f->executor;

    api_run record = helper_jobs_start(f);
    helper_executor_begin(e, 0);
    helper_executor_samples(e, 0, 0, 2, 0.0);
    helper_await_samples(f->world, record.id, 2);
    helper_executor_lose(e, 0);
    helper_executor_await(e, 2);
    // The first job comes back to life, with other numbers and an end of its own.
    helper_executor_samples(e, 0, 2, 8, 1000.0);
    helper_executor_finish(e, 0, false);
    helper_executor_begin(e, 1);
    helper_executor_samples(e, 1, 0, 6, 0.0);
    helper_await_samples(f->world, record.id, 6);
    helper_executor_finish(e, 1, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, record.id, 6, 0);
    assert_true(helper_executor_job(e, 0).n_unread > 0);
}

static void bytes_that_come_one_by_one_make_the_same_run(void **state)
{
    helper_jobs *f = *state;

    helper_executor_deliver_slowly(f->executor, 1);
    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 10, 0.0);
    helper_executor_checkpoint(f->executor, 0, 5);
    helper_executor_snapshot(f->executor, 0, 0);
    helper_executor_disconnect(f->executor, 0);
    helper_await_samples(f->world, record.id, 10);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, record.id, 10, 1);
}

// Send the first n bytes of a frame of one sample, and perhaps a wrong one.
static void send_torn(helper_executor *e, size_t index, size_t n_missing, bool is_damaged)
{
    const double t = 0.0, values[] = { 0.0, 0.0 };
    const frame f = { .type = FRAME_CURVE,
                      .curve = { .n = 1, .n_columns = 2, .t = &t, .values = values } };
    bf_buffer bytes = { 0 };

    assert_int_equal(frame_encode(&f, &bytes, NULL), BF_OK);
    if (is_damaged)
        bytes.bytes[bytes.n / 2] ^= 1;
    helper_executor_send_bytes(e, index, bytes.bytes, bytes.n - n_missing);
    buffer_fini(&bytes);
}

static void a_torn_frame_fails_the_run_unless_its_job_is_lost(void **state)
{
    helper_jobs *f = *state;
    helper_executor *e = f->executor;

    api_run record = helper_jobs_start(f);
    helper_executor_begin(e, 0);
    send_torn(e, 0, 3, false);
    helper_executor_lose(e, 0);
    helper_executor_await(e, 2);
    helper_executor_begin(e, 1);
    send_torn(e, 1, 3, false);
    helper_executor_end(e, 1, API_JOB_EXITED);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ECORRUPT);
}

static void a_damaged_frame_fails_the_run_and_stops_the_job(void **state)
{
    helper_jobs *f = *state;

    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    send_torn(f->executor, 0, 0, true);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ECORRUPT);
    assert_int_equal(helper_executor_job(f->executor, 0).n_now, 1);
}

// ------------------------------------------------------------------------ starting and stopping

static void a_job_that_is_refused_for_now_is_started_later(void **state)
{
    helper_jobs *f = *state;

    helper_executor_refuse(f->executor, 1, BF_EBUSY);
    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
}

// Until a run has begun the service is not ready.
static void a_job_that_the_system_refuses_is_started_later(void **state)
{
    helper_jobs *f = *state;
    bf_error err = { 0 };

    helper_executor_refuse(f->executor, 1, BF_ESYSTEM);
    api_run record = helper_jobs_start(f);
    assert_int_equal(supervisor_ready(f->world->supervisor, &err), BF_ESYSTEM);
    assert_string_equal(err.text, "there is no place for a job");
    helper_executor_begin(f->executor, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    assert_int_equal(supervisor_ready(f->world->supervisor, &err), BF_OK);
}

static void a_job_that_is_refused_for_good_fails_the_run(void **state)
{
    helper_jobs *f = *state;

    helper_executor_refuse(f->executor, 1, BF_ELIMIT);
    helper_supervise(f->world);
    api_run record = helper_world_submit(f->world, helper_jobs_belt);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ELIMIT);
}

static void a_job_that_answers_no_stop_is_given_up(void **state)
{
    helper_jobs *f = *state;

    helper_executor_ignore_stops(f->executor);
    api_run record = helper_jobs_start(f);
    helper_world_cancel(f->world, record.id);
    helper_await_state(f->world, record.id, RUN_CANCELLED);
    helper_job job = helper_executor_job(f->executor, 0);
    assert_int_equal(job.n_graceful, 1);
    assert_int_equal(job.n_now, 1);
    // One that is to be removed gets no time.
    record = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_await(f->executor, 2);
    helper_world_kill(f->world, record.id);
    assert_int_equal(helper_executor_job(f->executor, 1).n_graceful, 0);
    // When the daemon stops, the run is not lost.
    record = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_await(f->executor, 3);
    helper_world_stop(f->world, 50);
    assert_int_equal(store_find(f->world->store, record.id, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_QUEUED);
    assert_true(helper_executor_job(f->executor, 2).is_released);
}

static void a_stop_that_is_requested_twice_is_signalled_once(void **state)
{
    helper_jobs *f = *state;

    f->world->options.stop_grace_ms = 60000;
    helper_executor_ignore_stops(f->executor);
    api_run record = helper_jobs_start(f);
    for (int i = 0; i < 3; i++)
        helper_world_cancel(f->world, record.id);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 1, 0.0);
    helper_await_samples(f->world, record.id, 1);
    helper_executor_finish(f->executor, 0, true);
    helper_await_state(f->world, record.id, RUN_CANCELLED);
    assert_int_equal(helper_executor_job(f->executor, 0).n_graceful, 1);
}

int main(void)
{
#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_jobs_setup, helper_jobs_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_lost_job_is_started_again_and_gives_the_same_data),
        TEST(the_cpu_time_of_all_attempts_is_charged),
        TEST(frames_that_come_twice_are_stored_once),
        TEST(a_gap_fails_the_run),
        TEST(late_frames_of_a_job_before_are_ignored),
        TEST(bytes_that_come_one_by_one_make_the_same_run),
        TEST(a_torn_frame_fails_the_run_unless_its_job_is_lost),
        TEST(a_damaged_frame_fails_the_run_and_stops_the_job),
        TEST(a_job_that_is_refused_for_now_is_started_later),
        TEST(a_job_that_the_system_refuses_is_started_later),
        TEST(a_job_that_is_refused_for_good_fails_the_run),
        TEST(a_job_that_answers_no_stop_is_given_up),
        TEST(a_stop_that_is_requested_twice_is_signalled_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
