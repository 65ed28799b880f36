// Unit tests of the store: the life of a run. I1 ... I15 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char unknown[] = "01900000-0000-7000-8000-000000000000";

static void a_submitted_run_is_queued_and_says_so(void **state)
{
    store *s = ((helper_store *)*state)->store;

    api_run record = helper_submit(s, "mine", 5);
    assert_int_equal(record.state, RUN_QUEUED);
    assert_string_equal(record.label, "mine");
    assert_int_equal(record.priority, 5);
    assert_string_equal(record.name, "a belt");
    assert_true(record.created_ms > 0);
    assert_int_equal(record.started_ms, 0);
    assert_true(isnan(record.eta_s));
    assert_true(isnan(record.predicted_s));
    api_run found = helper_find(s, record.id);
    assert_true(isnan(found.predicted_s));
    assert_int_equal(found.revision, record.revision);
    assert_int_equal(found.last_event, record.last_event);

    // I7: the event stands in the store as soon as the run does.
    helper_events events = helper_read_events(s, record.id, 0);
    assert_int_equal(events.n, 1);
    assert_int_equal(events.type, API_EVENT_STATUS);
    assert_int_equal(events.id, record.last_event);
    assert_non_null(strstr(events.data.bytes, "\"status\":\"queued\""));
    buffer_fini(&events.data);
}

static void the_highest_priority_is_claimed_first_then_the_oldest(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run second = helper_submit(s, "", 0);
    api_run third = helper_submit(s, "", 0);
    api_run last = helper_submit(s, "", -1);
    api_run first = helper_submit(s, "", 100);

    assert_string_equal(helper_claim(s).id, first.id);
    assert_string_equal(helper_claim(s).id, second.id);
    assert_string_equal(helper_claim(s).id, third.id);
    assert_string_equal(helper_claim(s).id, last.id);
}

static void a_claim_brings_all_that_solving_needs(void **state)
{
    store *s = ((helper_store *)*state)->store;
    store_job job = { 0 };

    api_run submitted = helper_submit(s, "", 0);
    assert_int_equal(store_claim(s, true, &job, NULL), BF_OK);
    assert_string_equal(job.run.id, submitted.id);
    assert_int_equal(job.run.state, RUN_RUNNING);
    assert_true(job.run.revision > submitted.revision);
    assert_true(job.run.started_ms >= submitted.created_ms);
    assert_string_equal(job.scenario.bytes, "{\"duration_s\":6}");
    assert_string_equal(job.columns.bytes, "upstream,left_domain");
    assert_int_equal(job.checkpoint.n, 0);
    assert_int_equal(job.step, 0);
    assert_true(job.wall_s == 0.0);
    store_job_fini(&job);

    job.step = 77;
    assert_int_equal(store_claim(s, true, &job, NULL), BF_ENOTFOUND);
    assert_int_equal(job.step, 77);
}

// The samples that the run has sent already are stored; only the state to go on from is lost.
static void a_damaged_checkpoint_costs_no_more_than_itself(void **state)
{
    helper_store *h = *state;
    store_job job = { 0 };
    api_run record = helper_start(h->store);
    store_batch batch = {
        .run_id = record.id, .step = 5, .checkpoint = "checkpoint", .n_checkpoint = 10
    };
    store_ending ending = { .run_id = record.id, .state = RUN_QUEUED };

    assert_int_equal(helper_store_append(h->store, &batch, NULL), BF_OK);
    assert_int_equal(store_finish(h->store, &ending, &record, NULL), BF_OK);
    helper_store_close(h);
    helper_store_sql(h, "UPDATE chunks SET data = zeroblob(8)");
    helper_store_open(h);
    assert_int_equal(store_claim(h->store, true, &job, NULL), BF_OK);
    assert_string_equal(job.run.id, record.id);
    assert_int_equal(job.checkpoint.n, 0);
    assert_int_equal(job.step, 0);
    store_job_fini(&job);
}

static void a_full_queue_is_busy(void **state)
{
    helper_store *h = *state;
    store_options options = { .directory = h->directory, .queue_limit = 2 };
    api_submission submission = { .model = RUN_MACRO };
    api_acceptance accepted = { .revision = 77 };
    bf_error err = { 0 };

    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    helper_submit(h->store, "", 0);
    helper_submit(h->store, "", 0);
    assert_int_equal(store_submit(h->store, &submission, &accepted, &err), BF_EBUSY);
    assert_int_equal(accepted.revision, 77);
    assert_non_null(strstr(err.text, "limit is 2"));
    helper_claim(h->store);
    helper_submit(h->store, "", 0);
}

