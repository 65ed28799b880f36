#include "tests/unit/server/helper_fake.h"
#include "tests/unit/server/helper_await.h"

#include "core/base/memory.h"
#include "tests/unit/helper_slices.h"

#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void fake_init(fake *f)
{
    *f = (fake){ 0 };
    lock_init(&f->lock);
    lock_condition_init(&f->changed);
}

void fake_fini(fake *f)
{
    lock_condition_fini(&f->changed);
    lock_fini(&f->lock);
}

void fake_append(fake *f, bool is_end)
{
    lock_acquire(&f->lock);
    f->n_events++;
    f->has_ended = is_end;
    lock_release(&f->lock);
}

void fake_hold(fake *f, fake_held held)
{
    lock_acquire(&f->lock);
    f->held = held;
    lock_wake_all(&f->changed);
    lock_release(&f->lock);
}

bool fake_wait_for_held(fake *f, unsigned n)
{
    int64_t deadline_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;

    lock_acquire(&f->lock);
    while (f->n_waiting < n && lock_wait(&f->changed, &f->lock, deadline_ms))
        ;
    bool is_reached = f->n_waiting >= n;
    lock_release(&f->lock);
    return is_reached;
}

static void wait_while_held(fake *f, fake_held which)
{
    lock_acquire(&f->lock);
    f->n_waiting++;
    lock_wake_all(&f->changed);
    while (f->held == which)
        (void)lock_wait(&f->changed, &f->lock, -1);
    f->n_waiting--;
    lock_release(&f->lock);
}

static bf_status find(api_service *service, const char *id, api_run *ret_run, bf_error *err)
{
    fake *f = (void *)service;

    memset(ret_run, 0, sizeof *ret_run);
    (void)snprintf(ret_run->id, sizeof ret_run->id, "%s", id);
    lock_acquire(&f->lock);
    ret_run->last_event = ret_run->revision = f->n_events;
    ret_run->n_snapshots = f->n_snapshots;
    ret_run->predicted_s = (double)NAN;
    ret_run->grid = (bf_grid){ .n1 = FAKE_CELLS, .n2 = 1, .d1 = 1.0, .d2 = 1.0 };
    f->n_finds++;
    ret_run->state = f->has_ended ? RUN_SUCCEEDED : RUN_RUNNING;
    void (*after_look)(void) = f->after_look;
    lock_release(&f->lock);
    if (after_look != NULL)
        after_look();
    return BF_OK;
}

static bf_status read_events(api_store *store, const char (*runs)[API_ID_SIZE], size_t n_runs,
                             uint64_t after, size_t limit_bytes, api_event_fn *on_event,
                             void *context, bf_error *err)
{
    fake *f = (void *)store;
    bf_status status = BF_OK;
    size_t n = 0;

    wait_while_held(f, FAKE_HELD_EVENTS);
    lock_acquire(&f->lock);
    uint64_t n_events = f->n_events;
    bool has_ended = f->has_ended;
    bool is_broken = f->is_broken;
    void (*after_look)(void) = f->after_look;
    f->n_reads++;
    lock_release(&f->lock);
    if (is_broken)
        return bf_fail(err, BF_ESYSTEM, "", "the store failed");
    for (uint64_t id = after + 1; status == BF_OK && id <= n_events && n < limit_bytes; id++) {
        char data[64];
        api_event event = { .id = id, .data = data };
        memcpy(event.run, runs[0], sizeof event.run);
        event.type = has_ended && id == n_events ? API_EVENT_END : API_EVENT_PROGRESS;
        event.n = (size_t)snprintf(data, sizeof data, "{\"k\":%llu}", (unsigned long long)id);
        n += event.n;
        status = on_event(context, &event, err);
    }
    if (after_look != NULL)
        after_look();
    return status;
}

static bf_status read_text(api_store *store, const char *id, api_text which, bf_buffer *out,
                           bf_error *err)
{
    return buffer_append(out, "{}", 2);
}

static bf_status read_curve(api_store *store, const char *id, uint64_t first, uint64_t n_most,
                            api_curve *ret_curve, bf_error *err)
{
    *ret_curve = (api_curve){ .n = 0 };
    return BF_OK;
}

static bf_status list_snapshots(api_store *store, const char *id, api_snapshot_list *ret_list,
                                bf_error *err)
{
    fake *f = (void *)store;
    api_snapshot_list list = { .grid = { .n1 = FAKE_CELLS, .n2 = 1, .d1 = 1.0, .d2 = 1.0 } };

    lock_acquire(&f->lock);
    list.n = (size_t)f->n_snapshots;
    lock_release(&f->lock);
    for (size_t i = 0; i < list.n; i++) {
        api_snapshot item = { .index = i, .t = (double)i };
        assert_int_equal(buffer_append(&list.items, &item, sizeof item), BF_OK);
    }
    *ret_list = list;
    return BF_OK;
}

