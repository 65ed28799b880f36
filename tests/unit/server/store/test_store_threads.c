// Unit tests of the store: several threads, and whom it tells. I1 ... I12 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "server/base/lock.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N_WRITERS = 4, N_READERS = 12, N_RUNS = 12 };

/// What the threads of a test share.
typedef struct shared {
    store *store;
    atomic_int n_open; ///< writers that are not done
    atomic_int n_ended;
} shared;

static void solve_one(shared *sh)
{
    api_run record = helper_claim(sh->store);

    helper_append_samples(sh->store, record.id, 0, 5);
    helper_append_samples(sh->store, record.id, 5, 5);
    helper_finish(sh->store, record.id, RUN_SUCCEEDED);
    atomic_fetch_add(&sh->n_ended, 1);
}

static void *write_runs(void *context)
{
    shared *sh = context;

    for (int i = 0; i < N_RUNS; i++) {
        helper_submit(sh->store, "threads", i % 3);
        solve_one(sh);
    }
    atomic_fetch_sub(&sh->n_open, 1);
    return NULL;
}

// What is read belongs together: the curve is as long as the run says, or longer by now.
static void read_one(shared *sh, const api_run *record)
{
    api_curve curve = { 0 };

    assert_int_equal(store_read_curve(sh->store, record->id, 0, &curve, NULL), BF_OK);
    assert_true(curve.n >= record->n_samples);
    assert_true(helper_curve_is(&curve, 0, curve.n));
    api_curve_fini(&curve);
    helper_events events = helper_read_events(sh->store, record->id, 0);
    assert_true(events.id >= record->last_event);
    buffer_fini(&events.data);
}

static void *read_runs(void *context)
{
    shared *sh = context;
    api_list_query query = { .state = -1, .model = -1, .limit = 5 };
    api_run_list *list = calloc(1, sizeof *list);

    if (list == NULL)
        return NULL;
    while (atomic_load(&sh->n_open) > 0) {
        assert_int_equal(store_list(sh->store, &query, list, NULL), BF_OK);
        for (size_t i = 0; i < list->n; i++)
            read_one(sh, &list->runs[i]);
        assert_int_equal(store_ready(sh->store, NULL), BF_OK);
    }
    free(list);
    return NULL;
}

// More readers than connections, so that some have to wait for one.
static void threads_write_while_others_read(void **state)
{
    shared sh = { .store = ((helper_store *)*state)->store };
    pthread_t writers[N_WRITERS], readers[N_READERS];

    atomic_init(&sh.n_open, N_WRITERS);
    for (int i = 0; i < N_WRITERS; i++)
        assert_int_equal(pthread_create(&writers[i], NULL, write_runs, &sh), 0);
    for (int i = 0; i < N_READERS; i++)
        assert_int_equal(pthread_create(&readers[i], NULL, read_runs, &sh), 0);
    for (int i = 0; i < N_WRITERS; i++)
        assert_int_equal(pthread_join(writers[i], NULL), 0);
    for (int i = 0; i < N_READERS; i++)
        assert_int_equal(pthread_join(readers[i], NULL), 0);
    assert_int_equal(atomic_load(&sh.n_ended), N_WRITERS * N_RUNS);
    assert_int_equal(
        helper_store_sql(*state, "SELECT count(*) FROM runs WHERE state = 2 AND n_samples = 10"),
        N_WRITERS * N_RUNS);
}

static void expect_heard(helper_heard *h, size_t n, const char *id)
{
    lock_take(&h->lock);
    assert_int_equal(h->n, n);
    assert_string_equal(h->id, id);
    lock_give(&h->lock);
}

static void the_listener_hears_of_each_change_and_of_nothing_else(void **state)
{
    helper_store *h = *state;
    helper_heard ear = { 0 };
    store_options options = { .directory = h->directory,
                              .queue_limit = 9,
                              .listener = helper_hear,
                              .listener_context = &ear };
    store_ending ending = { .state = RUN_SUCCEEDED };
    api_run record;

    lock_init(&ear.lock);
    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    api_run first = helper_submit(h->store, "", 0);
    expect_heard(&ear, 1, first.id);
    helper_claim(h->store);
    expect_heard(&ear, 2, first.id);
    api_run second = helper_submit(h->store, "", 0);
    expect_heard(&ear, 3, second.id);
    helper_append_samples(h->store, first.id, 0, 1);
    expect_heard(&ear, 4, first.id);
    // Refused, left as it was, and read: nothing to be told.
    ending.run_id = second.id;
    assert_int_equal(store_finish(h->store, &ending, &record, NULL), BF_ECONFLICT);
    assert_int_equal(store_cancel(h->store, first.id, API_ANY_REVISION, &record, NULL), BF_OK);
    assert_int_equal(store_ready(h->store, NULL), BF_OK);
    helper_find(h->store, first.id);
    expect_heard(&ear, 4, first.id);
    assert_int_equal(store_cancel(h->store, second.id, API_ANY_REVISION, &record, NULL), BF_OK);
    expect_heard(&ear, 5, second.id);
    assert_int_equal(store_remove(h->store, second.id, API_ANY_REVISION, NULL), BF_OK);
    expect_heard(&ear, 6, second.id);
    helper_store_close(h);
    lock_fini(&ear.lock);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(threads_write_while_others_read),
        STORE_TEST(the_listener_hears_of_each_change_and_of_nothing_else),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