static void the_last_event_of_a_run_is_its_end(void **state)
{
    static const run_state ends[] = { RUN_SUCCEEDED, RUN_CANCELLED };
    store *s = ((helper_store *)*state)->store;

    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        bf_buffer summary = { 0 };
        api_run record = helper_start(s);
        assert_int_equal(store_read_text(s, record.id, API_TEXT_SUMMARY, &summary, NULL),
                         BF_ECONFLICT);
        record = helper_finish(s, record.id, ends[i]);
        assert_int_equal(record.state, ends[i]);
        assert_true(record.finished_ms >= record.started_ms);
        assert_true(record.has_summary);
        assert_true((record.progress == 1.0) == (ends[i] == RUN_SUCCEEDED));
        // Queued, running, its end's status, its end.
        helper_events events = helper_read_events(s, record.id, 0);
        assert_int_equal(events.n, 4);
        assert_int_equal(events.type, API_EVENT_END);
        assert_int_equal(events.id, record.last_event);
        buffer_fini(&events.data);
        assert_int_equal(store_read_text(s, record.id, API_TEXT_SUMMARY, &summary, NULL), BF_OK);
        assert_string_equal(summary.bytes, "{\"steps\":4800}");
        buffer_fini(&summary);
    }
}

static void a_failure_has_its_reason(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    store_ending ending = { .run_id = record.id, .state = RUN_FAILED };

    bf_fail(&ending.error, BF_ENUMERIC, "/macro/step_s", "not finite at step %d", 7);
    assert_int_equal(store_finish(s, &ending, &record, NULL), BF_OK);
    record = helper_find(s, record.id);
    assert_int_equal(record.state, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ENUMERIC);
    assert_string_equal(record.error.pointer, "/macro/step_s");
    assert_string_equal(record.error.text, "not finite at step 7");
    assert_false(record.has_summary);
}

static bf_status try_to_finish(store *s, const char *id, run_state to)
{
    store_ending ending = { .run_id = id, .state = to };
    api_run record = { .priority = 77 };
    bf_error err = { 0 };

    bf_status status = store_finish(s, &ending, &record, &err);
    assert_true(status == BF_OK || (record.priority == 77 && err.code == status));
    return status;
}

// I3: what run_state.h's table does not allow changes nothing.
static void a_run_changes_only_along_the_arrows(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_submit(s, "", 0);

    for (int to = 0; to < RUN_STATE_COUNT; to++)
        assert_int_equal(try_to_finish(s, record.id, (run_state)to), BF_ECONFLICT);
    helper_claim(s);
    assert_int_equal(try_to_finish(s, record.id, RUN_RUNNING), BF_ECONFLICT);
    assert_int_equal(helper_find(s, record.id).state, RUN_RUNNING);
    assert_int_equal(try_to_finish(s, record.id, RUN_SUCCEEDED), BF_OK);
    uint64_t revision = helper_find(s, record.id).revision;
    for (int to = 0; to < RUN_STATE_COUNT; to++)
        assert_int_equal(try_to_finish(s, record.id, (run_state)to), BF_ECONFLICT);
    assert_int_equal(store_cancel(s, record.id, API_ANY_REVISION, &record, NULL), BF_ECONFLICT);
    assert_int_equal(helper_find(s, record.id).state, RUN_SUCCEEDED);
    assert_int_equal(helper_find(s, record.id).revision, revision);
}

