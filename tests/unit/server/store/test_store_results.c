// Unit tests of the store: runs that reuse results. I1 ... I15 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "api/results/events.h"
#include "core/base/memory.h"
#include "core/observe/frame.h"
#include "server/store/store_priv.h"

#include <stdio.h>
#include <string.h>

static const char summary[] = "{\"steps\":4800,\"warnings\":[],\"scenario\":{\"name\":\"first\"}}";

// The scenario with this name is what is to be solved; identity says what of it counts.
static api_submission submission_of(const char *identity, const char *name)
{
    api_submission submission = { .model = RUN_MACRO };

    snprintf(submission.name, sizeof submission.name, "%s", name);
    assert_int_equal(buffer_printf(&submission.scenario, "{\"name\":\"%s\"}", name), BF_OK);
    assert_int_equal(buffer_printf(&submission.columns, "upstream,left_domain"), BF_OK);
    assert_int_equal(buffer_printf(&submission.identity, "%s", identity), BF_OK);
    return submission;
}

static void free_submission(api_submission *submission)
{
    buffer_fini(&submission->scenario);
    buffer_fini(&submission->columns);
    buffer_fini(&submission->identity);
}

static api_run submit(store *s, const char *identity, const char *name)
{
    api_submission submission = submission_of(identity, name);

    api_run record = helper_accept(s, &submission);
    free_submission(&submission);
    return record;
}

static api_run submit_fresh(store *s, const char *identity)
{
    api_submission submission = submission_of(identity, "fresh");

    submission.is_fresh = true;
    api_run record = helper_accept(s, &submission);
    free_submission(&submission);
    return record;
}

// Append a snapshot with one part.
static void append_snapshot(store *s, const char *id, uint64_t index)
{
    const double part[FRAME_VALUES_PLANAR] = { (double)index, 2, 3, 4, 5, 6 };
    bf_grid grid = helper_grid();
    store_item item;
    store_batch batch = { .run_id = id,
                          .n = 1,
                          .items = &item,
                          .grid = &grid,
                          .parts = { .n_parts = 1, .n_values = FRAME_VALUES_PLANAR },
                          .step = index + 1,
                          .checkpoint = "checkpoint",
                          .n_checkpoint = 10 };
    frame_snapshot told = { .index = index, .n1 = HELPER_N1, .n2 = HELPER_N2 };

    helper_snapshot_item(id, index, &item);
    told.t = item.snapshot.t;
    told.peak = item.snapshot.peak;
    told.mass = item.snapshot.mass;
    item.event.n = 0;
    assert_int_equal(events_snapshot(id, &told, true, &item.event, NULL), BF_OK);
    assert_int_equal(buffer_append(&item.parts, part, sizeof part), BF_OK);
    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    helper_item_fini(&item);
}

static api_run end(store *s, const char *id, run_state state)
{
    store_ending ending = {
        .run_id = id, .state = state, .summary = summary, .n_summary = sizeof summary - 1
    };
    api_run record = { 0 };

    assert_int_equal(store_finish(s, &ending, &record, NULL), BF_OK);
    return record;
}

static void append_item(store *s, const char *id, store_item *item)
{
    store_batch batch = { .run_id = id, .n = 1, .items = item };

    assert_int_equal(helper_store_append(s, &batch, NULL), BF_OK);
    helper_item_fini(item);
}

static void append_change(store *s, const char *id, api_event_type type, uint64_t index)
{
    store_item item = { .type = type, .first = index };

    assert_int_equal(buffer_printf(&item.event, "{\"run\":\"%s\",\"k\":%d}", id, (int)index),
                     BF_OK);
    append_item(s, id, &item);
}

// A run that is claimed, has sent samples and snapshots in turns, and succeeds.
static api_run solve(store *s, const char *id)
{
    store_item item;

    assert_string_equal(helper_claim(s).id, id);
    for (uint64_t i = 0; i < 3; i++) {
        append_snapshot(s, id, i);
        helper_progress_item(id, i, &item);
        append_item(s, id, &item);
        helper_curve_item(id, 5 * i, 5, &item);
        append_item(s, id, &item);
    }
    append_change(s, id, API_EVENT_EYE, 0);
    append_change(s, id, API_EVENT_ACTION, 1);
    append_change(s, id, API_EVENT_DRIVE, 2);
    for (int k = 0; k < 3; k++) {
        helper_figures_item(id, 60, &item);
        append_item(s, id, &item);
    }
    return end(s, id, RUN_SUCCEEDED);
}

