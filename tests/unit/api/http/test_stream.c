// Event streams: bytes of both forms, cursors, inline snapshots, ends, removed runs.

#include "api/http/stream.h"

#include "core/base/memory.h"
#include "tests/unit/api/helper_services.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

enum { LIMIT = 65536 };

#define ID_1 "0190a0b0-0000-7000-8000-000000000001"
#define ID_2 "0190a0b0-0000-7000-8000-000000000002"

static stream_cursor begin(helper_daemon *d, stream_format format, bool is_inline, size_t n_runs,
                           uint64_t after)
{
    static const char ids[2][API_ID_SIZE] = { ID_1, ID_2 };
    api_services services = helper_services(d);
    stream_cursor cursor = { 0 };

    assert_int_equal(stream_begin(&services, format, is_inline, ids, n_runs, after, &cursor, NULL),
                     BF_OK);
    return cursor;
}

static body_state next(helper_daemon *d, stream_cursor *cursor, size_t limit, bf_buffer *out)
{
    api_services services = helper_services(d);
    body_state where = BODY_WAIT;

    assert_int_equal(stream_next(cursor, &services, limit, out, &where, NULL), BF_OK);
    return where;
}

// Reads until there is nothing at the moment.
static body_state drain(helper_daemon *d, stream_cursor *cursor, size_t limit, bf_buffer *out)
{
    body_state where = BODY_MORE;

    for (int i = 0; i < 100 && where == BODY_MORE; i++)
        where = next(d, cursor, limit, out);
    return where;
}

static void assert_text(bf_buffer *out, const char *expected)
{
    assert_string_equal(out->bytes == NULL ? "" : out->bytes, expected);
    assert_int_equal(out->n, strlen(expected));
    buffer_fini(out);
}

static void server_sent_events_have_id_event_and_data(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_SUCCEEDED);
    bf_buffer out = { 0 };

    helper_add_event(&d, of, API_EVENT_STATUS, "{\"a\":1}");
    helper_add_event(&d, of, API_EVENT_END, "{\"b\":2}");
    stream_cursor cursor = begin(&d, STREAM_SSE, false, 1, 0);
    assert_int_equal(drain(&d, &cursor, LIMIT, &out), BODY_DONE);
    assert_text(&out, "retry: 3000\n\n"
                      "id: 1\nevent: status\ndata: {\"a\":1}\n\n"
                      "id: 2\nevent: end\ndata: {\"b\":2}\n\n");
}

static void ndjson_has_the_same_objects_one_a_line(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_SUCCEEDED);
    bf_buffer out = { 0 };

    helper_add_event(&d, of, API_EVENT_PROGRESS, "{\"a\":1}");
    helper_add_event(&d, of, API_EVENT_END, "{\"b\":2}");
    stream_cursor cursor = begin(&d, STREAM_NDJSON, false, 1, 0);
    assert_int_equal(drain(&d, &cursor, LIMIT, &out), BODY_DONE);
    assert_text(&out, "{\"id\":1,\"run\":\"" ID_1 "\",\"event\":\"progress\",\"data\":{\"a\":1}}\n"
                      "{\"id\":2,\"run\":\"" ID_1 "\",\"event\":\"end\",\"data\":{\"b\":2}}\n");
}

// However small the batches and wherever the client breaks off, it gets every event once.
static void a_client_that_returns_misses_nothing_and_gets_nothing_twice(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_RUNNING);
    bf_buffer whole = { 0 };

    for (int i = 0; i < 5; i++)
        helper_add_event(&d, of, API_EVENT_CURVE, "{\"t_s\":[0.1]}");
    stream_cursor cursor = begin(&d, STREAM_NDJSON, false, 1, 0);
    assert_int_equal(drain(&d, &cursor, LIMIT, &whole), BODY_WAIT);
    for (uint64_t seen = 0; seen <= 5; seen++) {
        bf_buffer out = { 0 };
        stream_cursor first = begin(&d, STREAM_NDJSON, false, 1, 0);
        while (first.after < seen)
            next(&d, &first, 1, &out);
        stream_cursor second = begin(&d, STREAM_NDJSON, false, 1, first.after);
        assert_int_equal(drain(&d, &second, LIMIT, &out), BODY_WAIT);
        assert_text(&out, whole.bytes);
    }
    buffer_fini(&whole);
}

