// Unit tests of the store: what the supervisor stores of running runs, and what is asked of them. I1 ...
// I15 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include <stdio.h>
#include <string.h>

enum { SIZE = 4 };

static size_t list(store *s, store_running *runs)
{
    size_t n = 0;

    assert_int_equal(store_list_running(s, SIZE, runs, &n, NULL), BF_OK);
    return n;
}

static bool is_second(void *context, const store_running *running)
{
    return strcmp(running->id, (const char *)context) == 0 &&
           strcmp(running->external_id, "job 2") == 0;
}

static void reopen(helper_store *h, store_still_runs *still_runs, void *context)
{
    store_options options = { .directory = h->directory,
                              .queue_limit = 10,
                              .still_runs = still_runs,
                              .still_runs_context = context };

    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
}

static void running_runs_are_listed_the_oldest_first(void **state)
{
    store *s = ((helper_store *)*state)->store;
    store_running runs[SIZE];
    api_run first = helper_submit(s, "", 0), second = helper_submit(s, "", 0);

    assert_int_equal(list(s, runs), 0);
    helper_claim(s);
    helper_claim(s);
    assert_int_equal(list(s, runs), 2);
    assert_string_equal(runs[0].id, first.id);
    assert_string_equal(runs[1].id, second.id);
    assert_int_equal(runs[0].stop_request, STORE_STOP_NONE);
    assert_string_equal(runs[0].external_id, "");
    size_t n = 0;
    assert_int_equal(store_list_running(s, 1, runs, &n, NULL), BF_OK);
    assert_int_equal(n, 1);
}

// I14
static void an_external_id_is_stored_while_its_run_is_running(void **state)
{
    helper_store *h = *state;
    store_running runs[SIZE];
    char long_id[STORE_EXTERNAL_ID_SIZE + 1];
    api_run record = helper_start(h->store);

    assert_int_equal(store_set_external_id(h->store, record.id, "job 1", NULL), BF_OK);
    helper_append_samples(h->store, record.id, 0, 1);
    assert_int_equal(list(h->store, runs), 1);
    assert_string_equal(runs[0].external_id, "job 1");
    memset(long_id, 'x', sizeof long_id - 1);
    long_id[sizeof long_id - 1] = '\0';
    assert_int_equal(store_set_external_id(h->store, record.id, long_id, NULL), BF_ELIMIT);
    helper_finish(h->store, record.id, RUN_QUEUED);
    assert_int_equal(store_set_external_id(h->store, record.id, "job 2", NULL), BF_ECONFLICT);
    helper_claim(h->store);
    assert_int_equal(list(h->store, runs), 1);
    assert_string_equal(runs[0].external_id, "");
}

static store_stop requested(store *s)
{
    store_running runs[SIZE];

    assert_int_equal(list(s, runs), 1);
    return runs[0].stop_request;
}

// I14: the greater request wins, and its run is as it was: the supervisor stops it.
static void a_running_run_is_asked_to_stop(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store), answered = { .revision = 0 };

    assert_int_equal(store_cancel(h->store, record.id, API_ANY_REVISION, &answered, NULL), BF_OK);
    assert_int_equal(answered.state, RUN_RUNNING);
    assert_int_equal(answered.revision, record.revision);
    assert_int_equal(requested(h->store), STORE_STOP_CANCEL);
    assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_ECONFLICT);
    assert_int_equal(requested(h->store), STORE_STOP_KILL);
    assert_int_equal(store_cancel(h->store, record.id, API_ANY_REVISION, &answered, NULL), BF_OK);
    helper_append_samples(h->store, record.id, 0, 1);
    assert_int_equal(requested(h->store), STORE_STOP_KILL);
    helper_finish(h->store, record.id, RUN_CANCELLED);
    assert_int_equal(helper_store_sql(h, "SELECT sum(stop_request) FROM runs"), 0);
    assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
}

