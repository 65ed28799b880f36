// Unit tests of the store: several threads, and whom it notifies. I1 ... I15 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/lock.h"
#include "server/base/metrics.h"
#include "server/store/store_priv.h"
#include "tests/unit/server/helper_await.h"

#include <math.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { N_WRITERS = 4, N_READERS = 12, N_RUNS = 12 };

/// Data common to the threads of a test.
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

    assert_int_equal(store_read_curve(sh->store, record->id, 0, UINT64_MAX, &curve, NULL), BF_OK);
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
    lock_acquire(&h->lock);
    assert_int_equal(h->n, n);
    assert_string_equal(h->id, id);
    lock_release(&h->lock);
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
    // Refused, left as it was, and read: nothing to be notified.
    ending.run_id = second.id;
    assert_int_equal(store_finish(h->store, &ending, &record, NULL), BF_ECONFLICT);
    assert_int_equal(store_ready(h->store, NULL), BF_OK);
    helper_find(h->store, first.id);
    expect_heard(&ear, 4, first.id);
    assert_int_equal(store_cancel(h->store, second.id, API_ANY_REVISION, &record, NULL), BF_OK);
    expect_heard(&ear, 5, second.id);
    assert_int_equal(store_remove(h->store, second.id, API_ANY_REVISION, NULL), BF_OK);
    expect_heard(&ear, 6, second.id);
    // A stop request is for the supervisor, once.
    for (int i = 0; i < 2; i++)
        assert_int_equal(store_cancel(h->store, first.id, API_ANY_REVISION, &record, NULL), BF_OK);
    expect_heard(&ear, 7, first.id);
    helper_store_close(h);
    lock_fini(&ear.lock);
}

/// The outcomes of batches whose caller did not wait.
typedef struct outcome {
    lock lock;
    lock_condition changed;
    size_t n;         ///< answers
    bf_status last;   ///< of them
    bf_status failed; ///< the last that was not BF_OK
} outcome;

static void note_outcome(void *context, bf_status status, const bf_error *err)
{
    outcome *o = context;

    lock_acquire(&o->lock);
    o->n++;
    o->last = status;
    if (status != BF_OK) {
        o->failed = status;
        assert_int_equal(err->code, status);
    }
    lock_wake_all(&o->changed);
    lock_release(&o->lock);
}

static void await_outcomes(outcome *o, size_t n)
{
    lock_acquire(&o->lock);
    while (o->n < n)
        lock_wait(&o->changed, &o->lock, -1);
    lock_release(&o->lock);
}

static size_t count_outcomes(outcome *o)
{
    lock_acquire(&o->lock);
    size_t n = o->n;
    lock_release(&o->lock);
    return n;
}

static void begin_outcome(outcome *o)
{
    *o = (outcome){ .n = 0 };
    lock_init(&o->lock);
    lock_condition_init(&o->changed);
}

static void end_outcome(outcome *o)
{
    lock_condition_fini(&o->changed);
    lock_fini(&o->lock);
}

static store_batch batch_of(const char *id, store_item *item, const bf_grid *grid)
{
    return (store_batch){
        .run_id = id, .n = 1, .items = item, .progress = 0.5, .eta_s = NAN, .grid = grid
    };
}

static bool has_nothing_to_prepare(store *s)
{
    lock_acquire(&s->lock);
    const bool has_nothing = s->preparing.first == NULL;
    lock_release(&s->lock);
    return has_nothing;
}

