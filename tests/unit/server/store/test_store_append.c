// Unit tests of the store: what a running run sends. I1 ... I15 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "api/results/events.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static void samples_come_back_bit_by_bit_from_any_index(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);

    // Batches of 1, 2, ... 9 samples: 45 in all.
    for (size_t n = 1, first = 0; n <= 9; first += n, n++)
        helper_append_samples(s, record.id, first, n);
    assert_int_equal(helper_find(s, record.id).n_samples, 45);
    for (uint64_t first = 0; first <= 46; first++) {
        api_curve curve = { 0 };
        assert_int_equal(store_read_curve(s, record.id, first, UINT64_MAX, &curve, NULL), BF_OK);
        assert_string_equal(curve.columns.bytes, "upstream,left_domain");
        assert_true(helper_curve_is(&curve, first, first < 45 ? 45 - first : 0));
        api_curve_fini(&curve);
    }
}

static void snapshots_come_back_bit_by_bit(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    api_snapshot_list list = { 0 };

    for (uint64_t i = 0; i < 3; i++)
        helper_append_snapshot(h->store, record.id, i);
    assert_int_equal(helper_find(h->store, record.id).n_snapshots, 3);
    // Noise does not compress: 480,000 bytes make four slices of 128 KiB at most.
    assert_int_equal(helper_store_sql(h, "SELECT max(part) FROM chunks"), 3);
    assert_true(helper_store_sql(h, "SELECT max(length(data)) FROM chunks") <= 256 * 1024);
    assert_int_equal(store_list_snapshots(h->store, record.id, &list, NULL), BF_OK);
    assert_int_equal(list.n, 3);
    assert_int_equal(list.grid.n1, HELPER_N1);
    const api_snapshot *items = (const api_snapshot *)(const void *)list.items.bytes;
    for (uint64_t i = 0; i < 3; i++) {
        api_array got = { 0 };
        bf_buffer rho = { 0 };
        assert_int_equal(items[i].index, i);
        assert_true(items[i].t == 0.1 * (double)i && items[i].peak == 1.25);
        assert_int_equal(
            store_read_array(h->store, record.id, i, API_ARRAY_DENSITY, &got, &rho, NULL), BF_OK);
        assert_true(helper_snapshot_is(&rho, i));
        assert_int_equal(got.grid.n2, HELPER_N2);
        assert_true(got.snapshot.mass == 192.0);
        buffer_fini(&rho);
    }
    buffer_fini(&list.items);
}

// 40 snapshots are 19 MB; the log is copied into the database every 1000 pages of 4096 bytes.
static void the_log_stays_small_while_much_is_written(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    char path[128];
    struct stat info;

    for (uint64_t i = 0; i < 40; i++) {
        helper_append_snapshot(h->store, record.id, i);
        // Someone reads in between.
        helper_find(h->store, record.id);
    }
    snprintf(path, sizeof path, "%s/beltflow.db-wal", h->directory);
    assert_int_equal(stat(path, &info), 0);
    assert_true(info.st_size < 2 * 1000 * 4096);
}

static bf_status read_first_snapshot(store *s, const char *id, bf_buffer *rho)
{
    api_array got = { .snapshot = { .index = 77 }, .grid = { .n1 = 77 } };

    bf_status status = store_read_array(s, id, 0, API_ARRAY_DENSITY, &got, rho, NULL);
    assert_true(status == BF_OK || (got.snapshot.index == 77 && got.grid.n1 == 77 && rho->n == 0));
    return status;
}

