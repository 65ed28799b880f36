// Unit tests of the store: no memory, writes that fail. I1 ... I15 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "core/base/memory.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/// A call of the store with its outputs, and what must hold when it failed.
typedef bf_status attempt(store *s, const char *id, bf_error *err);

static bf_status try_submit(store *s, const char *id, bf_error *err)
{
    api_submission submission = { .model = RUN_MACRO };
    api_acceptance accepted = { .revision = 77 };

    bf_status status = store_submit(s, &submission, &accepted, err);
    assert_true(status == BF_OK || (accepted.revision == 77 && accepted.answer.bytes == NULL));
    buffer_fini(&accepted.answer);
    return status;
}

static bf_status try_claim(store *s, const char *id, bf_error *err)
{
    store_job job = { .step = 77 };

    bf_status status = store_claim(s, true, &job, err);
    if (status == BF_OK)
        store_job_fini(&job);
    else
        assert_true(job.step == 77 && job.scenario.bytes == NULL);
    return status;
}

// The items are made beforehand: only the store's own allocations are to fail.
static store_item prepared[3];

static bf_status try_append(store *s, const char *id, bf_error *err)
{
    bf_grid grid = helper_grid();
    store_batch batch = {
        .run_id = id,
        .n = 3,
        .items = prepared,
        .grid = &grid,
        .checkpoint = "checkpoint",
        .n_checkpoint = 10,
        .step = 5,
    };

    return helper_store_append(s, &batch, err);
}

static bf_status try_finish(store *s, const char *id, bf_error *err)
{
    store_ending ending = { .run_id = id, .state = RUN_SUCCEEDED, .summary = "{}", .n_summary = 2 };
    api_run record = { .priority = 77 };

    bf_status status = store_finish(s, &ending, &record, err);
    assert_true(status == BF_OK || record.priority == 77);
    return status;
}

static bf_status try_list(store *s, const char *id, bf_error *err)
{
    static api_run_list list;
    api_list_query query = { .state = -1, .model = -1, .limit = 10 };

    list.n = 77;
    bf_status status = store_list(s, &query, &list, err);
    assert_int_equal(list.n, status == BF_OK ? 2 : 77);
    return status;
}

static bf_status try_read_curve(store *s, const char *id, bf_error *err)
{
    api_curve curve = { .n = 77 };

    bf_status status = store_read_curve(s, id, 0, UINT64_MAX, &curve, err);
    assert_int_equal(curve.n, status == BF_OK ? 5 : 77);
    if (status == BF_OK)
        api_curve_fini(&curve);
    return status;
}

static bf_status try_list_snapshots(store *s, const char *id, bf_error *err)
{
    api_snapshot_list list = { .n = 77 };

    bf_status status = store_list_snapshots(s, id, &list, err);
    assert_int_equal(list.n, status == BF_OK ? 1 : 77);
    if (status == BF_OK)
        buffer_fini(&list.items);
    return status;
}

static bf_status try_read_snapshot(store *s, const char *id, bf_error *err)
{
    api_array got = { .snapshot = { .index = 77 }, .grid = { .n1 = 77 } };
    bf_buffer rho = { 0 };

    bf_status status = store_read_array(s, id, 0, API_ARRAY_DENSITY, &got, &rho, err);
    assert_int_equal(got.snapshot.index, status == BF_OK ? 0 : 77);
    assert_int_equal(rho.n, status == BF_OK ? HELPER_N1 * HELPER_N2 * 4 : 0);
    buffer_fini(&rho);
    return status;
}

static bf_status skip_event(void *context, const api_event *event, bf_error *err)
{
    return BF_OK;
}

static bf_status try_read_events(store *s, const char *id, bf_error *err)
{
    char ids[1][API_ID_SIZE];

    memcpy(ids[0], id, API_ID_SIZE);
    return store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, 0, SIZE_MAX, skip_event, NULL,
                             err);
}

// Let the n-th allocation fail, for n = 1, 2, ... until the call succeeds without a failure.
static size_t walk(attempt *call, store *s, const char *id)
{
    for (size_t n = 1;; n++) {
        bf_error err = { 0 };
        memory_plan_fault(n, 0);
        bf_status status = call(s, id, &err);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            return n - 1;
        }
        assert_int_equal(status, BF_ENOMEM);
        assert_int_equal(err.code, BF_ENOMEM);
    }
}