// I14: neither when its supervisor hands it back, nor by the next start.
static void a_run_that_is_asked_to_stop_is_not_queued_again(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store), answered;

    assert_int_equal(store_cancel(h->store, record.id, API_ANY_REVISION, &answered, NULL), BF_OK);
    assert_int_equal(helper_finish(h->store, record.id, RUN_QUEUED).state, RUN_CANCELLED);
    record = helper_start(h->store);
    assert_int_equal(store_cancel(h->store, record.id, API_ANY_REVISION, &answered, NULL), BF_OK);
    reopen(h, NULL, NULL);
    assert_int_equal(helper_find(h->store, record.id).state, RUN_CANCELLED);
    helper_events events = helper_read_events(h->store, record.id, 0);
    assert_int_equal(events.type, API_EVENT_END);
    buffer_fini(&events.data);
}

// A run may end before its stop request is heeded: as it ended, and the request goes with it (I14).
static void a_run_that_ends_by_itself_ends_as_it_did(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store), answered;

    assert_int_equal(store_cancel(h->store, record.id, API_ANY_REVISION, &answered, NULL), BF_OK);
    assert_int_equal(helper_finish(h->store, record.id, RUN_SUCCEEDED).state, RUN_SUCCEEDED);
    assert_int_equal(helper_store_sql(h, "SELECT sum(stop_request) FROM runs"), 0);
}

// I8
static void what_the_executor_still_has_stays_running(void **state)
{
    helper_store *h = *state;
    store_running runs[SIZE];
    api_run first = helper_submit(h->store, "", 0), second = helper_submit(h->store, "", 0);

    helper_claim(h->store);
    helper_claim(h->store);
    assert_int_equal(store_set_external_id(h->store, first.id, "job 1", NULL), BF_OK);
    assert_int_equal(store_set_external_id(h->store, second.id, "job 2", NULL), BF_OK);
    reopen(h, is_second, second.id);
    assert_int_equal(helper_find(h->store, first.id).state, RUN_QUEUED);
    assert_int_equal(helper_find(h->store, second.id).state, RUN_RUNNING);
    assert_int_equal(list(h->store, runs), 1);
    assert_string_equal(runs[0].external_id, "job 2");
    reopen(h, NULL, NULL);
    assert_int_equal(helper_find(h->store, second.id).state, RUN_QUEUED);
    assert_int_equal(list(h->store, runs), 0);
}

enum { ATTEMPTS = 3 };

// As if the daemon had been killed: what is running has no executor any more.
static api_run die(helper_store *h, const char *id)
{
    const store_options options = { .directory = h->directory,
                                    .queue_limit = 10,
                                    .attempts_max = ATTEMPTS };

    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    return helper_find(h->store, id);
}

static void expect_failure_at_last(helper_store *h, const char *id)
{
    for (int i = 1; i < ATTEMPTS; i++) {
        helper_claim(h->store);
        assert_int_equal(die(h, id).state, RUN_QUEUED);
    }
    helper_claim(h->store);
    const api_run record = die(h, id);
    assert_int_equal(record.state, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ELIMIT);
    assert_non_null(strstr(record.error.text, "ended during 3 attempts"));
    helper_events events = helper_read_events(h->store, id, 0);
    assert_int_equal(events.type, API_EVENT_END);
    buffer_fini(&events.data);
}

// I8
static void a_run_that_ends_the_daemon_each_time_fails(void **state)
{
    helper_store *h = *state;

    expect_failure_at_last(h, helper_submit(h->store, "", 0).id);
}

// Neither an attempt that brought something new, nor one that was handed back.
static void only_attempts_in_vain_count(void **state)
{
    helper_store *h = *state;
    const api_run record = helper_submit(h->store, "", 0);

    for (uint64_t i = 0; i < 2 * ATTEMPTS; i++) {
        helper_claim(h->store);
        helper_append_samples(h->store, record.id, i, 1);
        assert_int_equal(die(h, record.id).state, RUN_QUEUED);
    }
    for (int i = 0; i < 2 * ATTEMPTS; i++) {
        helper_claim(h->store);
        helper_finish(h->store, record.id, RUN_QUEUED);
    }
    expect_failure_at_last(h, record.id);
}