static void a_batch_stays_near_its_limit(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_RUNNING);
    stream_cursor cursor;
    bf_buffer out = { 0 };

    for (int i = 0; i < 3; i++)
        helper_add_event(&d, of, API_EVENT_STATUS, "{\"a\":1}");
    cursor = begin(&d, STREAM_NDJSON, false, 1, 0);
    assert_int_equal(next(&d, &cursor, 1, &out), BODY_MORE);
    assert_int_equal(cursor.after, 1);
    buffer_fini(&out);
}

static void a_stream_waits_for_a_run_that_goes_on(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_RUNNING);
    bf_buffer out = { 0 };

    stream_cursor cursor = begin(&d, STREAM_NDJSON, false, 1, 0);
    assert_int_equal(next(&d, &cursor, LIMIT, &out), BODY_WAIT);
    assert_int_equal(out.n, 0);
    of->record.state = RUN_SUCCEEDED;
    helper_add_event(&d, of, API_EVENT_END, "{}");
    assert_int_equal(next(&d, &cursor, LIMIT, &out), BODY_DONE);
    assert_true(out.n > 0);
    buffer_fini(&out);
}

static void the_preamble_comes_at_once_and_only_once(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    bf_buffer out = { 0 };

    helper_add_run(&d, RUN_RUNNING);
    stream_cursor cursor = begin(&d, STREAM_SSE, false, 1, 0);
    assert_int_equal(next(&d, &cursor, LIMIT, &out), BODY_MORE);
    assert_int_equal(next(&d, &cursor, LIMIT, &out), BODY_WAIT);
    assert_text(&out, "retry: 3000\n\n");
}

static void a_client_that_has_seen_the_end_needs_no_stream(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_SUCCEEDED);

    uint64_t last = helper_add_event(&d, of, API_EVENT_END, "{}");
    assert_int_equal(begin(&d, STREAM_SSE, false, 1, last - 1).n_open, 1);
    assert_int_equal(begin(&d, STREAM_SSE, false, 1, last).n_open, 0);
    assert_int_equal(begin(&d, STREAM_SSE, false, 1, last + 1000).n_open, 0);
}

// The store was lost and ids began again: the client's id is newer than all there are.
static void an_id_from_the_future_does_not_hide_what_comes(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_RUNNING);
    bf_buffer out = { 0 };

    helper_add_event(&d, of, API_EVENT_STATUS, "{}");
    stream_cursor cursor = begin(&d, STREAM_NDJSON, false, 1, 1000);
    assert_int_equal(cursor.after, 1);
    helper_add_event(&d, of, API_EVENT_STATUS, "{}");
    assert_int_equal(next(&d, &cursor, LIMIT, &out), BODY_WAIT);
    buffer_fini(&out);
}

static void several_runs_share_a_stream_that_ends_with_the_last_of_them(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *one = helper_add_run(&d, RUN_RUNNING), *two = helper_add_run(&d, RUN_RUNNING);
    bf_buffer out = { 0 };

    helper_add_event(&d, two, API_EVENT_STATUS, "{}");
    helper_add_event(&d, one, API_EVENT_END, "{}");
    one->record.state = RUN_SUCCEEDED;
    stream_cursor cursor = begin(&d, STREAM_NDJSON, false, 2, 0);
    assert_int_equal(drain(&d, &cursor, LIMIT, &out), BODY_WAIT);
    assert_int_equal(cursor.n_open, 1);
    helper_add_event(&d, two, API_EVENT_END, "{}");
    two->record.state = RUN_CANCELLED;
    assert_int_equal(drain(&d, &cursor, LIMIT, &out), BODY_DONE);
    assert_text(&out, "{\"id\":1,\"run\":\"" ID_2 "\",\"event\":\"status\",\"data\":{}}\n"
                      "{\"id\":2,\"run\":\"" ID_1 "\",\"event\":\"end\",\"data\":{}}\n"
                      "{\"id\":3,\"run\":\"" ID_2 "\",\"event\":\"end\",\"data\":{}}\n");
}

