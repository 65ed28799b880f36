// Unit tests of the store: what it removes by itself. I1 ... I15 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "server/base/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { DAY_MS = 24 * 3600 * 1000 };

static void open_with(helper_store *h, store_retention limits, store_listener *listener,
                      void *listener_context)
{
    store_options options = { .directory = h->directory,
                              .queue_limit = 100,
                              .listener = listener,
                              .listener_context = listener_context,
                              .retention = limits,
                              .retention_interval_ms = 10 };
    bf_error err = { 0 };

    if (h->store != NULL)
        helper_store_close(h);
    if (store_open(&options, &h->store, &err) != BF_OK)
        fail_msg("%s", err.text);
}

// A run that has ended so, with a snapshot of half a megabyte.
static api_run add_ended(store *s, run_state state)
{
    api_run record = helper_start(s);

    helper_append_snapshot(s, record.id, 0);
    record = helper_finish(s, record.id, state);
    // The next one ends in a later millisecond.
    while (clock_unix_ms() == record.finished_ms)
        nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
    return record;
}

static int64_t used_bytes(const helper_store *h)
{
    return (helper_store_sql(h, "PRAGMA page_count") -
            helper_store_sql(h, "PRAGMA freelist_count")) *
           helper_store_sql(h, "PRAGMA page_size");
}

static bool is_there(store *s, const api_run *record)
{
    api_run found;

    return store_find(s, record->id, &found, NULL) == BF_OK;
}

static void nothing_is_removed_unless_it_is_asked_for(void **state)
{
    helper_store *h = *state;
    api_run record = add_ended(h->store, RUN_FAILED);

    helper_store_close(h);
    helper_store_sql(h, "UPDATE runs SET finished_ms = 1");
    open_with(h, (store_retention){ 0 }, NULL, NULL);
    nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
    assert_true(is_there(h->store, &record));
}

// I12: of three that have ended the two that ended last stay, whatever their end and their age.
static void beyond_the_number_the_first_to_end_goes(void **state)
{
    helper_store *h = *state;
    api_run late = helper_start(h->store); // accepted first, ends last
    api_run first = add_ended(h->store, RUN_SUCCEEDED);
    api_run second = add_ended(h->store, RUN_CANCELLED);

    helper_finish(h->store, late.id, RUN_FAILED);
    open_with(h, (store_retention){ .n_runs = 2 }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM runs", 2);
    assert_false(is_there(h->store, &first));
    assert_true(is_there(h->store, &second));
    assert_true(is_there(h->store, &late));
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM results"), 2);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM snapshots"), 1);
}

// A run of an owner that has ended, in a millisecond of its own; cached ones are of a scenario that is known. A snapshot has
// half a megabyte.
static api_run add_of(store *s, const char *owner, bool is_fresh, size_t n_snapshots)
{
    api_submission submission = { .model = RUN_MACRO, .is_fresh = is_fresh };

    assert_int_equal(buffer_printf(&submission.scenario, "{}"), BF_OK);
    assert_int_equal(buffer_printf(&submission.columns, "upstream,left_domain"), BF_OK);
    assert_int_equal(buffer_printf(&submission.identity, "a"), BF_OK);
    snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owner);
    api_run record = helper_accept(s, &submission);
    if (record.state == RUN_QUEUED) {
        (void)helper_claim(s);
        for (size_t k = 0; k < n_snapshots; k++)
            helper_append_snapshot(s, record.id, k);
        const store_ending ending = { .run_id = record.id, .state = RUN_SUCCEEDED };
        assert_int_equal(store_finish(s, &ending, &record, NULL), BF_OK);
    }
    buffer_fini(&submission.scenario);
    buffer_fini(&submission.columns);
    buffer_fini(&submission.identity);
    while (clock_unix_ms() == record.finished_ms)
        nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
    return record;
}

