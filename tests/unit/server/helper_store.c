#include "tests/unit/server/helper_store.h"
#include "tests/unit/server/helper_await.h"

#include "api/results/events.h"
#include "api/scenario/scenario.h"
#include "api/scenario/submission.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "server/store/backup.h"
#include "server/store/page_sums.h"

#include <dirent.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void helper_store_open(helper_store *h)
{
    store_options options = { .directory = h->directory, .queue_limit = 100 };
    bf_error err = { 0 };

    if (store_open(&options, &h->store, &err) != BF_OK)
        fail_msg("%s", err.text);
}

void helper_store_close(helper_store *h)
{
    h->store = store_close(h->store);
}

int helper_store_setup(void **state)
{
    helper_store *h = calloc(1, sizeof *h);

    assert_non_null(h);
    strcpy(h->directory, "/tmp/beltflow-store-XXXXXX");
    assert_non_null(mkdtemp(h->directory));
    helper_store_open(h);
    *state = h;
    return 0;
}

void helper_store_remove_directory(const char *path)
{
    char name[512];
    DIR *directory = opendir(path);

    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        if (entry->d_name[0] != '.')
            assert_int_equal(unlink(name), 0);
    }
    closedir(directory);
    assert_int_equal(rmdir(path), 0);
}

int helper_store_teardown(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    helper_store_remove_directory(h->directory);
    free(h);
    return 0;
}

static void note_finding(void *context, const char *name, const char *claim, const char *finding)
{
    if (finding != NULL)
        fail_msg("%s: %s: %s", name, claim, finding);
}

void helper_store_verify_file(const char *path)
{
    bool is_sound = false;

    assert_int_equal(store_verify(path, note_finding, NULL, &is_sound, NULL), BF_OK);
    assert_true(is_sound);
}

void helper_store_verify(const helper_store *h)
{
    char path[128];

    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    helper_store_verify_file(path);
}

int64_t helper_store_sql(const helper_store *h, const char *sql)
{
    char path[128];
    sqlite3 *db = NULL;
    sqlite3_stmt *statement = NULL;
    int64_t value = -1;

    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    // By the store's own VFS: what is written without sums would be taken for damage.
    assert_int_equal(store__register_page_sums(NULL), BF_OK);
    assert_int_equal(sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE, STORE__PAGE_SUMS),
                     SQLITE_OK);
    // The store's own threads may hold the lock at this moment.
    assert_int_equal(sqlite3_busy_timeout(db, HELPER_PATIENCE_MS), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &statement, NULL), SQLITE_OK);
    int code = sqlite3_step(statement);
    if (code == SQLITE_ROW)
        value = sqlite3_column_int64(statement, 0);
    else
        assert_int_equal(code, SQLITE_DONE);
    sqlite3_finalize(statement);
    sqlite3_close(db);
    return value;
}

void helper_await_sql(const helper_store *h, const char *sql, int64_t wanted)
{
    const int64_t deadline_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;
    int64_t value = helper_store_sql(h, sql);

    while (value != wanted) {
        if (clock_monotonic_ms() > deadline_ms)
            fail_msg("%s is %lld and does not become %lld", sql, (long long)value,
                     (long long)wanted);
        usleep(5000);
        value = helper_store_sql(h, sql);
    }
}

static void fill(bf_buffer *buffer, const char *text)
{
    assert_int_equal(buffer_append(buffer, text, strlen(text)), BF_OK);
}

api_run helper_accept(store *s, const api_submission *submission)
{
    api_acceptance accepted = { 0 };
    bf_error err = { 0 };

    if (store_submit(s, submission, &accepted, &err) != BF_OK)
        fail_msg("%s", err.text);
    buffer_fini(&accepted.answer);
    return helper_find(s, accepted.id);
}

api_run helper_submit(store *s, const char *label, int priority)
{
    api_submission submission = { .model = RUN_MACRO, .priority = priority, .name = "a belt" };

    snprintf(submission.label, sizeof submission.label, "%s", label);
    fill(&submission.scenario, "{\"duration_s\":6}");
    fill(&submission.columns, "upstream,left_domain");
    api_run record = helper_accept(s, &submission);
    buffer_fini(&submission.scenario);
    buffer_fini(&submission.columns);
    return record;
}

api_run helper_submit_solvable(store *s)
{
    static const char document[] =
        "{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
        "\"belts\":[{\"velocity_m_s\":[0.4,0]}],"
        "\"initial\":{\"hexagonal\":{\"rows\":4,\"columns\":4,\"first_m\":[0.1,0.1],"
        "\"spacing_m\":0.03}},\"cargo\":{\"shape\":{\"type\":\"cylinder\"}},\"macro\":{\"step_s\":"
        "\"auto\"}}";
    api_submission submission;
    bf_faults faults = { 0 };
    scene of;

    assert_int_equal(scenario_read(document, sizeof document - 1, &of, &faults, NULL), BF_OK);
    assert_int_equal(submission_make(&of, RUN_MACRO, &submission, NULL), BF_OK);
    scene_fini(&of);
    const api_run record = helper_accept(s, &submission);
    submission_fini(&submission);
    return record;
}