// While another connection holds the file, what is begun gathers: the first batches may be waiting for the file already,
// the last one may still be in the hands of the thread that compresses, and all others are of one commit.
static void batches_of_several_runs_share_a_commit(void **state)
{
    enum { N = 8 };
    helper_store *h = *state;
    store_item items[N];
    store_batch batches[N];
    api_run records[N];
    bf_grid grid = helper_grid();
    sqlite3 *holder = NULL;
    char path[128];
    outcome o;

    begin_outcome(&o);
    for (int i = 0; i < N; i++) {
        records[i] = helper_start(h->store);
        helper_snapshot_item(records[i].id, 0, &items[i]);
        batches[i] = batch_of(records[i].id, &items[i], &grid);
    }
    double n_commits = helper_read_metric("\nbeltflow_store_commit_operations_count ");
    double n_operations = helper_read_metric("\nbeltflow_store_commit_operations_sum ");
    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    assert_int_equal(sqlite3_open(path, &holder), SQLITE_OK);
    assert_int_equal(sqlite3_exec(holder, "BEGIN IMMEDIATE", NULL, NULL, NULL), SQLITE_OK);
    for (int i = 0; i < N; i++)
        assert_int_equal(store_begin_append(h->store, &batches[i], note_outcome, &o, NULL), BF_OK);
    HELPER_AWAIT(has_nothing_to_prepare(h->store));
    assert_int_equal(count_outcomes(&o), 0);
    assert_int_equal(sqlite3_exec(holder, "COMMIT", NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(holder);
    await_outcomes(&o, N);
    assert_int_equal(o.failed, BF_OK);
    assert_true(helper_read_metric("\nbeltflow_store_commit_operations_sum ") - n_operations == N);
    assert_true(helper_read_metric("\nbeltflow_store_commit_operations_count ") - n_commits <= 3);
    for (int i = 0; i < N; i++) {
        assert_int_equal(helper_find(h->store, records[i].id).n_snapshots, 1);
        helper_item_fini(&items[i]);
    }
    end_outcome(&o);
}

// I4: what follows a gap is refused with it.
static void batches_without_a_waiting_caller_are_stored_in_their_order(void **state)
{
    enum { N = 50 };
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    store_item items[N];
    store_batch batches[N];
    outcome o;

    begin_outcome(&o);
    for (uint64_t i = 0; i < N; i++) {
        helper_curve_item(record.id, i < 40 ? i : i + 1, 1, &items[i]);
        batches[i] = batch_of(record.id, &items[i], NULL);
        assert_int_equal(store_begin_append(s, &batches[i], note_outcome, &o, NULL), BF_OK);
    }
    await_outcomes(&o, N);
    assert_int_equal(o.failed, BF_ECORRUPT);
    assert_int_equal(o.last, BF_ECORRUPT);
    assert_int_equal(helper_find(s, record.id).n_samples, 40);
    for (size_t i = 0; i < N; i++)
        helper_item_fini(&items[i]);
    end_outcome(&o);
}

static void without_memory_a_batch_is_refused_once(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    bf_grid grid = helper_grid();
    size_t n_faults = 1;
    store_item item;
    outcome o;

    begin_outcome(&o);
    helper_snapshot_item(record.id, 0, &item);
    store_batch batch = batch_of(record.id, &item, &grid);
    for (size_t n = 1; n_faults > 0; n++) {
        size_t n_before = count_outcomes(&o);
        memory_plan_fault(n, 0);
        bf_status status = store_begin_append(s, &batch, note_outcome, &o, NULL);
        if (status == BF_OK)
            await_outcomes(&o, n_before + 1);
        else
            assert_int_equal(count_outcomes(&o), n_before);
        n_faults = memory_faults();
        memory_plan_fault(0, 0);
        assert_int_equal(status == BF_OK ? o.last : status, n_faults > 0 ? BF_ENOMEM : BF_OK);
    }
    assert_int_equal(helper_find(s, record.id).n_snapshots, 1);
    helper_item_fini(&item);
    end_outcome(&o);
}

// A read, and what became of it.
typedef struct finding {
    store *store;
    const char *id;
    bf_status status;
} finding;

static void *find_run(void *context)
{
    finding *of = context;
    api_run found;

    of->status = store_find(of->store, of->id, &found, NULL);
    return NULL;
}

// Threads that serve clients must come back from a store whose readers hang.
static void a_read_waits_for_a_reader_for_a_limited_time(void **state)
{
    enum { N = 3 };
    store *s = ((helper_store *)*state)->store;
    store__connection *readers[STORE__READERS_MAX];
    api_run record = helper_submit(s, "busy", 0), found;
    pthread_t threads[N];
    finding findings[N];

    for (int i = 0; i < STORE__READERS_MAX; i++)
        readers[i] = store__acquire_reader(&s->pool);
    for (int i = 0; i < N; i++) {
        findings[i] = (finding){ .store = s, .id = record.id };
        assert_int_equal(pthread_create(&threads[i], NULL, find_run, &findings[i]), 0);
    }
    int64_t start_ms = clock_monotonic_ms();
    assert_int_equal(store_find(s, record.id, &found, NULL), BF_EBUSY);
    assert_true(clock_monotonic_ms() - start_ms >= STORE__READER_MS);
    for (int i = 0; i < N; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(findings[i].status, BF_EBUSY);
    }
    store__release_reader(&s->pool, readers[0]);
    assert_int_equal(store_find(s, record.id, &found, NULL), BF_OK);
    for (int i = 1; i < STORE__READERS_MAX; i++)
        store__release_reader(&s->pool, readers[i]);
}

static void a_reader_that_cannot_be_opened_is_opened_later(void **state)
{
    const helper_store *h = *state;
    api_run record = helper_submit(h->store, "", 0), found;
    store__connection *first = store__acquire_reader(&h->store->pool); // others take the next one
    char path[128], elsewhere[128];

    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    snprintf(elsewhere, sizeof elsewhere, "%s/elsewhere.db", h->directory);
    assert_int_equal(rename(path, elsewhere), 0);
    assert_int_equal(store_find(h->store, record.id, &found, NULL), BF_ESYSTEM);
    assert_int_equal(rename(elsewhere, path), 0);
    assert_int_equal(store_find(h->store, record.id, &found, NULL), BF_OK);
    assert_string_equal(found.id, record.id);
    store__release_reader(&h->store->pool, first);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(threads_write_while_others_read),
        STORE_TEST(the_listener_hears_of_each_change_and_of_nothing_else),
        STORE_TEST(batches_of_several_runs_share_a_commit),
        STORE_TEST(batches_without_a_waiting_caller_are_stored_in_their_order),
        STORE_TEST(a_read_waits_for_a_reader_for_a_limited_time),
        STORE_TEST(a_reader_that_cannot_be_opened_is_opened_later),
        STORE_TEST(without_memory_a_batch_is_refused_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