// One byte of 480,000 is changed, then the size in the head, then a chunk is missing.
static void damage_in_a_snapshot_is_noticed(void **state)
{
    static const char *const damages[] = {
        "UPDATE chunks SET data = CAST(substr(data, 1, 999) || x'00' || substr(data, 1001) AS "
        "BLOB) WHERE part = 0",
        "UPDATE chunks SET data = CAST(x'28b52ffde4ffffffffffffff7f' || substr(data, 14) AS "
        "BLOB) WHERE part = 0",
        "DELETE FROM chunks WHERE part = 1",
        "DELETE FROM chunks WHERE part = 0",
    };
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    bf_buffer rho = { 0 };

    helper_append_snapshot(h->store, record.id, 0);
    assert_int_equal(read_first_snapshot(h->store, record.id, &rho), BF_OK);
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        helper_store_close(h);
        helper_store_sql(h, damages[i]);
        helper_store_open(h);
        rho.n = 0;
        assert_int_equal(read_first_snapshot(h->store, record.id, &rho), BF_ECORRUPT);
    }
    buffer_fini(&rho);
}

static void damage_in_a_curve_is_noticed(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    api_curve curve = { .n = 77 };

    helper_append_samples(h->store, record.id, 0, 5);
    helper_store_close(h);
    helper_store_sql(h, "UPDATE samples SET t = substr(t, 1, 39)");
    helper_store_open(h);
    assert_int_equal(store_read_curve(h->store, record.id, 0, UINT64_MAX, &curve, NULL),
                     BF_ECORRUPT);
    assert_int_equal(curve.n, 77);
}

static void a_snapshot_that_is_not_there_is_not_found(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    api_array got = { .snapshot = { .index = 77 }, .grid = { .n1 = 77 } };
    bf_buffer rho = { 0 };
    api_snapshot_list list = { .n = 77 };

    assert_int_equal(store_read_array(s, record.id, 0, API_ARRAY_DENSITY, &got, &rho, NULL),
                     BF_ENOTFOUND);
    assert_int_equal(
        store_read_array(s, record.id, UINT64_MAX, API_ARRAY_DENSITY, &got, &rho, NULL),
        BF_ENOTFOUND);
    assert_int_equal(got.snapshot.index, 77);
    assert_int_equal(got.grid.n1, 77);
    assert_null(rho.bytes);
    assert_int_equal(store_list_snapshots(s, record.id, &list, NULL), BF_OK);
    assert_int_equal(list.n, 0);
    buffer_fini(&list.items);
}

// I4: a run that was resumed sends again what it sent before.
static void what_is_stored_already_is_neither_stored_nor_emitted_again(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);

    helper_append_samples(s, record.id, 0, 10);
    helper_append_snapshot(s, record.id, 0);
    uint64_t last = helper_find(s, record.id).last_event;
    helper_append_samples(s, record.id, 0, 10);
    helper_append_samples(s, record.id, 3, 4);
    helper_append_samples(s, record.id, 10, 0);
    helper_append_snapshot(s, record.id, 0);
    api_run after = helper_find(s, record.id);
    assert_int_equal(after.last_event, last);
    assert_int_equal(after.n_samples, 10);
    assert_int_equal(after.n_snapshots, 1);
}