// I12: one owner's cached answers, however many, cost another nothing, and go before his own results.
static void the_owner_who_has_most_makes_room(void **state)
{
    helper_store *h = *state;
    const api_run of_bob = add_of(h->store, "bob", true, 0);
    const api_run solved = add_of(h->store, "alice", true, 0);
    api_run cached[20];

    for (size_t k = 0; k < 20; k++) {
        cached[k] = add_of(h->store, "alice", false, 0);
        assert_true(cached[k].is_cached);
    }
    open_with(h, (store_retention){ .n_runs = 4 }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM runs", 4);
    assert_true(is_there(h->store, &of_bob));
    assert_true(is_there(h->store, &solved));
    assert_true(is_there(h->store, &cached[19]));
    assert_true(is_there(h->store, &cached[18]));
    open_with(h, (store_retention){ .n_bytes = 1 }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM runs", 0);
}

// I12: bytes are made room for by the owner who has most of them, though another has more runs, and older ones.
static void the_owner_who_has_most_bytes_makes_room_for_bytes(void **state)
{
    enum { N_SMALL = 6, N_LARGE = 4, N_KEPT = 2 };
    helper_store *h = *state;
    api_run small[N_SMALL], large[N_LARGE];

    for (size_t k = 0; k < N_SMALL; k++)
        small[k] = add_of(h->store, "bob", true, 0);
    const int64_t n_before = used_bytes(h);
    for (size_t k = 0; k < N_LARGE; k++)
        large[k] = add_of(h->store, "alice", true, 1);
    const int64_t n_large = (used_bytes(h) - n_before) / N_LARGE;
    const uint64_t limit = (uint64_t)(n_before + n_large * N_KEPT + n_large / 2);
    open_with(h, (store_retention){ .n_bytes = limit }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM runs", N_SMALL + N_KEPT);
    for (size_t k = 0; k < N_SMALL; k++)
        assert_true(is_there(h->store, &small[k]));
    for (size_t k = 0; k < N_LARGE; k++)
        assert_int_equal(is_there(h->store, &large[k]), k >= N_LARGE - N_KEPT);
}

// I12: what waits or runs stays, however old, and does not count.
static void work_is_never_removed(void **state)
{
    helper_store *h = *state;
    store_retention least = { .age_ms = 1, .n_runs = 1, .n_bytes = 1 };

    helper_submit(h->store, "waits", -1);
    helper_submit(h->store, "runs", 0);
    helper_store_close(h);
    helper_store_sql(h, "UPDATE runs SET created_ms = 1, started_ms = 1");
    open_with(h, least, NULL, NULL);
    api_run running = helper_claim(h->store);
    helper_append_snapshot(h->store, running.id, 0);
    api_run ended = add_ended(h->store, RUN_SUCCEEDED);
    helper_await_sql(h, "SELECT count(*) FROM runs WHERE state >= 2", 0);
    assert_false(is_there(h->store, &ended));
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 2);
    helper_append_snapshot(h->store, running.id, 1);
    assert_int_equal(helper_find(h->store, running.id).n_snapshots, 2);
}

static void what_ended_too_long_ago_goes(void **state)
{
    helper_store *h = *state;
    api_run old = add_ended(h->store, RUN_SUCCEEDED);
    api_run young = add_ended(h->store, RUN_SUCCEEDED);
    char sql[200];

    helper_store_close(h);
    snprintf(sql, sizeof sql, "UPDATE runs SET finished_ms = finished_ms - %d WHERE id = '%s'",
             DAY_MS + 60000, old.id);
    helper_store_sql(h, sql);
    snprintf(sql, sizeof sql, "UPDATE runs SET finished_ms = finished_ms - %d WHERE id = '%s'",
             DAY_MS - 60000, young.id);
    helper_store_sql(h, sql);
    open_with(h, (store_retention){ .age_ms = DAY_MS }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM runs", 1);
    assert_true(is_there(h->store, &young));
}

// The pages in use come below the limit, and with new runs coming the file does not grow any more.
static void the_limit_of_bytes_is_reached_and_stays(void **state)
{
    enum { N_RUNS = 12, N_KEPT = 5 };
    helper_store *h = *state;
    int64_t n_empty = used_bytes(h);

    for (int i = 0; i < N_RUNS; i++)
        add_ended(h->store, RUN_SUCCEEDED);
    int64_t limit = n_empty + (used_bytes(h) - n_empty) * (2 * N_KEPT + 1) / (2 * N_RUNS);
    open_with(h, (store_retention){ .n_bytes = (uint64_t)limit }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM runs", N_KEPT);
    assert_true(used_bytes(h) <= limit);
    int64_t n_pages = helper_store_sql(h, "PRAGMA page_count");
    for (int i = 0; i < 3 * N_RUNS; i++) {
        add_ended(h->store, RUN_SUCCEEDED);
        helper_await_sql(h, "SELECT count(*) FROM runs", N_KEPT);
    }
    assert_int_equal(helper_store_sql(h, "PRAGMA page_count"), n_pages);
}

// Runs with results in common free little, so all that is needed to free them goes.
static void the_limit_of_bytes_is_reached_where_runs_have_results_in_common(void **state)
{
    helper_store *h = *state;

    api_run first = add_ended(h->store, RUN_SUCCEEDED);
    api_run last = add_ended(h->store, RUN_SUCCEEDED);
    helper_store_close(h);
    helper_store_sql(h, "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number "
                        "WHERE i < 20) INSERT INTO runs (id, state, model, priority, label, name, "
                        "created_ms, finished_ms, results) SELECT printf('%036d', i), 2, 0, 0, '', "
                        "'', i, i, 1 FROM number");
    open_with(h, (store_retention){ .n_bytes = 800000 }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM runs", 1);
    assert_false(is_there(h->store, &first));
    assert_true(is_there(h->store, &last));
    assert_true(used_bytes(h) <= 800000);
}

static void limits_may_change_while_the_store_is_open(void **state)
{
    helper_store *h = *state;

    for (int i = 0; i < 3; i++)
        add_ended(h->store, RUN_SUCCEEDED);
    store_set_retention(h->store, &(store_retention){ .n_runs = 1 });
    helper_await_sql(h, "SELECT count(*) FROM runs", 1);
}

// Streams of a run that is removed have to end.
static void the_listener_hears_of_what_is_removed(void **state)
{
    helper_store *h = *state;
    helper_heard ear = { .n = 0 };
    api_run record = add_ended(h->store, RUN_SUCCEEDED);

    lock_init(&ear.lock);
    open_with(h, (store_retention){ .n_bytes = 1 }, helper_hear, &ear);
    helper_await_sql(h, "SELECT count(*) FROM runs", 0);
    helper_store_close(h);
    assert_int_equal(ear.n, 1);
    assert_string_equal(ear.id, record.id);
    lock_fini(&ear.lock);
}

static void answers_that_are_too_old_go_without_being_asked_for(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    helper_store_sql(h, "INSERT INTO answers (route, key, digest, id, revision, at_ms, data) "
                        "VALUES ('', '', x'00', '', 1, 1, '')");
    open_with(h, (store_retention){ 0 }, NULL, NULL);
    helper_await_sql(h, "SELECT count(*) FROM answers", 0);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(nothing_is_removed_unless_it_is_asked_for),
        STORE_TEST(beyond_the_number_the_first_to_end_goes),
        STORE_TEST(the_owner_who_has_most_makes_room),
        STORE_TEST(the_owner_who_has_most_bytes_makes_room_for_bytes),
        STORE_TEST(work_is_never_removed),
        STORE_TEST(what_ended_too_long_ago_goes),
        STORE_TEST(the_limit_of_bytes_is_reached_and_stays),
        STORE_TEST(the_limit_of_bytes_is_reached_where_runs_have_results_in_common),
        STORE_TEST(limits_may_change_while_the_store_is_open),
        STORE_TEST(the_listener_hears_of_what_is_removed),
        STORE_TEST(answers_that_are_too_old_go_without_being_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