// Noise does not deflate: an archive of it is as long as what is in it.
static bf_status read_array(api_store *store, const char *id, uint64_t index, api_array_kind kind,
                            api_array *ret_array, bf_buffer *out, bf_error *err)
{
    fake *f = (void *)store;
    uint32_t *cells = (uint32_t *)(void *)buffer_reserve(out, FAKE_CELLS * sizeof *cells);
    uint32_t x = (uint32_t)index;

    wait_while_held(f, FAKE_HELD_SNAPSHOT);
    lock_acquire(&f->lock);
    bool is_broken = f->is_broken;
    f->n_reads++;
    lock_release(&f->lock);
    if (is_broken)
        return bf_fail(err, BF_ESYSTEM, "", "the store failed");
    for (size_t i = 0; i < FAKE_CELLS; i++)
        cells[i] = x = x * 1664525 + 1013904223;
    out->n += FAKE_CELLS * sizeof *cells;
    assert_int_equal(kind, API_ARRAY_DENSITY);
    *ret_array = (api_array){ .snapshot = { .index = index, .t = (double)index },
                              .grid = { .n1 = FAKE_CELLS, .n2 = 1, .d1 = 1.0, .d2 = 1.0 } };
    return BF_OK;
}

static bf_status open_array(api_store *store, const char *id, uint64_t index, api_array_kind kind,
                            api_array *ret_array, api_slices *ret_slices, bf_error *err)
{
    bf_buffer *bytes = memory_alloc(1, sizeof *bytes);

    assert_non_null(bytes);
    return helper_slices_open(read_array(store, id, index, kind, ret_array, bytes, err), bytes,
                              ret_slices);
}

static bf_status metrics(api_service *service, bool with_owners, bf_buffer *out, bf_error *err)
{
    return metrics_write(out, err);
}

static bf_status ready(api_service *service, bf_error *err)
{
    wait_while_held((void *)service, FAKE_HELD_READY);
    return BF_OK;
}

static bool holds(api_service *service, const char *id)
{
    return false;
}

static bool read_speed(api_service *service, prediction_speed *ret_speed)
{
    return false;
}

static bf_status list(api_service *service, const api_list_query *query, api_run_list *ret_list,
                      bf_error *err)
{
    wait_while_held((void *)service, FAKE_HELD_LIST);
    ret_list->n = 0;
    ret_list->has_more = false;
    return BF_OK;
}

static bf_status submit(api_service *service, const api_submission *submission,
                        api_acceptance *ret_acceptance, bf_error *err)
{
    wait_while_held((void *)service, FAKE_HELD_SUBMIT);
    memcpy(ret_acceptance->id, FAKE_RUN, API_ID_SIZE);
    return buffer_printf(&ret_acceptance->answer, "{\"id\":\"%s\"}", FAKE_RUN) == BF_OK
               ? BF_OK
               : bf_fail(err, BF_ENOMEM, "", "out of memory");
}

api_services fake_services(fake *f)
{
    return (api_services){ .store = (void *)f,
                           .service = (void *)f,
                           .find = find,
                           .holds = holds,
                           .read_speed = read_speed,
                           .list = list,
                           .read_text = read_text,
                           .read_curve = read_curve,
                           .list_snapshots = list_snapshots,
                           .read_array = read_array,
                           .open_array = open_array,
                           .read_slice = helper_slices_read,
                           .read_events = read_events,
                           .ready = ready,
                           .submit = submit,
                           .metrics = metrics };
}

http *fake_serve(fake *f, void (*change)(http_options *options))
{
    const api_services services = fake_services(f);
    http_options options = { .listen = "127.0.0.1:0",
                             .services = &services,
                             .hosts = "a",
                             .n_threads = 2,
                             .n_request_threads = 4,
                             .connection_limit = 600,
                             .stream_limit = 500,
                             .download_limit = 16,
                             .wait_limit = 500,
                             .body_limit = 100000,
                             .answer_limit = 100000000,
                             .header_deadline_ms = 10000,
                             .body_deadline_ms = 10000,
                             .heartbeat_ms = 600000 };
    bf_error err = { 0 };
    http *h = NULL;

    if (change != NULL)
        change(&options);
    bf_status status = http_start(&options, &h, &err);
    if (status != BF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(status, BF_OK);
    return h;
}