// Key figures that come again count once, as the last ones alone are those of another run, too.
static bf_status collect(void *context, const api_event *event, bf_error *err)
{
    bool is_shared = event->type == API_EVENT_CURVE || event->type == API_EVENT_SNAPSHOT ||
                     event->type == API_EVENT_FIGURES || event->type == API_EVENT_EYE ||
                     event->type == API_EVENT_ACTION || event->type == API_EVENT_DRIVE;
    const bf_buffer *told = context;
    const bool is_repeated =
        event->type == API_EVENT_FIGURES && told->n > event->n &&
        strncmp(told->bytes + told->n - event->n - 1, event->data, event->n) == 0;

    if (is_shared && !is_repeated)
        assert_int_equal(
            buffer_printf(context, "%s %s\n", api_event_word(event->type), event->data), BF_OK);
    return BF_OK;
}

// The events of results of a run, with every id of `from` made one of `to`.
static bf_buffer told_of(store *s, const char *id, const char *from, const char *to)
{
    char runs[1][API_ID_SIZE];
    bf_buffer text = { 0 };

    memcpy(runs[0], id, API_ID_SIZE);
    assert_int_equal(store_read_events(s, (const char(*)[API_ID_SIZE])runs, 1, 0, SIZE_MAX, collect,
                                       &text, NULL),
                     BF_OK);
    assert_non_null(text.bytes);
    for (char *at = text.bytes; (at = strstr(at, from)) != NULL;)
        memcpy(at, to, strlen(to));
    return text;
}

