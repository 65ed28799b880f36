// Tests of the supervisor, with a real store, against jobs that are lost, late, truncated, repeated or unresponsive:
// no sample is stored twice, none is missing (I4), and each run ends in exactly one state.

#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "tests/unit/server/helper_executor.h"
#include "tests/unit/server/helper_store.h"
#include "tests/unit/server/helper_supervisor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Its curve has two columns; what its jobs send is ours.
static const char belt[] = "{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
                           "\"cargo\":{},\"initial\":{\"positions_m\":[[0.5,0.3]]},"
                           "\"macro\":{\"cell_m\":0.02,\"step_s\":\"auto\"}}";

// A world whose supervisor, once started, has an executor of ours.
typedef struct fixture {
    helper_world *world;
    helper_executor *executor;
} fixture;

static int setup(void **state)
{
    static fixture f;
    void *world;

    assert_int_equal(helper_world_setup(&world), 0);
    f.world = world;
    f.executor = helper_executor_create();
    f.world->options.executor = helper_executor_base(f.executor);
    // So that tests of unresponsive jobs are short.
    f.world->options.stop_grace_ms = 50;
    f.world->options.lost_ms = 50;
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    fixture *f = *state;
    void *world = f->world;

    int code = helper_world_teardown(&world);
    helper_executor_destroy(f->executor);
    return code;
}

// Start the supervisor, and a run in it; the run's job is number 0.
static api_run start_run(fixture *f)
{
    helper_supervise(f->world);
    api_run record = helper_world_submit(f->world, belt);
    helper_executor_await(f->executor, 1);
    return helper_await_state(f->world, record.id, RUN_RUNNING);
}

// The run has samples 0 to n - 1 of helper_executor_samples() without offset, once each, with one event
// for each, and snapshots 0 to n_snapshots - 1.
static bf_status count_samples(void *context, const api_event *event, bf_error *err)
{
    uint64_t *n = context;
    unsigned long long first = 0, count = 0;

    (void)err;
    if (event->type != API_EVENT_CURVE)
        return BF_OK;
    const char *at = strstr(event->data, "\"first\":");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "\"first\":%llu", &first), 1);
    at = strstr(event->data, "\"t_s\":[");
    assert_non_null(at);
    for (at += strlen("\"t_s\":"); *at != ']'; at++)
        count += *at == '[' || *at == ',';
    assert_int_equal(first, *n);
    *n += count;
    return BF_OK;
}

static void assert_data(helper_world *w, const char *id, uint64_t n, uint64_t n_snapshots)
{
    api_curve curve = { 0 };
    bf_buffer rho = { 0 };
    api_snapshot snapshot;
    bf_grid grid;
    uint64_t n_published = 0;

    assert_int_equal(store_read_curve(w->store, id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_int_equal(curve.t.n, n * sizeof(double));
    for (uint64_t i = 0; i < n; i++) {
        const double *values = (const double *)(const void *)curve.values.bytes + 2 * i;
        assert_true(((const double *)(const void *)curve.t.bytes)[i] == (double)i / 100);
        assert_true(values[0] == (double)i && values[1] == 0.5 * (double)i);
    }
    api_curve_fini(&curve);
    assert_int_equal(store_read_events(w->store, (const char(*)[API_ID_SIZE])id, 1, 0, SIZE_MAX,
                                       count_samples, &n_published, NULL),
                     BF_OK);
    assert_int_equal(n_published, n);
    for (uint64_t i = 0; i < n_snapshots; i++) {
        rho.n = 0;
        assert_int_equal(store_read_snapshot(w->store, id, i, &snapshot, &grid, &rho, NULL), BF_OK);
        assert_true(((const float *)(const void *)rho.bytes)[7] == (float)i);
    }
    assert_int_equal(store_read_snapshot(w->store, id, n_snapshots, &snapshot, &grid, &rho, NULL),
                     BF_ENOTFOUND);
    buffer_fini(&rho);
}

// ------------------------------------------------------------------------ what jobs send

static void a_lost_job_is_started_again_and_gives_the_same_data(void **state)
{
    fixture *f = *state;
    helper_executor *e = f->executor;

    api_run record = start_run(f);
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
    assert_data(f->world, record.id, 10, 2);
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
    fixture *f = *state;
    helper_executor *e = f->executor;

    api_run record = start_run(f);
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
    fixture *f = *state;

    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    for (int i = 0; i < 2; i++) {
        helper_executor_samples(f->executor, 0, 0, 5, 0.0);
        helper_executor_snapshot(f->executor, 0, 0);
        helper_executor_checkpoint(f->executor, 0, 5);
    }
    helper_executor_samples(f->executor, 0, 3, 4, 0.0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    assert_data(f->world, record.id, 7, 1);
}

static void a_gap_fails_the_run(void **state)
{
    fixture *f = *state;

    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 5, 0.0);
    helper_await_samples(f->world, record.id, 5);
    helper_executor_samples(f->executor, 0, 6, 1, 0.0);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ECORRUPT);
    assert_data(f->world, record.id, 5, 0);
}

static void late_frames_of_a_job_before_are_ignored(void **state)
{
    fixture *f = *state;
    helper_executor *e = f->executor;

    api_run record = start_run(f);
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
    assert_data(f->world, record.id, 6, 0);
    assert_true(helper_executor_job(e, 0).n_unread > 0);
}

static void bytes_that_come_one_by_one_make_the_same_run(void **state)
{
    fixture *f = *state;

    helper_executor_deliver_slowly(f->executor, 1);
    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 10, 0.0);
    helper_executor_checkpoint(f->executor, 0, 5);
    helper_executor_snapshot(f->executor, 0, 0);
    helper_executor_disconnect(f->executor, 0);
    helper_await_samples(f->world, record.id, 10);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    assert_data(f->world, record.id, 10, 1);
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
    fixture *f = *state;
    helper_executor *e = f->executor;

    api_run record = start_run(f);
    helper_executor_begin(e, 0);
    send_torn(e, 0, 3, false);
    helper_executor_lose(e, 0);
    helper_executor_await(e, 2);
    helper_executor_begin(e, 1);
    send_torn(e, 1, 3, false);
    helper_executor_end(e, 1, EXECUTOR_EXITED);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ECORRUPT);
}