static void a_removed_run_ends_its_streams(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_RUNNING);
    api_services services = helper_services(&d);
    bf_buffer out = { 0 };

    helper_add_event(&d, of, API_EVENT_STATUS, "{}");
    stream_cursor cursor = begin(&d, STREAM_NDJSON, false, 1, 0);
    assert_int_equal(drain(&d, &cursor, LIMIT, &out), BODY_WAIT);
    assert_int_equal(services.remove(services.service, ID_1, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(next(&d, &cursor, LIMIT, &out), BODY_DONE);
    buffer_fini(&out);
}

static void a_stream_of_an_unknown_run_does_not_begin(void **state)
{
    static const char ids[1][API_ID_SIZE] = { ID_1 };
    helper_daemon d = { .n_runs = 0 };
    api_services services = helper_services(&d);
    stream_cursor cursor = { .n_runs = 99 };

    assert_int_equal(stream_begin(&services, STREAM_SSE, false, ids, 1, 0, &cursor, NULL),
                     BF_ENOTFOUND);
    assert_int_equal(cursor.n_runs, 99);
}

// float 0, 1, 2, 3, 4, 5 little-endian: 00000000 0000803f 00000040 00004040 00008040 0000a040;
// the base64 of these 24 bytes has no padding.
static void an_inline_snapshot_carries_its_grid(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    helper_run *of = helper_add_run(&d, RUN_SUCCEEDED);
    bf_buffer out = { 0 };

    helper_add_event(&d, of, API_EVENT_SNAPSHOT, "{\"n\":0}");
    helper_add_event(&d, of, API_EVENT_END, "{}");
    stream_cursor cursor = begin(&d, STREAM_SSE, true, 1, 0);
    assert_int_equal(drain(&d, &cursor, LIMIT, &out), BODY_DONE);
    assert_text(&out, "retry: 3000\n\n"
                      "id: 1\nevent: snapshot\ndata: "
                      "{\"n\":0,\"data\":\"AAAAAAAAgD8AAABAAABAQAAAgEAAAKBA\"}\n\n"
                      "id: 2\nevent: end\ndata: {}\n\n");
}

// How a snapshot without a grid, one with 1 byte, ... is answered by a service of our own.
static size_t n_grid_bytes;

static bf_status read_odd_snapshot(api_store *store, const char *run_id, uint64_t index,
                                   api_array_kind kind, api_array *ret_array, bf_buffer *out,
                                   bf_error *err)
{
    assert_int_equal(kind, API_ARRAY_DENSITY);
    *ret_array = (api_array){ 0 };
    char *bytes = buffer_reserve(out, n_grid_bytes);
    if (bytes == NULL)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    memset(bytes, 'f', n_grid_bytes);
    out->n += n_grid_bytes;
    return BF_OK;
}

static void stream_odd_snapshot(size_t n, bf_buffer *out)
{
    helper_daemon d = { .n_runs = 0 };
    api_services services = helper_services(&d);
    body_state where;

    n_grid_bytes = n;
    services.read_array = read_odd_snapshot;
    helper_add_event(&d, helper_add_run(&d, RUN_RUNNING), API_EVENT_SNAPSHOT, "{\"n\":0}");
    stream_cursor cursor = begin(&d, STREAM_NDJSON, true, 1, 0);
    assert_int_equal(stream_next(&cursor, &services, LIMIT, out, &where, NULL), BF_OK);
    assert_int_equal(where, out->n < LIMIT ? BODY_WAIT : BODY_MORE);
}

// RFC 4648, section 10, has "f" to "foo"; ours are of 'f' only: 66 66 66 is 011001 100110 011001 100110.
static void base64_is_padded_as_the_rfc_says(void **state)
{
    static const char *const expected[] = { "", "Zg==", "ZmY=", "ZmZm", "ZmZmZg==" };

    for (size_t n = 0; n < 5; n++) {
        bf_buffer out = { 0 };
        char text[160];
        stream_odd_snapshot(n, &out);
        snprintf(text, sizeof text,
                 "{\"id\":1,\"run\":\"" ID_1 "\",\"event\":\"snapshot\",\"data\":"
                 "{\"n\":0,\"data\":\"%s\"}}\n",
                 expected[n]);
        assert_text(&out, text);
    }
}

static void a_grid_beyond_the_limit_is_left_to_its_url(void **state)
{
    bf_buffer out = { 0 };

    stream_odd_snapshot(STREAM_INLINE_MAX, &out);
    assert_true(out.n > STREAM_INLINE_MAX);
    buffer_fini(&out);
    stream_odd_snapshot(STREAM_INLINE_MAX + 1, &out);
    assert_non_null(strstr(out.bytes, "{\"n\":0,\"data\":null}}\n"));
    buffer_fini(&out);
}

// Whatever allocation fails, the stream is where it was and gives the same bytes when asked again.
static void out_of_memory_loses_no_event(void **state)
{
    helper_daemon d = { .n_runs = 0 };
    api_services services = helper_services(&d);
    helper_run *of = helper_add_run(&d, RUN_SUCCEEDED);
    bf_buffer whole = { 0 };
    size_t n_faults = 1;

    helper_add_event(&d, of, API_EVENT_SNAPSHOT, "{\"n\":0}");
    helper_add_event(&d, of, API_EVENT_END, "{}");
    stream_cursor cursor = begin(&d, STREAM_SSE, true, 1, 0);
    assert_int_equal(drain(&d, &cursor, LIMIT, &whole), BODY_DONE);
    for (size_t n = 1; n_faults > 0; n++) {
        bf_buffer out = { 0 };
        body_state where = BODY_WAIT;
        cursor = begin(&d, STREAM_SSE, true, 1, 0);
        memory_plan_fault(n, 0);
        bf_status status = stream_next(&cursor, &services, LIMIT, &out, &where, NULL);
        n_faults = memory_faults();
        memory_plan_fault(0, 0);
        assert_int_equal(status, n_faults > 0 ? BF_ENOMEM : BF_OK);
        if (n_faults > 0)
            assert_int_equal(out.n, 0);
        if (n_faults > 0)
            assert_int_equal(drain(&d, &cursor, LIMIT, &out), BODY_DONE);
        assert_text(&out, whole.bytes);
    }
    buffer_fini(&whole);
}

static void heartbeats_are_no_events(void **state)
{
    assert_int_equal(stream_heartbeat(STREAM_SSE)[0], ':');
    assert_string_equal(stream_heartbeat(STREAM_NDJSON), "\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(server_sent_events_have_id_event_and_data),
        cmocka_unit_test(ndjson_has_the_same_objects_one_a_line),
        cmocka_unit_test(a_client_that_returns_misses_nothing_and_gets_nothing_twice),
        cmocka_unit_test(a_batch_stays_near_its_limit),
        cmocka_unit_test(a_stream_waits_for_a_run_that_goes_on),
        cmocka_unit_test(the_preamble_comes_at_once_and_only_once),
        cmocka_unit_test(a_client_that_has_seen_the_end_needs_no_stream),
        cmocka_unit_test(an_id_from_the_future_does_not_hide_what_comes),
        cmocka_unit_test(several_runs_share_a_stream_that_ends_with_the_last_of_them),
        cmocka_unit_test(a_removed_run_ends_its_streams),
        cmocka_unit_test(a_stream_of_an_unknown_run_does_not_begin),
        cmocka_unit_test(an_inline_snapshot_carries_its_grid),
        cmocka_unit_test(base64_is_padded_as_the_rfc_says),
        cmocka_unit_test(a_grid_beyond_the_limit_is_left_to_its_url),
        cmocka_unit_test(out_of_memory_loses_no_event),
        cmocka_unit_test(heartbeats_are_no_events),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