static void check_results(store *s, const char *id)
{
    api_curve curve = { 0 };
    api_snapshot_list list = { 0 };
    api_array got;

    assert_int_equal(store_read_curve(s, id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_true(helper_curve_is(&curve, 0, 15));
    api_curve_fini(&curve);
    assert_int_equal(store_list_snapshots(s, id, &list, NULL), BF_OK);
    assert_int_equal(list.n, 3);
    assert_int_equal(list.grid.n1, HELPER_N1);
    buffer_fini(&list.items);
    for (uint64_t i = 0; i < 3; i++) {
        bf_buffer rho = { 0 }, rows = { 0 };
        assert_int_equal(store_read_array(s, id, i, API_ARRAY_DENSITY, &got, &rho, NULL), BF_OK);
        assert_true(helper_snapshot_is(&rho, i));
        assert_int_equal(store_read_array(s, id, i, API_ARRAY_PARTS, &got, &rows, NULL), BF_OK);
        assert_true(((const double *)(const void *)rows.bytes)[0] == (double)i);
        buffer_fini(&rho);
        buffer_fini(&rows);
    }
}

static int64_t count(const helper_store *h, const char *table)
{
    char sql[80];

    snprintf(sql, sizeof sql, "SELECT count(*) FROM %s", table);
    return helper_store_sql(h, sql);
}

// I10: nothing of the results is stored twice.
static void what_was_solved_before_is_there_at_once(void **state)
{
    helper_store *h = *state;
    api_run first = submit(h->store, "work", "first");

    assert_false(first.is_cached);
    solve(h->store, first.id);
    int64_t n_chunks = count(h, "chunks");
    api_run second = submit(h->store, "work", "second");
    assert_true(second.is_cached);
    assert_int_equal(second.state, RUN_SUCCEEDED);
    assert_true(second.progress == 1.0);
    assert_string_equal(second.name, "second");
    assert_int_equal(second.started_ms, 0);
    assert_int_equal(second.finished_ms, second.created_ms);
    assert_int_equal(second.n_samples, 15);
    assert_int_equal(second.n_snapshots, 3);
    check_results(h->store, second.id);
    assert_int_equal(count(h, "chunks"), n_chunks);
    assert_int_equal(count(h, "samples"), 3);
    assert_int_equal(count(h, "snapshots"), 3);
    assert_int_equal(count(h, "results"), 1);
}

static void its_texts_are_its_own(void **state)
{
    store *s = ((helper_store *)*state)->store;
    bf_buffer text = { 0 };

    solve(s, submit(s, "work", "first").id);
    // The third one reuses the second as well as the first.
    for (int i = 0; i < 2; i++) {
        api_run other = submit(s, "work", "other");
        text.n = 0;
        assert_int_equal(store_read_text(s, other.id, API_TEXT_SCENARIO, &text, NULL), BF_OK);
        assert_string_equal(text.bytes, "{\"name\":\"other\"}");
        text.n = 0;
        assert_int_equal(store_read_text(s, other.id, API_TEXT_SUMMARY, &text, NULL), BF_OK);
        assert_string_equal(text.bytes, "{\"steps\":4800,\"warnings\":[],\"cached\":true,"
                                        "\"scenario\":{\"name\":\"other\"}}");
        text.n = 0;
        assert_int_equal(store_read_text(s, other.id, API_TEXT_FIGURES, &text, NULL), BF_OK);
        assert_string_equal(text.bytes, "{\"throughput_per_h\":60,\"feeds\":[]}");
        assert_string_equal(helper_find(s, other.id).figures, "{\"throughput_per_h\":60}");
    }
    buffer_fini(&text);
}

// I7, and I6: the same events in the same order, of its own id, then its status and its end.
static void its_events_are_those_of_the_first_with_its_own_id(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run first = submit(s, "work", "first");

    solve(s, first.id);
    uint64_t newest = helper_find(s, first.id).last_event;
    api_run second = submit(s, "work", "second");
    bf_buffer wanted = told_of(s, first.id, first.id, second.id);
    bf_buffer told = told_of(s, second.id, first.id, "no other id than its own is told");
    assert_string_equal(told.bytes, wanted.bytes);
    assert_non_null(strstr(told.bytes, "/parts/2"));
    helper_events events = helper_read_events(s, second.id, newest);
    // Three batches of samples, three snapshots, three of the equipment, the key figures, the status, the end.
    assert_int_equal(events.n, 12);
    assert_int_equal(events.type, API_EVENT_END);
    assert_int_equal(events.id, second.last_event);
    buffer_fini(&events.data);
    buffer_fini(&wanted);
    buffer_fini(&told);
}

static void changes_of_photo_eyes_are_read_by_themselves(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run first = submit(s, "work", "first");
    bf_buffer text = { 0 };
    char expected[240];

    solve(s, first.id);
    api_run second = submit(s, "work", "second");
    for (int k = 0; k < 2; k++) {
        const char *id = k == 0 ? first.id : second.id;
        text.n = 0;
        assert_int_equal(store_read_changes(s, id, collect, &text, NULL), BF_OK);
        snprintf(expected, sizeof expected,
                 "photo_eye {\"run\":\"%s\",\"k\":0}\naction {\"run\":\"%s\",\"k\":1}\n"
                 "drive {\"run\":\"%s\",\"k\":2}\n",
                 id, id, id);
        assert_string_equal(text.bytes, expected);
    }
    text.n = 0;
    assert_int_equal(store_read_changes(s, submit_fresh(s, "work").id, collect, &text, NULL),
                     BF_OK);
    assert_int_equal(text.n, 0);
    assert_int_equal(
        store_read_changes(s, "01900000-0000-7000-8000-000000000000", collect, &text, NULL),
        BF_ENOTFOUND);
    buffer_fini(&text);
}

// Results that are used again are dear in events, not in bytes.
static void what_changes_of_photo_eyes_say_is_stored_once(void **state)
{
    static const char bytes[] = "SELECT sum(length(data)) FROM events WHERE type IN (6, 7, 8)";
    helper_store *h = *state;

    solve(h->store, submit(h->store, "work", "first").id);
    for (int k = 0; k < 3; k++)
        assert_true(submit(h->store, "work", "other").is_cached);
    assert_int_equal(count(h, "changes"), 3);
    assert_int_equal(count(h, "events WHERE type IN (6, 7, 8)"), 12);
    assert_int_equal(helper_store_sql(h, bytes), 0);
    assert_int_equal(count(h, "events WHERE type = 5"), 3 + 3);
}

// I9 and I10: results live as long as the last run that has them.
static void removing_one_leaves_the_others_theirs(void **state)
{
    static const char *const tables[] = { "runs",      "texts",  "samples", "results",
                                          "snapshots", "chunks", "events",  "changes" };
    helper_store *h = *state;
    api_run runs[3];

    runs[0] = submit(h->store, "work", "a");
    solve(h->store, runs[0].id);
    runs[1] = submit(h->store, "work", "b");
    runs[2] = submit(h->store, "work", "c");
    assert_int_equal(store_remove(h->store, runs[0].id, API_ANY_REVISION, NULL), BF_OK);
    check_results(h->store, runs[1].id);
    bf_buffer told = told_of(h->store, runs[2].id, runs[0].id, "no longer anywhere");
    assert_non_null(strstr(told.bytes, "/snapshots/2"));
    buffer_fini(&told);
    // And more may still join.
    assert_true(submit(h->store, "work", "d").is_cached);
    helper_store_close(h);
    helper_store_open(h);
    api_list_query all = { .state = -1, .model = -1, .limit = 9 };
    static api_run_list list;
    assert_int_equal(store_list(h->store, &all, &list, NULL), BF_OK);
    for (size_t i = 0; i < list.n; i++) {
        check_results(h->store, list.runs[i].id);
        assert_true(list.runs[i].is_cached);
        assert_int_equal(store_remove(h->store, list.runs[i].id, API_ANY_REVISION, NULL), BF_OK);
    }
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        assert_int_equal(count(h, tables[i]), 0);
    assert_false(submit(h->store, "work", "e").is_cached);
}

static void only_the_same_work_is_the_same(void **state)
{
    store *s = ((helper_store *)*state)->store;

    solve(s, submit(s, "work", "first").id);
    assert_false(submit(s, "other work", "first").is_cached);
    assert_false(submit(s, "", "first").is_cached);
    assert_false(submit_fresh(s, "work").is_cached);
    api_submission submission = submission_of("work", "first");
    submission.model = RUN_MICRO;
    assert_false(helper_accept(s, &submission).is_cached);
    free_submission(&submission);
    assert_true(submit(s, "work", "first").is_cached);
}

// Each answer that is known costs the only thread that writes a copy of the run's events of photo eyes and plates.
static void results_with_very_many_changes_are_not_reused(void **state)
{
    helper_store *h = *state;

    solve(h->store, submit(h->store, "work", "first").id);
    assert_true(submit(h->store, "work", "second").is_cached);
    helper_store_close(h);
    helper_store_sql(h, "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number "
                        "WHERE i < 5001) INSERT INTO events (run, type, snapshot, data) SELECT "
                        "runs.number, 6, i, '{}' FROM number, runs");
    helper_store_open(h);
    assert_false(submit(h->store, "work", "third").is_cached);
}

// Neither what waits, runs, failed or was cancelled, nor what has no identity.
static void only_results_of_success_are_reused(void **state)
{
    store *s = ((helper_store *)*state)->store;
    static const run_state ends[] = { RUN_FAILED, RUN_CANCELLED };

    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        api_run first = submit(s, "work", "first");
        assert_false(first.is_cached);
        assert_string_equal(helper_claim(s).id, first.id);
        api_run second = submit(s, "work", "second");
        assert_false(second.is_cached);
        assert_int_equal(store_cancel(s, second.id, API_ANY_REVISION, &second, NULL), BF_OK);
        end(s, first.id, ends[i]);
    }
    solve(s, submit(s, "", "first").id);
    assert_false(submit(s, "", "first").is_cached);
}

static void a_fresh_run_is_solved_and_the_newest_results_count(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run first = submit(s, "work", "first");

    solve(s, first.id);
    api_run fresh = submit_fresh(s, "work");
    assert_int_equal(fresh.state, RUN_QUEUED);
    assert_true(submit(s, "work", "meanwhile").is_cached);
    solve(s, fresh.id);
    submit(s, "work", "last");
    assert_int_equal(helper_store_sql(*state, "SELECT count(*) FROM runs WHERE results = "
                                              "(SELECT max(number) FROM results)"),
                     2);
}

// A full queue does not matter to what needs no solving.
static void known_results_do_not_wait(void **state)
{
    helper_store *h = *state;
    store_options options = { .directory = h->directory, .queue_limit = 1 };

    solve(h->store, submit(h->store, "work", "first").id);
    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    helper_submit(h->store, "", 0);
    assert_true(submit(h->store, "work", "second").is_cached);
}

// What another version began or solved is not reused.
static void results_of_another_solver_do_not_count(void **state)
{
    helper_store *h = *state;
    api_run first = submit(h->store, "work", "first");

    helper_store_close(h);
    helper_store_sql(h, "UPDATE results SET solver = '0.0.9/0'");
    helper_store_open(h);
    solve(h->store, first.id);
    assert_false(submit(h->store, "work", "second").is_cached);
    helper_store_close(h);
    helper_store_sql(h, "UPDATE results SET solver = '0.0.9/0' WHERE state = 1");
    helper_store_open(h);
    assert_false(submit(h->store, "work", "third").is_cached);
}

static void a_damaged_summary_is_not_reused(void **state)
{
    helper_store *h = *state;

    solve(h->store, submit(h->store, "work", "first").id);
    helper_store_close(h);
    helper_store_sql(h, "UPDATE texts SET data = '{' WHERE kind = 1");
    helper_store_open(h);
    assert_false(submit(h->store, "work", "second").is_cached);
}

// A curve that is damaged is reported as such, not read beyond its end.
static void damaged_samples_are_noticed(void **state)
{
    helper_store *h = *state;
    char runs[1][API_ID_SIZE];
    bf_buffer text = { 0 };
    bf_error err = { 0 };

    solve(h->store, submit(h->store, "work", "first").id);
    memcpy(runs[0], submit(h->store, "work", "second").id, API_ID_SIZE);
    helper_store_close(h);
    helper_store_sql(h, "UPDATE samples SET parts = x'00' WHERE first = 5");
    helper_store_open(h);
    assert_int_equal(store_read_events(h->store, (const char(*)[API_ID_SIZE])runs, 1, 0, SIZE_MAX,
                                       collect, &text, &err),
                     BF_ECORRUPT);
    assert_non_null(strstr(err.text, "sample 5"));
    buffer_fini(&text);
}

static void without_memory_nothing_is_reused(void **state)
{
    helper_store *h = *state;
    api_submission submission = submission_of("work", "second");

    solve(h->store, submit(h->store, "work", "first").id);
    for (size_t n = 1;; n++) {
        api_acceptance accepted = { .revision = 77 };
        memory_plan_fault(n, 0);
        bf_status status = store_submit(h->store, &submission, &accepted, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        assert_int_equal(count(h, "runs"), status == BF_OK ? 2 : 1);
        assert_true(status == BF_OK || accepted.revision == 77);
        buffer_fini(&accepted.answer);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            break;
        }
        assert_int_equal(status, BF_ENOMEM);
    }
    free_submission(&submission);
}

static void without_memory_reused_events_are_not_read(void **state)
{
    store *s = ((helper_store *)*state)->store;
    char runs[1][API_ID_SIZE];

    solve(s, submit(s, "work", "first").id);
    memcpy(runs[0], submit(s, "work", "second").id, API_ID_SIZE);
    for (size_t n = 1;; n++) {
        bf_buffer text = { 0 };
        assert_non_null(buffer_reserve(&text, 100000));
        memory_plan_fault(n, 0);
        bf_status status = store_read_events(s, (const char(*)[API_ID_SIZE])runs, 1, 0, SIZE_MAX,
                                             collect, &text, NULL);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        buffer_fini(&text);
        assert_int_equal(status, n_faults == 0 ? BF_OK : BF_ENOMEM);
        if (n_faults == 0)
            break;
    }
}

// I9: more chunks than one step deletes, and a daemon that dies between the steps.
static void large_results_go_step_by_step_also_after_a_crash(void **state)
{
    helper_store *h = *state;
    api_run first = submit(h->store, "work", "first");

    solve(h->store, first.id);
    helper_store_close(h);
    helper_store_sql(h, "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number "
                        "WHERE i < 1000) INSERT INTO chunks (results, kind, item, part, data) "
                        "SELECT 1, 0, 2, 1000 + i, x'00' FROM number");
    helper_store_sql(h, "UPDATE results SET state = 2");
    helper_store_sql(h, "PRAGMA foreign_keys = ON");
    helper_store_sql(h, "DELETE FROM events");
    helper_store_sql(h, "DELETE FROM texts");
    helper_store_sql(h, "DELETE FROM runs");
    helper_store_open(h);
    api_run next = submit(h->store, "work", "next"); // goes in between
    assert_false(next.is_cached);
    helper_await_sql(h, "SELECT count(*) FROM chunks", 0);
    helper_await_sql(h, "SELECT count(*) FROM results", 1);
    assert_int_equal(count(h, "snapshots"), 0);
    assert_int_equal(store_remove(h->store, next.id, API_ANY_REVISION, NULL), BF_OK);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(what_was_solved_before_is_there_at_once),
        STORE_TEST(its_texts_are_its_own),
        STORE_TEST(its_events_are_those_of_the_first_with_its_own_id),
        STORE_TEST(changes_of_photo_eyes_are_read_by_themselves),
        STORE_TEST(what_changes_of_photo_eyes_say_is_stored_once),
        STORE_TEST(removing_one_leaves_the_others_theirs),
        STORE_TEST(only_the_same_work_is_the_same),
        STORE_TEST(results_with_very_many_changes_are_not_reused),
        STORE_TEST(only_results_of_success_are_reused),
        STORE_TEST(a_fresh_run_is_solved_and_the_newest_results_count),
        STORE_TEST(known_results_do_not_wait),
        STORE_TEST(results_of_another_solver_do_not_count),
        STORE_TEST(a_damaged_summary_is_not_reused),
        STORE_TEST(damaged_samples_are_noticed),
        STORE_TEST(without_memory_nothing_is_reused),
        STORE_TEST(without_memory_reused_events_are_not_read),
        STORE_TEST(large_results_go_step_by_step_also_after_a_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