static void a_damaged_frame_fails_the_run_and_stops_the_job(void **state)
{
    fixture *f = *state;

    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    send_torn(f->executor, 0, 0, true);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ECORRUPT);
    assert_int_equal(helper_executor_job(f->executor, 0).n_now, 1);
}

// ------------------------------------------------------------------------ starting and stopping

static void a_job_that_is_refused_for_now_is_started_later(void **state)
{
    fixture *f = *state;

    helper_executor_refuse(f->executor, 1, BF_EBUSY);
    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
}

// Until a run has begun the service is not ready.
static void a_job_that_the_system_refuses_is_started_later(void **state)
{
    fixture *f = *state;
    bf_error err = { 0 };

    helper_executor_refuse(f->executor, 1, BF_ESYSTEM);
    api_run record = start_run(f);
    assert_int_equal(supervisor_ready(f->world->supervisor, &err), BF_ESYSTEM);
    assert_string_equal(err.text, "there is no place for a job");
    helper_executor_begin(f->executor, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    assert_int_equal(supervisor_ready(f->world->supervisor, &err), BF_OK);
}

static void a_job_that_is_refused_for_good_fails_the_run(void **state)
{
    fixture *f = *state;

    helper_executor_refuse(f->executor, 1, BF_ELIMIT);
    helper_supervise(f->world);
    api_run record = helper_world_submit(f->world, belt);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ELIMIT);
}

static void a_job_that_answers_no_stop_is_given_up(void **state)
{
    fixture *f = *state;

    helper_executor_ignore_stops(f->executor);
    api_run record = start_run(f);
    helper_world_cancel(f->world, record.id);
    helper_await_state(f->world, record.id, RUN_CANCELLED);
    helper_job job = helper_executor_job(f->executor, 0);
    assert_int_equal(job.n_graceful, 1);
    assert_int_equal(job.n_now, 1);
    // One that is to be removed gets no time.
    record = helper_world_submit(f->world, belt);
    helper_executor_await(f->executor, 2);
    helper_world_kill(f->world, record.id);
    assert_int_equal(helper_executor_job(f->executor, 1).n_graceful, 0);
    // When the daemon stops, the run is not lost.
    record = helper_world_submit(f->world, belt);
    helper_executor_await(f->executor, 3);
    helper_world_stop(f->world, 50);
    assert_int_equal(store_find(f->world->store, record.id, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_QUEUED);
    assert_true(helper_executor_job(f->executor, 2).is_released);
}

static void a_stop_that_is_requested_twice_is_signalled_once(void **state)
{
    fixture *f = *state;

    f->world->options.stop_grace_ms = 60000;
    helper_executor_ignore_stops(f->executor);
    api_run record = start_run(f);
    for (int i = 0; i < 3; i++)
        helper_world_cancel(f->world, record.id);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 1, 0.0);
    helper_await_samples(f->world, record.id, 1);
    helper_executor_finish(f->executor, 0, true);
    helper_await_state(f->world, record.id, RUN_CANCELLED);
    assert_int_equal(helper_executor_job(f->executor, 0).n_graceful, 1);
}