static void a_queued_run_is_cancelled_at_once(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_submit(s, "", 0);

    assert_int_equal(store_cancel(s, record.id, API_ANY_REVISION, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_CANCELLED);
    assert_true(record.finished_ms > 0);
    helper_events events = helper_read_events(s, record.id, 0);
    assert_int_equal(events.n, 3);
    assert_int_equal(events.type, API_EVENT_END);
    buffer_fini(&events.data);
    store_job job = { 0 };
    assert_int_equal(store_claim(s, true, &job, NULL), BF_ENOTFOUND);
}

static void a_running_run_is_left_to_the_supervisor(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run before = helper_start(s);
    api_run record = { 0 };

    assert_int_equal(store_cancel(s, before.id, API_ANY_REVISION, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_RUNNING);
    assert_int_equal(record.revision, before.revision);
    assert_int_equal(store_remove(s, before.id, API_ANY_REVISION, NULL), BF_ECONFLICT);
    assert_int_equal(helper_find(s, before.id).last_event, before.last_event);
}

static void only_the_revision_that_is_expected_is_changed(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_submit(s, "", 0);
    uint64_t before = record.revision;

    assert_int_equal(store_cancel(s, record.id, before + 1, &record, NULL), BF_EINPUT);
    assert_int_equal(store_remove(s, record.id, before + 1, NULL), BF_EINPUT);
    assert_int_equal(helper_find(s, record.id).state, RUN_QUEUED);
    assert_int_equal(helper_find(s, record.id).revision, before);
    assert_int_equal(store_cancel(s, record.id, before, &record, NULL), BF_OK);
    assert_true(record.revision > before);
    assert_int_equal(store_cancel(s, record.id, before, &record, NULL), BF_EINPUT);
    assert_int_equal(store_remove(s, record.id, before, NULL), BF_EINPUT);
    assert_int_equal(store_remove(s, record.id, record.revision, NULL), BF_OK);
}

static void annotations_change_at_any_time_and_nothing_else_does(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_run before = helper_start(s);
    const api_annotations to = {
        .name = "Monday", .label = "hall 2", .notes = "as built", .is_starred = true
    };
    api_run record = { 0 };

    assert_int_equal(store_annotate(s, before.id, before.revision + 1, &to, &record, NULL),
                     BF_EINPUT);
    assert_int_equal(store_annotate(s, before.id, before.revision, &to, &record, NULL), BF_OK);
    record = helper_find(s, before.id);
    assert_string_equal(record.name, "Monday");
    assert_string_equal(record.label, "hall 2");
    assert_string_equal(record.notes, "as built");
    assert_true(record.is_starred);
    assert_int_equal(record.revision, before.revision + 1);
    assert_int_equal(record.last_event, before.last_event);
    assert_int_equal(record.state, RUN_RUNNING);
    assert_int_equal(store_annotate(s, unknown, API_ANY_REVISION, &to, &record, NULL),
                     BF_ENOTFOUND);
}

static void an_unknown_run_is_not_found(void **state)
{
    store *s = ((helper_store *)*state)->store;
    store_batch batch = { .run_id = unknown };
    api_run record = { .priority = 77 };
    api_curve curve = { .n = 77 };
    api_snapshot_list list = { .n = 77 };
    api_array got = { .snapshot = { .index = 77 }, .grid = { .n1 = 77 } };
    bf_buffer out = { 0 };
    bf_error err = { 0 };

    assert_int_equal(store_find(s, unknown, &record, &err), BF_ENOTFOUND);
    assert_non_null(strstr(err.text, unknown));
    assert_int_equal(store_cancel(s, unknown, API_ANY_REVISION, &record, NULL), BF_ENOTFOUND);
    assert_int_equal(try_to_finish(s, unknown, RUN_FAILED), BF_ENOTFOUND);
    assert_int_equal(store_remove(s, unknown, API_ANY_REVISION, NULL), BF_ENOTFOUND);
    assert_int_equal(helper_store_append(s, &batch, NULL), BF_ENOTFOUND);
    assert_int_equal(store_read_text(s, unknown, API_TEXT_SCENARIO, &out, NULL), BF_ENOTFOUND);
    assert_int_equal(store_read_curve(s, unknown, 0, UINT64_MAX, &curve, NULL), BF_ENOTFOUND);
    assert_int_equal(store_list_snapshots(s, unknown, &list, NULL), BF_ENOTFOUND);
    assert_int_equal(store_read_array(s, unknown, 0, API_ARRAY_DENSITY, &got, &out, NULL),
                     BF_ENOTFOUND);
    assert_int_equal(record.priority, 77);
    assert_int_equal(curve.n, 77);
    assert_int_equal(list.n, 77);
    assert_int_equal(got.snapshot.index, 77);
    assert_int_equal(got.grid.n1, 77);
    assert_null(out.bytes);
}

// I9: after the only run is gone every table is empty (but for the probe's one row).
static void a_removed_run_leaves_nothing_behind(void **state)
{
    static const char *const tables[] = { "runs",      "texts",  "samples",
                                          "snapshots", "chunks", "events" };
    helper_store *h = *state;
    char sql[64];
    api_run record = helper_start(h->store);

    helper_append_samples(h->store, record.id, 0, 3);
    helper_append_snapshot(h->store, record.id, 0);
    helper_finish(h->store, record.id, RUN_SUCCEEDED);
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        snprintf(sql, sizeof sql, "SELECT count(*) FROM %s", tables[i]);
        assert_true(helper_store_sql(h, sql) > 0);
    }
    assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(store_find(h->store, record.id, &record, NULL), BF_ENOTFOUND);
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        snprintf(sql, sizeof sql, "SELECT count(*) FROM %s", tables[i]);
        assert_int_equal(helper_store_sql(h, sql), 0);
    }
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM pragma_foreign_key_check"), 0);
}