// I4: samples 0 .. 9 are stored, 6 .. 14 come; stored and emitted are 10 .. 14.
static void of_a_batch_that_is_known_in_part_the_rest_is_stored_and_emitted(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    store_item rest;
    api_curve curve = { 0 };

    helper_append_samples(s, record.id, 0, 10);
    uint64_t last = helper_find(s, record.id).last_event;
    helper_append_samples(s, record.id, 6, 9);
    helper_curve_item(record.id, 10, 5, &rest);
    helper_events events = helper_read_events(s, record.id, last);
    assert_int_equal(events.n, 1);
    assert_int_equal(events.type, API_EVENT_CURVE);
    assert_string_equal(events.data.bytes, rest.event.bytes);
    assert_int_equal(store_read_curve(s, record.id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_true(helper_curve_is(&curve, 0, 15));
    api_curve_fini(&curve);
    buffer_fini(&events.data);
    helper_item_fini(&rest);
}

// I4: nothing of a batch with a gap is stored, not even what comes before the gap.
static void a_gap_is_refused_with_its_whole_batch(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    store_item items[3];
    store_batch batch = { .run_id = record.id, .n = 3, .items = items, .progress = 0.9 };
    bf_grid grid = helper_grid();
    bf_error err = { 0 };

    batch.grid = &grid;
    for (int with_snapshot = 0; with_snapshot < 2; with_snapshot++) {
        helper_progress_item(record.id, 1, &items[0]);
        helper_curve_item(record.id, 0, 5, &items[1]);
        if (with_snapshot)
            helper_snapshot_item(record.id, 1, &items[2]);
        else
            helper_curve_item(record.id, 6, 1, &items[2]);
        assert_int_equal(helper_store_append(s, &batch, &err), BF_ECORRUPT);
        assert_non_null(strstr(err.text, "gap"));
        for (int i = 0; i < 3; i++)
            helper_item_fini(&items[i]);
    }
    api_run after = helper_find(s, record.id);
    assert_int_equal(after.n_samples, 0);
    assert_int_equal(after.last_event, record.last_event);
    assert_int_equal(after.revision, record.revision);
}

static void sizes_that_do_not_fit_are_refused(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    store_item item;
    bf_error err = { 0 };

    helper_curve_item(record.id, 0, 3, &item);
    item.n = 2;
    assert_int_equal(helper_append(s, record.id, &item, &err), BF_ECORRUPT);
    helper_curve_item(record.id, 0, 3, &item);
    item.values.n -= sizeof(double);
    assert_int_equal(helper_append(s, record.id, &item, &err), BF_ECORRUPT);
    helper_snapshot_item(record.id, 0, &item);
    item.rho.n -= sizeof(float);
    assert_int_equal(helper_append(s, record.id, &item, &err), BF_ECORRUPT);
    assert_int_equal(helper_find(s, record.id).last_event, record.last_event);
}

static void a_grid_does_not_change(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    bf_grid other = { .n1 = HELPER_N2, .n2 = HELPER_N1, .d1 = 0.005, .d2 = 0.005 };
    store_batch batch = { .run_id = record.id, .grid = &other };

    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    helper_append_snapshot(s, record.id, 0);
    assert_int_equal(helper_store_append(s, &batch, NULL), BF_ECORRUPT);
}

static void progress_follows_the_batch(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    store_batch batch = { .run_id = record.id, .progress = 0.25, .eta_s = 12.5 };

    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    api_run after = helper_find(s, record.id);
    assert_true(after.progress == 0.25 && after.eta_s == 12.5);
    assert_int_equal(after.revision, record.revision + 1);
    batch.progress = 1.5;
    batch.eta_s = NAN;
    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    after = helper_find(s, record.id);
    assert_true(after.progress == 1.0 && isnan(after.eta_s));
    batch.progress = NAN;
    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    assert_true(helper_find(s, record.id).progress == 1.0);
}

static void only_a_running_run_may_append(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_submit(s, "", 0);
    store_item item;

    helper_curve_item(record.id, 0, 1, &item);
    assert_int_equal(helper_append(s, record.id, &item, NULL), BF_ECONFLICT);
    helper_claim(s);
    helper_finish(s, record.id, RUN_CANCELLED);
    helper_curve_item(record.id, 0, 1, &item);
    assert_int_equal(helper_append(s, record.id, &item, NULL), BF_ECONFLICT);
}

static void append_checkpoint(store *s, const char *id, uint64_t step, const bf_buffer *bytes)
{
    store_batch batch = {
        .run_id = id,
        .progress = 0.5,
        .eta_s = NAN,
        .wall_s = 2.5,
        .step = step,
        .checkpoint = bytes->bytes,
        .n_checkpoint = bytes->n,
    };

    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
}

static void hand_back(store *s, const char *id)
{
    store_ending ending = { .run_id = id, .state = RUN_QUEUED };
    api_run record = { 0 };

    assert_int_equal(store_finish(s, &ending, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_QUEUED);
}

// I5: the newest checkpoint comes with the next claim, until the run ends.
static void a_run_that_is_handed_back_goes_on_from_its_checkpoint(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    store_item noise;
    store_job job = { 0 };

    helper_snapshot_item(record.id, 7, &noise);
    append_checkpoint(h->store, record.id, 100, &noise.event);
    append_checkpoint(h->store, record.id, 200, &noise.rho);
    helper_append_samples(h->store, record.id, 0, 1);
    hand_back(h->store, record.id);
    assert_int_equal(store_claim(h->store, true, &job, NULL), BF_OK);
    assert_int_equal(job.step, 200);
    assert_true(helper_snapshot_is(&job.checkpoint, 7));
    // helper_append_samples() says 1.5 s, and comes last.
    assert_true(job.wall_s == 1.5);
    helper_finish(h->store, record.id, RUN_SUCCEEDED);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM chunks"), 0);
    store_job_fini(&job);
    helper_item_fini(&noise);
}

static void a_summary_may_come_without_an_end(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    bf_buffer text = { 0 };

    // Timing reported before a run returned to the queue is retained, and replaced at its end.
    helper_finish(s, record.id, RUN_QUEUED);
    helper_claim(s);
    record = helper_finish(s, record.id, RUN_SUCCEEDED);
    assert_int_equal(record.error.code, BF_OK);
    assert_int_equal(store_read_text(s, record.id, API_TEXT_SUMMARY, &text, NULL), BF_OK);
    assert_string_equal(text.bytes, "{\"steps\":4800}");
    buffer_fini(&text);
}

// I7. The events tell all that came, the run and its text the last.
static void key_figures_are_those_that_came_last(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    bf_buffer text = { 0 };
    store_item item;

    assert_int_equal(store_read_text(s, record.id, API_TEXT_FIGURES, &text, NULL), BF_ECONFLICT);
    for (int i = 1; i <= 2; i++) {
        helper_figures_item(record.id, 60 * i, &item);
        assert_int_equal(helper_append(s, record.id, &item, NULL), BF_OK);
        helper_events events = helper_read_events(s, record.id, 0);
        assert_int_equal(events.type, API_EVENT_FIGURES);
        buffer_fini(&events.data);
    }
    helper_finish(s, record.id, RUN_SUCCEEDED);
    assert_string_equal(helper_find(s, record.id).figures, "{\"throughput_per_h\":120}");
    assert_int_equal(store_read_text(s, record.id, API_TEXT_FIGURES, &text, NULL), BF_OK);
    assert_string_equal(text.bytes, "{\"throughput_per_h\":120,\"feeds\":[]}");
    buffer_fini(&text);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(samples_come_back_bit_by_bit_from_any_index),
        STORE_TEST(snapshots_come_back_bit_by_bit),
        STORE_TEST(the_log_stays_small_while_much_is_written),
        STORE_TEST(damage_in_a_snapshot_is_noticed),
        STORE_TEST(damage_in_a_curve_is_noticed),
        STORE_TEST(a_snapshot_that_is_not_there_is_not_found),
        STORE_TEST(what_is_stored_already_is_neither_stored_nor_emitted_again),
        STORE_TEST(of_a_batch_that_is_known_in_part_the_rest_is_stored_and_emitted),
        STORE_TEST(a_gap_is_refused_with_its_whole_batch),
        STORE_TEST(sizes_that_do_not_fit_are_refused),
        STORE_TEST(a_grid_does_not_change),
        STORE_TEST(progress_follows_the_batch),
        STORE_TEST(only_a_running_run_may_append),
        STORE_TEST(a_run_that_is_handed_back_goes_on_from_its_checkpoint),
        STORE_TEST(a_summary_may_come_without_an_end),
        STORE_TEST(key_figures_are_those_that_came_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