// ------------------------------------------------------------------------ times

static void send_progress(helper_executor *e, uint64_t step)
{
    const frame f = { .type = FRAME_PROGRESS, .progress = { .step = step, .n_steps = 10 } };

    helper_executor_send(e, 0, &f);
    usleep(50000);
}

static api_run find_run(const fixture *f, const char *id)
{
    api_run record = { .state = RUN_QUEUED };

    assert_int_equal(store_find(f->world->store, id, &record, NULL), BF_OK);
    return record;
}

// Reports of the same step again and again are no progress; what is stored stays.
static void a_job_that_stands_still_fails_its_run(void **state)
{
    fixture *f = *state;

    f->world->options.stall_s = 1;
    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 5, 0.0);
    while (find_run(f, record.id).state == RUN_RUNNING)
        send_progress(f->executor, 1);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ELIMIT);
    assert_non_null(strstr(record.error.text, "stood still"));
    assert_int_equal(helper_executor_job(f->executor, 0).n_now, 1);
    assert_data(f->world, record.id, 5, 0);
}

static void a_job_that_sends_nothing_at_all_fails_its_run(void **state)
{
    fixture *f = *state;

    f->world->options.stall_s = 1;
    api_run record = helper_await_state(f->world, start_run(f).id, RUN_FAILED);
    assert_non_null(strstr(record.error.text, "stood still"));
}

// The store takes longer than a job may stand still.
static void a_job_that_waits_for_the_store_does_not_stand_still(void **state)
{
    fixture *f = *state;

    f->world->options.stall_s = 1;
    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 1, 0.0);
    helper_await_samples(f->world, record.id, 1);
    helper_world_slow_commits(f->world, 2500);
    helper_executor_samples(f->executor, 0, 1, 1, 0.0);
    helper_await_samples(f->world, record.id, 2);
    helper_world_slow_commits(f->world, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
}

static void a_run_that_takes_too_long_fails(void **state)
{
    fixture *f = *state;
    uint64_t step = 0;

    f->world->options.wall_s = 1;
    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    while (find_run(f, record.id).state == RUN_RUNNING)
        send_progress(f->executor, step < 9 ? ++step : step);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ELIMIT);
    assert_non_null(strstr(record.error.text, "limit of time"));
}

// The attempts before have used the time up.
static void all_attempts_together_must_not_take_too_long(void **state)
{
    fixture *f = *state;
    store_job job = { .step = 0 };
    api_run record = helper_world_submit(f->world, belt);
    store_batch batch = { .run_id = record.id, .wall_s = 3601 };
    store_ending ending = { .run_id = record.id, .state = RUN_QUEUED };

    assert_int_equal(store_claim(f->world->store, &job, NULL), BF_OK);
    store_job_fini(&job);
    assert_int_equal(helper_store_append(f->world->store, &batch, NULL), BF_OK);
    assert_int_equal(store_finish(f->world->store, &ending, &record, NULL), BF_OK);
    f->world->options.wall_s = 3600;
    helper_supervise(f->world);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_non_null(strstr(record.error.text, "limit of time"));
}

// ------------------------------------------------------------------------ restarts

// A run that the daemon before left running, with its job's name in the store.
static api_run leave_running(fixture *f, const char *external_id)
{
    store_job job = { .step = 0 };

    api_run record = helper_world_submit(f->world, belt);
    assert_int_equal(store_claim(f->world->store, &job, NULL), BF_OK);
    store_job_fini(&job);
    assert_int_equal(store_set_external_id(f->world->store, record.id, external_id, NULL), BF_OK);
    return record;
}

static void a_job_that_goes_on_is_taken_over(void **state)
{
    fixture *f = *state;
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
    assert_data(f->world, record.id, 4, 0);
    api_run next = helper_world_submit(f->world, belt);
    helper_executor_await(e, 3);
    assert_string_equal(helper_executor_job(e, 2).run_id, next.id);
}

static void a_run_whose_job_is_gone_is_queued_again(void **state)
{
    fixture *f = *state;

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
    assert_data(f->world, record.id, 4, 0);
}

// The daemon ended after it had accepted the request and before the run had stopped.
static void a_stop_request_outlives_the_daemon(void **state)
{
    fixture *f = *state;

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
    api_run next = helper_world_submit(f->world, belt);
    helper_executor_await(f->executor, 2);
    assert_string_equal(helper_executor_job(f->executor, 1).run_id, next.id);
}