static api_run hand_back(helper_store *h, const char *id, store_attempt attempt)
{
    const store_ending ending = {
        .run_id = id, .state = RUN_QUEUED, .attempt = attempt, .error = { BF_ESYSTEM, "", "why" }
    };
    api_run after;

    helper_claim(h->store);
    assert_int_equal(store_finish(h->store, &ending, &after, NULL), BF_OK);
    return after;
}

// What was not the run's fault is none of its attempts, but cannot go on for ever.
static void hand_backs_have_a_limit_of_their_own(void **state)
{
    helper_store *h = *state;
    const api_run record = helper_submit(h->store, "", 0);

    (void)die(h, record.id);
    for (int i = 1; i < STORE_HAND_BACKS_MAX; i++)
        assert_int_equal(hand_back(h, record.id, STORE_ATTEMPT_HAND_BACK).state, RUN_QUEUED);
    const api_run failed = hand_back(h, record.id, STORE_ATTEMPT_HAND_BACK);
    assert_int_equal(failed.state, RUN_FAILED);
    assert_non_null(strstr(failed.error.text, "gave this run back 1000 times"));
}

static void attempts_that_failed_count_with_those_that_ended_the_daemon(void **state)
{
    helper_store *h = *state;
    const api_run record = helper_submit(h->store, "", 0);

    (void)die(h, record.id);
    assert_int_equal(hand_back(h, record.id, STORE_ATTEMPT_FAILED).state, RUN_QUEUED);
    helper_claim(h->store);
    assert_int_equal(die(h, record.id).state, RUN_QUEUED);
    assert_int_equal(hand_back(h, record.id, STORE_ATTEMPT_NONE).state, RUN_QUEUED);
    const api_run failed = hand_back(h, record.id, STORE_ATTEMPT_FAILED);
    assert_int_equal(failed.state, RUN_FAILED);
    assert_int_equal(failed.error.code, BF_ELIMIT);
}

static void a_run_that_is_to_be_stopped_is_cancelled_after_its_last_attempt(void **state)
{
    helper_store *h = *state;
    api_run record = helper_submit(h->store, "", 0);

    for (int i = 1; i < ATTEMPTS; i++) {
        helper_claim(h->store);
        die(h, record.id);
    }
    helper_claim(h->store);
    assert_int_equal(store_cancel(h->store, record.id, API_ANY_REVISION, &record, NULL), BF_OK);
    assert_int_equal(die(h, record.id).state, RUN_CANCELLED);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

// I14: each is counted once it is stored.
static void stop_requests_are_counted(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run running = helper_start(s), queued = helper_submit(s, "", 0), after;

    assert_int_equal(store_count_stop_requests(s), 0);
    assert_int_equal(store_cancel(s, queued.id, API_ANY_REVISION, &after, NULL), BF_OK);
    assert_int_equal(store_count_stop_requests(s), 0);
    assert_int_equal(store_cancel(s, running.id, API_ANY_REVISION, &after, NULL), BF_OK);
    assert_int_equal(store_cancel(s, running.id, API_ANY_REVISION, &after, NULL), BF_OK);
    assert_int_equal(store_count_stop_requests(s), 1);
    assert_int_equal(store_remove(s, running.id, API_ANY_REVISION, NULL), BF_ECONFLICT);
    assert_int_equal(store_count_stop_requests(s), 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(running_runs_are_listed_the_oldest_first),
        STORE_TEST(stop_requests_are_counted),
        STORE_TEST(an_external_id_is_stored_while_its_run_is_running),
        STORE_TEST(a_running_run_is_asked_to_stop),
        STORE_TEST(a_run_that_is_asked_to_stop_is_not_queued_again),
        STORE_TEST(a_run_that_ends_by_itself_ends_as_it_did),
        STORE_TEST(what_the_executor_still_has_stays_running),
        STORE_TEST(a_run_that_ends_the_daemon_each_time_fails),
        STORE_TEST(only_attempts_in_vain_count),
        STORE_TEST(hand_backs_have_a_limit_of_their_own),
        STORE_TEST(attempts_that_failed_count_with_those_that_ended_the_daemon),
        STORE_TEST(a_run_that_is_to_be_stopped_is_cancelled_after_its_last_attempt),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