api_run helper_claim(store *s)
{
    store_job job = { 0 };
    bf_error err = { 0 };

    if (store_claim(s, true, &job, &err) != BF_OK)
        fail_msg("%s", err.text);
    api_run record = job.run;
    store_job_fini(&job);
    return record;
}

api_run helper_start(store *s)
{
    api_run submitted = helper_submit(s, "", 0);
    api_run record = helper_claim(s);

    assert_string_equal(record.id, submitted.id);
    return record;
}

api_run helper_find(store *s, const char *id)
{
    api_run record = { 0 };
    bf_error err = { 0 };

    if (store_find(s, id, &record, &err) != BF_OK)
        fail_msg("%s", err.text);
    return record;
}

static void append_double(bf_buffer *buffer, double value)
{
    assert_int_equal(buffer_append(buffer, &value, sizeof value), BF_OK);
}

void helper_curve_item(const char *id, uint64_t first, size_t n, store_item *item)
{
    *item = (store_item){ .type = API_EVENT_CURVE, .first = first, .n = n };
    for (uint64_t i = first; i < first + n; i++) {
        append_double(&item->t, (double)i / 100.0);
        for (int c = 0; c < HELPER_COLUMNS; c++)
            append_double(&item->values, (double)i + 1000.0 * c);
    }
    frame_curve curve = {
        .first = first,
        .n = (uint32_t)n,
        .n_columns = HELPER_COLUMNS,
        .t = (const double *)(const void *)item->t.bytes,
        .values = (const double *)(const void *)item->values.bytes,
    };
    assert_int_equal(events_curve(id, &curve, "upstream,left_domain", &item->event, NULL), BF_OK);
}

bf_grid helper_grid(void)
{
    return (bf_grid){ .n1 = HELPER_N1, .n2 = HELPER_N2, .d1 = 0.005, .d2 = 0.005 };
}

static uint32_t next_noise(uint32_t *state)
{
    *state = *state * 1664525U + 1013904223U;
    return *state;
}

void helper_snapshot_item(const char *id, uint64_t index, store_item *item)
{
    api_snapshot snapshot = { .index = index, .t = 0.1 * (double)index, .peak = 1.25, .mass = 192 };
    frame_snapshot told = { .index = index, .t = snapshot.t, .n1 = HELPER_N1, .n2 = HELPER_N2 };
    uint32_t noise = (uint32_t)index + 1;

    *item = (store_item){ .type = API_EVENT_SNAPSHOT, .snapshot = snapshot };
    for (int j = 0; j < HELPER_N2; j++) {
        uint32_t row[HELPER_N1];
        for (int i = 0; i < HELPER_N1; i++)
            row[i] = next_noise(&noise);
        assert_int_equal(buffer_append(&item->rho, row, sizeof row), BF_OK);
    }
    assert_int_equal(events_snapshot(id, &told, false, &item->event, NULL), BF_OK);
}

bool helper_snapshot_is(const bf_buffer *rho, uint64_t index)
{
    uint32_t noise = (uint32_t)index + 1;
    uint32_t bits = 0;

    if (rho->n != HELPER_N1 * HELPER_N2 * sizeof bits)
        return false;
    for (size_t at = 0; at < rho->n; at += sizeof bits) {
        memcpy(&bits, rho->bytes + at, sizeof bits);
        if (bits != next_noise(&noise))
            return false;
    }
    return true;
}

bool helper_curve_is(const api_curve *curve, uint64_t first, size_t n)
{
    const double *t = (const double *)(const void *)curve->t.bytes;
    const double *values = (const double *)(const void *)curve->values.bytes;

    if (curve->n != n || curve->n_columns != HELPER_COLUMNS || curve->t.n != n * sizeof *t ||
        curve->values.n != n * HELPER_COLUMNS * sizeof *values)
        return false;
    for (size_t i = 0; i < n; i++) {
        double index = (double)(first + i);
        if (t[i] != index / 100.0 || values[2 * i] != index || values[2 * i + 1] != index + 1000.0)
            return false;
    }
    return true;
}

void helper_progress_item(const char *id, uint64_t step, store_item *item)
{
    frame_progress progress = { .step = step, .n_steps = 1000, .t = (double)step };

    *item = (store_item){ .type = API_EVENT_PROGRESS };
    assert_int_equal(events_progress(id, &progress, 100.0, &item->event, NULL), BF_OK);
}

