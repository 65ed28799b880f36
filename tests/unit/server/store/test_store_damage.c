// Unit tests of the store: bytes that have changed on the disk are never served (I15).
//
// One byte of each page of a store is changed, page after page. What is read then is what was stored, or an error.

#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_store.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PAGE = 4096, N_SAMPLES = 900 };

/// Everything that a store says, call by call.
typedef struct telling {
    bf_buffer texts[16]; ///< what a call gave; a call that failed gave nothing
    bool is_good[16];    ///< the call succeeded
    size_t n;            ///< calls
} telling;

static bf_buffer *next_text(telling *t, bf_status status)
{
    assert_true(t->n < sizeof t->texts / sizeof *t->texts);
    t->is_good[t->n] = status == BF_OK;
    return &t->texts[t->n++];
}

static void note(bf_buffer *text, const void *bytes, size_t n)
{
    assert_int_equal(buffer_append(text, bytes, n), BF_OK);
}

static void note_run(bf_buffer *text, const api_run *r)
{
    assert_int_equal(
        buffer_printf(text, "%s %d %d %d %s %s %a %lld %lld %lld %llu %llu %llu %d %d %s %s\n",
                      r->id, r->state, r->model, r->priority, r->label, r->name, r->progress,
                      (long long)r->created_ms, (long long)r->started_ms, (long long)r->finished_ms,
                      (unsigned long long)r->n_samples, (unsigned long long)r->n_snapshots,
                      (unsigned long long)r->last_event, r->has_summary, r->is_cached, r->figures,
                      r->error.text),
        BF_OK);
}

static void tell_runs(store *s, const char *id, telling *t)
{
    static api_run_list list;
    const api_list_query query = { .state = -1, .model = -1, .limit = 10 };
    api_run record;

    bf_status status = store_find(s, id, &record, NULL);
    bf_buffer *text = next_text(t, status);
    if (status == BF_OK)
        note_run(text, &record);
    status = store_list(s, &query, &list, NULL);
    text = next_text(t, status);
    for (size_t i = 0; status == BF_OK && i < list.n; i++)
        note_run(text, &list.runs[i]);
}

static void tell_curve(bf_status status, api_curve *curve, telling *t)
{
    bf_buffer *text = next_text(t, status);

    note(text, curve->columns.bytes, curve->columns.n);
    note(text, curve->t.bytes, curve->t.n);
    note(text, curve->values.bytes, curve->values.n);
    api_curve_fini(curve);
}

static void tell_results(store *s, const char *id, telling *t)
{
    api_curve curve = { 0 };
    api_snapshot_list list = { 0 };
    api_array about;

    for (int which = API_TEXT_SCENARIO; which <= API_TEXT_FIGURES; which++) {
        bf_buffer got = { 0 };
        bf_status status = store_read_text(s, id, (api_text)which, &got, NULL);
        bf_buffer *text = next_text(t, status);
        if (status == BF_OK)
            note(text, got.bytes, got.n);
        buffer_fini(&got);
    }
    tell_curve(store_read_curve(s, id, 0, UINT64_MAX, &curve, NULL), &curve, t);
    bf_buffer *text = next_text(t, store_list_snapshots(s, id, &list, NULL));
    note(text, list.items.bytes, list.items.n);
    buffer_fini(&list.items);
    for (uint64_t i = 0; i < 2; i++) {
        bf_buffer rho = { 0 };
        text = next_text(t, store_read_array(s, id, i, API_ARRAY_DENSITY, &about, &rho, NULL));
        note(text, rho.bytes, rho.n);
        buffer_fini(&rho);
    }
}

static bf_status on_event(void *context, const api_event *event, bf_error *err)
{
    assert_int_equal(buffer_printf(context, "%llu %d %llu ", (unsigned long long)event->id,
                                   event->type, (unsigned long long)event->snapshot),
                     BF_OK);
    note(context, event->data, event->n);
    return BF_OK;
}

static void tell_events(store *s, const char *id, telling *t)
{
    bf_buffer events = { 0 };

    bf_status status = store_read_events(s, (const char(*)[API_ID_SIZE])id, 1, 0, SIZE_MAX,
                                         on_event, &events, NULL);
    bf_buffer *text = next_text(t, status);
    if (status == BF_OK)
        note(text, events.bytes, events.n);
    buffer_fini(&events);
}

static void tell_measurement(store *s, const char *id, telling *t)
{
    api_measurement about = { .n_samples = 0 };
    api_curve curve = { 0 };

    bf_status status = store_find_measurement(s, id, &about, NULL);
    bf_buffer *text = next_text(t, status);
    if (status == BF_OK)
        note(text, about.label, strlen(about.label));
    tell_curve(store_read_measurement(s, id, &curve, NULL), &curve, t);
}

