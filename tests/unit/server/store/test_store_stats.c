// Unit tests of the store: its stats, and its signs of life.

#include "server/base/metrics.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include <pthread.h>
#include <semaphore.h>
#include <string.h>
#include <unistd.h>

// The stats once their runs of this state are n.
static store_stats await_stats(store *s, run_state state, uint64_t n)
{
    store_stats f;

    HELPER_AWAIT((store_read_stats(s, &f), f.n_runs[state] == n));
    return f;
}

static void stats_follow_what_is_written(void **state)
{
    store *s = ((helper_store *)*state)->store;
    store_stats f;

    store_read_stats(s, &f);
    for (int i = 0; i < RUN_STATE_COUNT; i++)
        assert_int_equal(f.n_runs[i], 0);
    assert_int_equal(f.oldest_queued_ms, 0);
    api_run first = helper_submit(s, "", 0);
    (void)helper_submit(s, "", 5);
    f = await_stats(s, RUN_QUEUED, 2);
    assert_int_equal(f.oldest_queued_ms, first.created_ms);
    assert_true(f.file_bytes > 0 && f.log_bytes > 0);
    api_run claimed = helper_claim(s);
    f = await_stats(s, RUN_RUNNING, 1);
    assert_int_equal(f.n_runs[RUN_QUEUED], 1);
    (void)helper_finish(s, claimed.id, RUN_FAILED);
    (void)await_stats(s, RUN_FAILED, 1);
    assert_int_equal(store_remove(s, claimed.id, API_ANY_REVISION, NULL), BF_OK);
    f = await_stats(s, RUN_FAILED, 0);
    assert_int_equal(f.n_runs[RUN_QUEUED], 1);
}

static void stats_are_there_as_soon_as_the_store_is_open(void **state)
{
    helper_store *h = *state;
    store_stats f;

    (void)helper_submit(h->store, "", 0);
    (void)helper_claim(h->store);
    (void)helper_submit(h->store, "", 0);
    helper_store_close(h);
    helper_store_open(h);
    store_read_stats(h->store, &f);
    assert_int_equal(f.n_runs[RUN_QUEUED], 2); // the one that was running waits again
    assert_true(f.oldest_queued_ms > 0);
}

static void commits_and_frames_are_counted(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run created = helper_start(s);
    int64_t n_curves = metrics_value(METRICS_FRAMES, API_EVENT_CURVE);
    int64_t n_snapshots = metrics_value(METRICS_FRAMES, API_EVENT_SNAPSHOT);

    helper_append_samples(s, created.id, 0, 10);
    helper_append_samples(s, created.id, 10, 10);
    helper_append_snapshot(s, created.id, 0);
    assert_int_equal(metrics_value(METRICS_FRAMES, API_EVENT_CURVE), n_curves + 2);
    assert_int_equal(metrics_value(METRICS_FRAMES, API_EVENT_SNAPSHOT), n_snapshots + 1);
    assert_int_equal(metrics_value(METRICS_COMMIT_FAILURES, 0), 0);
    bf_buffer text = { 0 };
    assert_int_equal(metrics_write(&text, NULL), BF_OK);
    assert_null(strstr(text.bytes, "\nbeltflow_store_commit_operations_count 0\n"));
    buffer_fini(&text);
}

static void the_queue_can_be_made_shorter_and_longer(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_submission submission = { .model = RUN_MACRO };
    api_acceptance accepted;

    (void)helper_submit(s, "", 0);
    store_set_queue_limit(s, 1);
    assert_int_equal(buffer_append(&submission.scenario, "{}", 2), BF_OK);
    assert_int_equal(buffer_append(&submission.columns, "left_domain", 11), BF_OK);
    assert_int_equal(store_submit(s, &submission, &accepted, NULL), BF_EBUSY);
    store_set_queue_limit(s, 2);
    assert_int_equal(store_submit(s, &submission, &accepted, NULL), BF_OK);
    buffer_fini(&accepted.answer);
    buffer_fini(&submission.scenario);
    buffer_fini(&submission.columns);
}

static void *submit_one(void *context)
{
    (void)helper_submit(context, "", 0);
    return NULL;
}

typedef struct gate {
    sem_t reached; // the store's thread is in the listener
    sem_t opened;  // it may go on
} gate;

static void pass_gate(void *context, const char *run_id)
{
    gate *g = context;

    assert_int_equal(sem_post(&g->reached), 0);
    assert_int_equal(sem_wait(&g->opened), 0);
}

static void open_with_gate(helper_store *h, gate *g)
{
    const store_options options = {
        .directory = h->directory, .queue_limit = 100, .listener = pass_gate, .listener_context = g
    };

    assert_int_equal(sem_init(&g->reached, 0, 0), 0);
    assert_int_equal(sem_init(&g->opened, 0, 0), 0);
    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
}

// A listener that does not return keeps the store's thread as a disk that hangs would.
static void a_store_that_hangs_gives_no_sign_of_life(void **state)
{
    helper_store *h = *state;
    pthread_t writer;
    gate g;

    open_with_gate(h, &g);
    assert_true(store_is_alive(h->store)); // was never asked before
    HELPER_AWAIT(store_is_alive(h->store));
    assert_int_equal(pthread_create(&writer, NULL, submit_one, h->store), 0);
    assert_int_equal(sem_wait(&g.reached), 0);
    assert_true(store_is_alive(h->store)); // what was asked before the operation is answered
    assert_false(store_is_alive(h->store));
    assert_int_equal(sem_post(&g.opened), 0);
    assert_int_equal(pthread_join(writer, NULL), 0);
    HELPER_AWAIT(store_is_alive(h->store));
    helper_store_close(h);
    assert_int_equal(sem_destroy(&g.reached), 0);
    assert_int_equal(sem_destroy(&g.opened), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(stats_follow_what_is_written, helper_store_setup,
                                        helper_store_teardown),
        cmocka_unit_test_setup_teardown(stats_are_there_as_soon_as_the_store_is_open,
                                        helper_store_setup, helper_store_teardown),
        cmocka_unit_test_setup_teardown(commits_and_frames_are_counted, helper_store_setup,
                                        helper_store_teardown),
        cmocka_unit_test_setup_teardown(the_queue_can_be_made_shorter_and_longer,
                                        helper_store_setup, helper_store_teardown),
        cmocka_unit_test_setup_teardown(a_store_that_hangs_gives_no_sign_of_life,
                                        helper_store_setup, helper_store_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