void helper_figures_item(const char *id, int throughput, store_item *item)
{
    *item = (store_item){ .type = API_EVENT_FIGURES };
    snprintf(item->run_figures, sizeof item->run_figures, "{\"throughput_per_h\":%d}", throughput);
    assert_int_equal(
        buffer_printf(&item->figures, "{\"throughput_per_h\":%d,\"feeds\":[]}", throughput), BF_OK);
    assert_int_equal(buffer_printf(&item->event, "{\"run\":\"%s\",\"t_s\":%d}", id, throughput),
                     BF_OK);
}

void helper_item_fini(store_item *item)
{
    buffer_fini(&item->figures);
    buffer_fini(&item->event);
    buffer_fini(&item->t);
    buffer_fini(&item->values);
    buffer_fini(&item->rho);
    buffer_fini(&item->parts);
}

/// What became of a batch that is waited for.
typedef struct outcome {
    lock lock;
    lock_condition changed;
    bool is_done;
    bf_status status;
    bf_error error;
} outcome;

static void note_outcome(void *context, bf_status status, const bf_error *err)
{
    outcome *o = context;

    lock_acquire(&o->lock);
    o->status = status;
    o->error = *err;
    o->is_done = true;
    lock_wake_all(&o->changed);
    lock_release(&o->lock);
}

bf_status helper_store_append(store *s, const store_batch *batch, bf_error *err)
{
    outcome o = { .is_done = false };

    lock_init(&o.lock);
    lock_condition_init(&o.changed);
    bf_status status = store_begin_append(s, batch, note_outcome, &o, err);
    if (status == BF_OK) {
        lock_acquire(&o.lock);
        while (!o.is_done)
            lock_wait(&o.changed, &o.lock, -1);
        lock_release(&o.lock);
        status = o.status;
        if (status != BF_OK && err != NULL)
            *err = o.error;
    }
    lock_condition_fini(&o.changed);
    lock_fini(&o.lock);
    return status;
}

bf_status helper_append(store *s, const char *id, store_item *item, bf_error *err)
{
    bf_grid grid = helper_grid();
    store_batch batch = {
        .run_id = id,
        .n = 1,
        .items = item,
        .progress = 0.5,
        .eta_s = NAN,
        .wall_s = 1.5,
        .grid = &grid,
    };

    bf_status status = helper_store_append(s, &batch, err);
    helper_item_fini(item);
    return status;
}

void helper_append_samples(store *s, const char *id, uint64_t first, size_t n)
{
    store_item item;
    bf_error err = { 0 };

    helper_curve_item(id, first, n, &item);
    if (helper_append(s, id, &item, &err) != BF_OK)
        fail_msg("%s", err.text);
}

void helper_append_snapshot(store *s, const char *id, uint64_t index)
{
    store_item item;
    bf_error err = { 0 };

    helper_snapshot_item(id, index, &item);
    if (helper_append(s, id, &item, &err) != BF_OK)
        fail_msg("%s", err.text);
}

api_run helper_finish(store *s, const char *id, run_state state)
{
    static const char summary[] = "{\"steps\":4800}";
    store_ending ending = {
        .run_id = id, .state = state, .summary = summary, .n_summary = sizeof summary - 1
    };
    api_run record = { 0 };
    bf_error err = { 0 };

    if (store_finish(s, &ending, &record, &err) != BF_OK)
        fail_msg("%s", err.text);
    return record;
}

static bf_status note_event(void *context, const api_event *event, bf_error *err)
{
    helper_events *events = context;

    assert_true(event->id > events->id);
    assert_int_equal(strlen(event->data), event->n);
    events->n++;
    events->type = event->type;
    events->id = event->id;
    events->data.n = 0;
    if (buffer_append(&events->data, event->data, event->n) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    return BF_OK;
}

helper_events helper_read_events(store *s, const char *id, uint64_t after)
{
    helper_events events = { .id = after };
    char runs[1][API_ID_SIZE];
    bf_error err = { 0 };

    memcpy(runs[0], id, API_ID_SIZE);
    if (store_read_events(s, (const char(*)[API_ID_SIZE])runs, 1, after, SIZE_MAX, note_event,
                          &events, &err) != BF_OK)
        fail_msg("%s", err.text);
    return events;
}

void helper_hear(void *context, const char *run_id)
{
    helper_heard *h = context;

    lock_acquire(&h->lock);
    h->n++;
    memcpy(h->id, run_id, API_ID_SIZE);
    lock_release(&h->lock);
}

double helper_read_metric(const char *name)
{
    bf_buffer text = { 0 };

    assert_int_equal(metrics_write(&text, NULL), BF_OK);
    const char *at = strstr(text.bytes, name);
    assert_non_null(at);
    double value = strtod(at + strlen(name), NULL);
    buffer_fini(&text);
    return value;
}