static telling tell(store *s, const char *id, const char *measurement)
{
    telling t = { .n = 0 };

    tell_runs(s, id, &t);
    tell_results(s, id, &t);
    tell_events(s, id, &t);
    tell_measurement(s, measurement, &t);
    return t;
}

static void forget(telling *t)
{
    for (size_t i = 0; i < t->n; i++)
        buffer_fini(&t->texts[i]);
}

// Each call gave what it gave before, or failed. Returns how many failed.
static size_t compare(const telling *before, const telling *now, long page)
{
    size_t n_failed = 0;

    assert_int_equal(before->n, now->n);
    for (size_t i = 0; i < now->n; i++) {
        const bf_buffer *a = &before->texts[i], *b = &now->texts[i];
        n_failed += !now->is_good[i];
        if (now->is_good[i] &&
            (a->n != b->n || (a->n > 0 && memcmp(a->bytes, b->bytes, a->n) != 0)))
            fail_msg("with page %ld damaged, call %zu gives something else", page, i);
    }
    return n_failed;
}

static void add_measurement(store *s, char *ret_id)
{
    double t[64], values[64];
    api_measurement about = { .label = "camera", .counter = "upstream", .n_samples = 64 };
    api_curve curve = { .n = 64, .n_columns = 1 };

    for (int i = 0; i < 64; i++) {
        t[i] = i;
        values[i] = 64 - i;
    }
    note(&curve.t, t, sizeof t);
    note(&curve.values, values, sizeof values);
    about.t_end = 63;
    assert_int_equal(store_add_measurement(s, &about, &curve, &(bf_buffer){ 0 }, &about, NULL),
                     BF_OK);
    memcpy(ret_id, about.id, API_ID_SIZE);
    api_curve_fini(&curve);
}

// A run with all that a run has, one that waits, and a measurement.
static void fill_store(store *s, char *ret_id, char *ret_measurement)
{
    api_run record = helper_start(s);
    store_item item;

    for (uint64_t i = 0; i < N_SAMPLES; i += 100)
        helper_append_samples(s, record.id, i, 100);
    helper_append_snapshot(s, record.id, 0);
    helper_append_snapshot(s, record.id, 1);
    helper_figures_item(record.id, 700, &item);
    assert_int_equal(helper_append(s, record.id, &item, NULL), BF_OK);
    helper_finish(s, record.id, RUN_SUCCEEDED);
    helper_submit(s, "waits", 0);
    add_measurement(s, ret_measurement);
    memcpy(ret_id, record.id, API_ID_SIZE);
}

static void flip(int file, off_t at, unsigned char mask)
{
    unsigned char byte;

    assert_int_equal(pread(file, &byte, 1, at), 1);
    byte ^= mask;
    assert_int_equal(pwrite(file, &byte, 1, at), 1);
}

static void what_has_changed_on_the_disk_is_not_served(void **state)
{
    helper_store *h = *state;
    char path[128], id[API_ID_SIZE], measurement[API_ID_SIZE];
    const store_options options = { .directory = h->directory, .queue_limit = 100 };
    size_t n_refused = 0, n_failed = 0;

    srand(1);
    fill_store(h->store, id, measurement);
    telling before = tell(h->store, id, measurement);
    assert_int_equal(compare(&before, &before, -1), 0);
    helper_store_close(h);
    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    int file = open(path, O_RDWR | O_CLOEXEC);
    assert_true(file >= 0);
    const long n_pages = (long)lseek(file, 0, SEEK_END) / PAGE;
    assert_true(n_pages > 100);
    for (long page = 0; page < n_pages; page += HELPER_AMOUNT(1, 5)) {
        const off_t at = page * PAGE + rand() % PAGE;
        const unsigned char mask = (unsigned char)(1 << rand() % 8);
        flip(file, at, mask);
        if (store_open(&options, &h->store, NULL) == BF_OK) {
            telling now = tell(h->store, id, measurement);
            n_failed += compare(&before, &now, page);
            forget(&now);
            helper_store_close(h);
        } else {
            n_refused++;
        }
        flip(file, at, mask);
    }
    close(file);
    // Most pages are of the two snapshots, each of which is read by one call.
    assert_true(n_failed + n_refused > (size_t)n_pages / (2 * HELPER_AMOUNT(1, 5)));
    assert_true(n_refused < (size_t)n_pages / 2);
    helper_store_open(h);
    telling after = tell(h->store, id, measurement);
    assert_int_equal(compare(&before, &after, n_pages), 0);
    forget(&after);
    forget(&before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_has_changed_on_the_disk_is_not_served,
                                        helper_store_setup, helper_store_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
