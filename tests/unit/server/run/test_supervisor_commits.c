// Tests of the supervisor while the commits of its store are slow.

#include "server/base/clock.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_jobs.h"

#include <unistd.h>

// Not by HELPER_AWAIT(): whoever asks holds the lock that the end of the test needs.
static bool await_stop_now(helper_executor *e, size_t index)
{
    const int64_t until_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;

    while (helper_executor_job(e, index).n_now == 0 && clock_monotonic_ms() < until_ms)
        usleep(1000);
    return helper_executor_job(e, index).n_now > 0;
}

// The deadline of an unresponsive job passes while the batch of another run is being committed: the listener of commits
// waits for the lock.
static void a_stop_is_enforced_while_a_commit_is_slow(void **state)
{
    helper_jobs *f = *state;
    helper_executor *e = f->executor;

    f->world->options.n_workers = 2;
    f->world->options.stop_grace_ms = 300;
    helper_executor_ignore_stops(e);
    api_run first = helper_jobs_start(f), second = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_await(e, 2);
    helper_await_state(f->world, second.id, RUN_RUNNING);
    helper_executor_begin(e, 0);
    helper_executor_samples(e, 0, 0, 1, 0.0);
    helper_await_samples(f->world, first.id, 1);
    helper_world_cancel(f->world, second.id);
    lock_acquire(&f->world->lock);
    helper_executor_samples(e, 0, 1, 1, 0.0);
    const bool is_stopped = await_stop_now(e, 1);
    lock_release(&f->world->lock);
    assert_true(is_stopped);
    helper_await_samples(f->world, first.id, 2);
}

// Batches of four runs that come while the store is busy are committed together.
static void batches_of_several_runs_share_a_commit(void **state)
{
    enum { N = 4, COMMIT_MS = 300 };
    helper_jobs *f = *state;
    api_run records[N];

    f->world->options.n_workers = N;
    helper_supervise(f->world);
    for (size_t i = 0; i < N; i++)
        records[i] = helper_world_submit(f->world, helper_jobs_belt);
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
    helper_jobs *f = *state;

    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 1, 0.0);
    helper_await_samples(f->world, record.id, 1);
    // The listener of commits waits for this lock, and the supervisor for the listener.
    lock_acquire(&f->world->lock);
    for (uint64_t i = 0; i < FRAMES; i++)
        helper_executor_samples(f->executor, 0, 1 + i * N, N, 0.0);
    usleep(250000); // in which it could read more
    // One batch is being stored, of 1 MB or so; what is left of 5.8 MB waits with the executor.
    const size_t n_unread = helper_executor_job(f->executor, 0).n_unread;
    lock_release(&f->world->lock);
    assert_true(n_unread > 3000000);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, record.id, 1 + FRAMES * N, 0);
}

// What comes with the last frame is stored with the end of the run, when its job has ended, and the next run is claimed in
// the same commit.
static void an_end_is_one_commit_with_the_last_samples_and_the_next_claim(void **state)
{
    static const double t = 0.01, values[] = { 1.0, 0.5 };
    const frame sample = { .type = FRAME_CURVE,
                           .curve = {
                               .first = 1, .n = 1, .n_columns = 2, .t = &t, .values = values } };
    const frame end = { .type = FRAME_END, .end = { .n_steps = 10 } };
    helper_jobs *f = *state;
    helper_executor *e = f->executor;
    bf_buffer bytes = { 0 };

    helper_executor_base(e)->outlives_daemon = false; // there is no id to be stored
    f->world->options.stop_grace_ms = 5000;
    api_run first = helper_jobs_start(f), second = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_begin(e, 0);
    helper_executor_samples(e, 0, 0, 1, 0.0);
    helper_await_samples(f->world, first.id, 1);
    double n_commits = helper_read_metric("\nbeltflow_store_commit_operations_count ");
    helper_encode(&sample, &bytes);
    helper_encode(&end, &bytes);
    helper_executor_send_bytes(e, 0, bytes.bytes, bytes.n);
    while (helper_executor_job(e, 0).n_unread > 0)
        usleep(1000);
    helper_executor_end(e, 0, API_JOB_EXITED);
    helper_executor_await(e, 2);
    assert_true(helper_read_metric("\nbeltflow_store_commit_operations_count ") == n_commits + 1);
    assert_string_equal(helper_executor_job(e, 1).run_id, second.id);
    helper_await_state(f->world, first.id, RUN_SUCCEEDED);
    helper_jobs_assert_data(f->world, first.id, 2, 0);
    buffer_fini(&bytes);
}

int main(void)
{
#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_jobs_setup, helper_jobs_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_stop_is_enforced_while_a_commit_is_slow),
        TEST(batches_of_several_runs_share_a_commit),
        TEST(a_job_is_not_read_while_its_batch_is_stored),
        TEST(an_end_is_one_commit_with_the_last_samples_and_the_next_claim),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