static void without_memory_every_call_fails_and_changes_nothing(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_submit(s, "", 1);

    helper_progress_item(record.id, 1, &prepared[0]);
    helper_curve_item(record.id, 0, 5, &prepared[1]);
    helper_snapshot_item(record.id, 0, &prepared[2]);
    assert_true(walk(try_submit, s, record.id) > 0);
    assert_true(walk(try_claim, s, record.id) > 0);
    assert_int_equal(helper_find(s, record.id).state, RUN_RUNNING);
    assert_true(walk(try_append, s, record.id) > 0);
    assert_true(walk(try_list, s, record.id) > 0);
    assert_true(walk(try_read_curve, s, record.id) > 0);
    assert_true(walk(try_list_snapshots, s, record.id) > 0);
    assert_true(walk(try_read_snapshot, s, record.id) > 0);
    assert_true(walk(try_read_events, s, record.id) > 0);
    assert_true(walk(try_finish, s, record.id) > 0);
    // Queued, running, progress, curve, snapshot, the last status, the end: each event once.
    helper_events events = helper_read_events(s, record.id, 0);
    assert_int_equal(events.n, 7);
    buffer_fini(&events.data);
    for (int i = 0; i < 3; i++)
        helper_item_fini(&prepared[i]);
}

static void without_memory_a_store_does_not_open(void **state)
{
    helper_store *h = *state;
    store_options options = { .directory = h->directory, .queue_limit = 10 };

    helper_start(h->store);
    helper_store_close(h);
    for (size_t n = 1;; n++) {
        memory_plan_fault(n, 0);
        bf_status status = store_open(&options, &h->store, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            break;
        }
        assert_int_equal(status, BF_ENOMEM);
        assert_null(h->store);
    }
}

static void limit_files(rlim_t bytes)
{
    struct rlimit limit;

    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static off_t size_of_log(const helper_store *h)
{
    char path[128];
    struct stat info;

    snprintf(path, sizeof path, "%s/beltflow.db-wal", h->directory);
    assert_int_equal(stat(path, &info), 0);
    return info.st_size;
}

// The log may not grow by the 480,000 bytes of a snapshot: that write fails, small ones go on, and
// when there is room again, so does the big one.
static void a_write_that_finds_no_room_fails_alone(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    store_item item;
    bf_error err = { 0 };

    signal(SIGXFSZ, SIG_IGN);
    // The failed writes leave a longer file behind, so the limit is not taken from it again.
    rlim_t limit = (rlim_t)size_of_log(h) + 200000;
    for (int i = 0; i < 3; i++) {
        helper_snapshot_item(record.id, 0, &item);
        limit_files(limit);
        bf_status status = helper_append(h->store, record.id, &item, &err);
        assert_int_equal(status, BF_ESYSTEM);
        assert_non_null(strstr(err.text, "disk I/O error"));
        helper_append_samples(h->store, record.id, (uint64_t)i, 1);
        limit_files(RLIM_INFINITY);
    }
    assert_int_equal(helper_find(h->store, record.id).n_snapshots, 0);
    helper_append_snapshot(h->store, record.id, 0);
    helper_store_close(h);
    helper_store_open(h);
    // I1: what was acknowledged in between is there.
    record = helper_find(h->store, record.id);
    assert_int_equal(record.n_samples, 3);
    assert_int_equal(record.n_snapshots, 1);
}

static void a_store_that_cannot_write_is_not_ready(void **state)
{
    helper_store *h = *state;
    bf_error err = { 0 };

    helper_submit(h->store, "", 0);
    signal(SIGXFSZ, SIG_IGN);
    limit_files((rlim_t)size_of_log(h));
    bf_status status = store_ready(h->store, &err);
    limit_files(RLIM_INFINITY);
    assert_int_equal(status, BF_ESYSTEM);
    assert_string_not_equal(err.text, "");
    helper_submit(h->store, "", 0);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(without_memory_every_call_fails_and_changes_nothing),
        STORE_TEST(without_memory_a_store_does_not_open),
        STORE_TEST(a_write_that_finds_no_room_fails_alone),
        STORE_TEST(a_store_that_cannot_write_is_not_ready),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