// I6: the newest events are removed and the store is opened again; the next ids are still greater.
static void event_ids_are_never_used_again(void **state)
{
    helper_store *h = *state;
    api_run record = helper_submit(h->store, "", 0);
    uint64_t newest = record.last_event;

    assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
    assert_true(helper_submit(h->store, "", 0).last_event > newest);
    helper_store_close(h);
    helper_store_open(h);
    record = helper_claim(h->store);
    assert_int_equal(
        store_remove(h->store, helper_submit(h->store, "", 0).id, API_ANY_REVISION, NULL), BF_OK);
    assert_true(helper_submit(h->store, "", 0).last_event > record.last_event + 1);
}

// I8, and runs that had returned to the queue before: both are queued after the start, in the order of their ids.
static void what_was_running_is_queued_again_after_a_restart(void **state)
{
    helper_store *h = *state;
    api_run interrupted = helper_start(h->store);
    api_run handed_back = helper_start(h->store);
    api_run ended = helper_start(h->store);
    store_ending ending = { .run_id = handed_back.id, .state = RUN_QUEUED };

    helper_append_samples(h->store, interrupted.id, 0, 5);
    assert_int_equal(store_finish(h->store, &ending, &handed_back, NULL), BF_OK);
    assert_int_equal(handed_back.finished_ms, 0);
    helper_finish(h->store, ended.id, RUN_SUCCEEDED);
    uint64_t last = helper_find(h->store, interrupted.id).last_event;
    helper_store_close(h);
    helper_store_open(h);

    api_run record = helper_find(h->store, interrupted.id);
    assert_int_equal(record.state, RUN_QUEUED);
    assert_int_equal(record.n_samples, 5);
    helper_events events = helper_read_events(h->store, interrupted.id, last);
    assert_int_equal(events.n, 1);
    assert_non_null(strstr(events.data.bytes, "\"status\":\"queued\""));
    buffer_fini(&events.data);
    assert_int_equal(helper_find(h->store, ended.id).state, RUN_SUCCEEDED);
    assert_string_equal(helper_claim(h->store).id, interrupted.id);
    assert_string_equal(helper_claim(h->store).id, handed_back.id);
}

static void a_store_that_can_write_is_ready(void **state)
{
    helper_store *h = *state;

    assert_int_equal(store_ready(h->store, NULL), BF_OK);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM probe"), 1);
    // A second call soon after is answered from the cache.
    int64_t at_ms = helper_store_sql(h, "SELECT at_ms FROM probe");
    assert_int_equal(store_ready(h->store, NULL), BF_OK);
    assert_int_equal(helper_store_sql(h, "SELECT at_ms FROM probe"), at_ms);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_submitted_run_is_queued_and_says_so),
        STORE_TEST(the_highest_priority_is_claimed_first_then_the_oldest),
        STORE_TEST(a_claim_brings_all_that_solving_needs),
        STORE_TEST(a_damaged_checkpoint_costs_no_more_than_itself),
        STORE_TEST(a_full_queue_is_busy),
        STORE_TEST(the_last_event_of_a_run_is_its_end),
        STORE_TEST(a_failure_has_its_reason),
        STORE_TEST(a_run_changes_only_along_the_arrows),
        STORE_TEST(a_queued_run_is_cancelled_at_once),
        STORE_TEST(a_running_run_is_left_to_the_supervisor),
        STORE_TEST(only_the_revision_that_is_expected_is_changed),
        STORE_TEST(annotations_change_at_any_time_and_nothing_else_does),
        STORE_TEST(an_unknown_run_is_not_found),
        STORE_TEST(a_removed_run_leaves_nothing_behind),
        STORE_TEST(event_ids_are_never_used_again),
        STORE_TEST(what_was_running_is_queued_again_after_a_restart),
        STORE_TEST(a_store_that_can_write_is_ready),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