// ------------------------------------------------------------------------ slow commits

static void await_stop_now(helper_executor *e, size_t index, int64_t deadline_ms)
{
    while (helper_executor_job(e, index).n_now == 0 && clock_monotonic_ms() < deadline_ms)
        usleep(1000);
}

// The deadline of an unresponsive job passes while the batch of another run is being committed.
static void a_stop_is_enforced_while_a_commit_is_slow(void **state)
{
    enum { GRACE_MS = 300, COMMIT_MS = 2000 };
    fixture *f = *state;
    helper_executor *e = f->executor;

    f->world->options.n_workers = 2;
    f->world->options.stop_grace_ms = GRACE_MS;
    helper_executor_ignore_stops(e);
    api_run first = start_run(f), second = helper_world_submit(f->world, belt);
    helper_executor_await(e, 2);
    helper_await_state(f->world, second.id, RUN_RUNNING);
    helper_executor_begin(e, 0);
    helper_executor_samples(e, 0, 0, 1, 0.0);
    helper_await_samples(f->world, first.id, 1);
    helper_world_cancel(f->world, second.id);
    int64_t begin_ms = clock_monotonic_ms();
    helper_world_slow_commits(f->world, COMMIT_MS);
    helper_executor_samples(e, 0, 1, 1, 0.0);
    await_stop_now(e, 1, begin_ms + COMMIT_MS);
    assert_true(clock_monotonic_ms() - begin_ms < COMMIT_MS / 2);
    helper_world_slow_commits(f->world, 0);
    helper_await_samples(f->world, first.id, 2);
}

// Batches of four runs that come while the store is busy are committed together.
static void batches_of_several_runs_share_a_commit(void **state)
{
    enum { N = 4, COMMIT_MS = 300 };
    fixture *f = *state;
    api_run records[N];

    f->world->options.n_workers = N;
    helper_supervise(f->world);
    for (size_t i = 0; i < N; i++)
        records[i] = helper_world_submit(f->world, belt);
    helper_executor_await(f->executor, N);
    for (size_t i = 0; i < N; i++) {
        helper_executor_begin(f->executor, i);
        helper_executor_samples(f->executor, i, 0, 1, 0.0);
    }
    for (size_t i = 0; i < N; i++)
        helper_await_samples(f->world, records[i].id, 1);
    helper_world_slow_commits(f->world, COMMIT_MS);
    double n_commits = helper_read_metric("\nbeltflow_store_commit_operations_count ");
    for (size_t i = 0; i < N; i++)
        helper_executor_samples(f->executor, i, 1, 1, 0.0);
    for (size_t i = 0; i < N; i++)
        helper_await_samples(f->world, records[i].id, 2);
    helper_world_slow_commits(f->world, 0);
    // The first may go alone; all that come while it is committed are one group.
    assert_true(helper_read_metric("\nbeltflow_store_commit_operations_count ") - n_commits <= 2);
}

// A job that sends much more than the store takes is not read ahead of it.
static void a_job_is_not_read_while_its_batch_is_stored(void **state)
{
    enum { N = 4000, FRAMES = 60 }; // a frame of 4000 samples has 96 kB
    fixture *f = *state;

    api_run record = start_run(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 1, 0.0);
    helper_await_samples(f->world, record.id, 1);
    helper_world_slow_commits(f->world, 500);
    for (uint64_t i = 0; i < FRAMES; i++)
        helper_executor_samples(f->executor, 0, 1 + i * N, N, 0.0);
    usleep(250000);
    // One batch is being stored, of 1 MB or so; what is left of 5.8 MB waits with the executor.
    assert_true(helper_executor_job(f->executor, 0).n_unread > 3000000);
    helper_world_slow_commits(f->world, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    assert_data(f->world, record.id, 1 + FRAMES * N, 0);
}

int main(void)
{
#define TEST(function) cmocka_unit_test_setup_teardown(function, setup, teardown)
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
        TEST(a_job_that_stands_still_fails_its_run),
        TEST(a_job_that_sends_nothing_at_all_fails_its_run),
        TEST(a_job_that_waits_for_the_store_does_not_stand_still),
        TEST(a_run_that_takes_too_long_fails),
        TEST(all_attempts_together_must_not_take_too_long),
        TEST(a_job_that_goes_on_is_taken_over),
        TEST(a_run_whose_job_is_gone_is_queued_again),
        TEST(a_stop_request_outlives_the_daemon),
        TEST(a_stop_is_enforced_while_a_commit_is_slow),
        TEST(batches_of_several_runs_share_a_commit),
        TEST(a_job_is_not_read_while_its_batch_is_stored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
