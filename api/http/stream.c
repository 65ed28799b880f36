#include "api/http/stream.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <inttypes.h>
#include <string.h>

// One batch, shared with on_event().
typedef struct batch {
    stream_cursor *cursor;
    bf_buffer *out;
    bool is_pending;       // an inline snapshot was begun and waits for its data
    uint64_t snapshot;     // its index
    char run[API_ID_SIZE]; // its run
} batch;

// What a run still has for a client that has seen the events up to after.
typedef enum backlog { BACKLOG_EMPTY, BACKLOG_EVENTS, BACKLOG_ENDED } backlog;

static backlog backlog_of(const api_run *record, uint64_t after)
{
    if (record->last_event > after)
        return BACKLOG_EVENTS;
    return run_state_is_end(record->state) ? BACKLOG_ENDED : BACKLOG_EMPTY;
}

bf_status stream_begin(const api_services *services, stream_format format, bool is_inline,
                       const char (*runs)[API_ID_SIZE], size_t n_runs, uint64_t after,
                       stream_cursor *ret_cursor, bf_error *err)
{
    stream_cursor cursor = { .format = format, .is_inline = is_inline, .n_runs = n_runs };
    uint64_t newest = 0;

    BF_CHECK(n_runs >= 1 && n_runs <= API_STREAM_RUNS_MAX);
    for (size_t i = 0; i < n_runs; i++) {
        api_run record;
        BF_TRY(services->find(services->service, runs[i], &record, err));
        memcpy(cursor.runs[i], runs[i], API_ID_SIZE);
        if (record.last_event > newest)
            newest = record.last_event;
        if (backlog_of(&record, after) != BACKLOG_ENDED)
            cursor.n_open++;
    }
    cursor.after = after < newest ? after : newest;
    *ret_cursor = cursor;
    return BF_OK;
}

static bf_status append_close(stream_format format, bf_buffer *out)
{
    return format == STREAM_SSE ? buffer_append(out, "\n\n", 2) : buffer_append(out, "}\n", 2);
}

// An inline snapshot is left open and stops the reading: its grid is read after read_events() has
// returned, as a read within a read would hold two readers of the store.
static bf_status on_event(void *context, const api_event *event, bf_error *err)
{
    batch *b = context;
    stream_cursor *cursor = b->cursor;
    bool is_left_open = cursor->is_inline && event->type == API_EVENT_SNAPSHOT && event->n > 2;
    size_t n = is_left_open ? event->n - 1 : event->n; // without the last brace
    const char *word = api_event_word(event->type);

    bf_status status =
        cursor->format == STREAM_SSE
            ? buffer_printf(b->out, "id: %" PRIu64 "\nevent: %s\ndata: ", event->id, word)
            : buffer_printf(b->out, "{\"id\":%" PRIu64 ",\"run\":\"%s\",\"event\":\"%s\",\"data\":",
                            event->id, event->run, word);
    if (status == BF_OK)
        status = buffer_append(b->out, event->data, n);
    if (status == BF_OK && !is_left_open)
        status = append_close(cursor->format, b->out);
    if (status != BF_OK)
        return bf_fail_memory(err);
    cursor->after = event->id;
    if (event->type == API_EVENT_END && cursor->n_open > 0)
        cursor->n_open--;
    if (!is_left_open)
        return BF_OK;
    b->is_pending = true;
    b->snapshot = event->snapshot;
    memcpy(b->run, event->run, sizeof b->run);
    return bf_fail(err, BF_EBUSY, "", "a snapshot's grid comes first");
}

static bf_status append_base64(const unsigned char *bytes, size_t n, bf_buffer *out)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t length = (n + 2) / 3 * 4;
    char *to = buffer_reserve(out, length);

    if (to == NULL)
        return BF_ENOMEM;
    for (size_t i = 0; i < n; i += 3, to += 4) {
        unsigned second = i + 1 < n ? bytes[i + 1] : 0;
        unsigned third = i + 2 < n ? bytes[i + 2] : 0;
        unsigned group = (unsigned)bytes[i] << 16 | second << 8 | third;
        to[0] = digits[group >> 18];
        to[1] = digits[group >> 12 & 63];
        to[2] = i + 1 < n ? digits[group >> 6 & 63] : '=';
        to[3] = i + 2 < n ? digits[group & 63] : '=';
    }
    *to = '\0';
    out->n += length;
    return BF_OK;
}

// Appends the member `data` of the pending snapshot and closes its event.
static bf_status append_grid(batch *b, const api_services *services, bf_error *err)
{
    bf_buffer grid_bytes = { 0 };
    api_array of;
    bool is_written = false;

    bf_status status = services->read_array(services->store, b->run, b->snapshot, API_ARRAY_DENSITY,
                                            &of, &grid_bytes, err);
    bool is_missing = status == BF_ENOTFOUND || // the run was removed meanwhile
                      (status == BF_OK && grid_bytes.n > STREAM_INLINE_MAX);
    if (is_missing) {
        status = BF_OK;
        is_written = buffer_append(b->out, ",\"data\":null}", 13) == BF_OK;
    } else if (status == BF_OK) {
        is_written =
            buffer_append(b->out, ",\"data\":\"", 9) == BF_OK &&
            append_base64((const unsigned char *)grid_bytes.bytes, grid_bytes.n, b->out) == BF_OK &&
            buffer_append(b->out, "\"}", 2) == BF_OK;
    }
    buffer_fini(&grid_bytes);
    if (status == BF_OK && (!is_written || append_close(b->cursor->format, b->out) != BF_OK))
        status = bf_fail_memory(err);
    b->is_pending = false;
    return status;
}

static bf_status append_events(batch *b, const api_services *services, size_t limit_bytes,
                               bf_error *err)
{
    stream_cursor *cursor = b->cursor;
    size_t start = b->out->n;
    bool has_stopped;

    do {
        size_t left = limit_bytes - (b->out->n - start);
        bf_status status =
            services->read_events(services->store, (const char(*)[API_ID_SIZE])cursor->runs,
                                  cursor->n_runs, cursor->after, left, on_event, b, err);
        has_stopped = b->is_pending;
        if (has_stopped)
            status = append_grid(b, services, err);
        if (status != BF_OK)
            return status;
    } while (has_stopped && b->out->n - start < limit_bytes);
    return BF_OK;
}

// Counts the open runs again when there are no events: a run may have been removed.
static bf_status count_open(stream_cursor *cursor, const api_services *services,
                            body_state *ret_state, bf_error *err)
{
    bool has_more = false;
    size_t n_open = 0;

    for (size_t i = 0; i < cursor->n_runs; i++) {
        api_run record;
        bf_status status = services->find(services->service, cursor->runs[i], &record, err);
        if (status == BF_ENOTFOUND)
            continue;
        if (status != BF_OK)
            return status;
        backlog left = backlog_of(&record, cursor->after);
        n_open += left != BACKLOG_ENDED;
        has_more = has_more || left == BACKLOG_EVENTS;
    }
    cursor->n_open = n_open;
    *ret_state = n_open == 0 ? BODY_DONE : has_more ? BODY_MORE : BODY_WAIT;
    return BF_OK;
}

static bf_status append_batch(batch *b, const api_services *services, size_t limit_bytes,
                              body_state *ret_state, bf_error *err)
{
    stream_cursor *cursor = b->cursor;
    size_t start = b->out->n, n_open = cursor->n_open;
    uint64_t after = cursor->after;

    if (cursor->format == STREAM_SSE && !cursor->has_begun &&
        buffer_append(b->out, "retry: 3000\n\n", 13) != BF_OK)
        return bf_fail_memory(err);
    cursor->has_begun = true;
    if (cursor->n_open > 0)
        BF_TRY(append_events(b, services, limit_bytes, err));
    // These were all events that there were if some came and they ended below the limit. After the end of a run the others
    // have to be counted again, as they may have been removed.
    const bool has_read_all =
        cursor->after > after && cursor->n_open == n_open && b->out->n - start < limit_bytes;
    if (cursor->n_open > 0 && b->out->n == start)
        return count_open(cursor, services, ret_state, err);
    *ret_state = cursor->n_open == 0 ? BODY_DONE : has_read_all ? BODY_WAIT : BODY_MORE;
    return BF_OK;
}

bf_status stream_next(void *state, const api_services *services, size_t limit_bytes, bf_buffer *out,
                      body_state *ret_state, bf_error *err)
{
    stream_cursor *cursor = state;
    batch b = { .cursor = cursor, .out = out };
    size_t start = out->n, n_open = cursor->n_open;
    uint64_t after = cursor->after;
    bool has_begun = cursor->has_begun;

    BF_CHECK(limit_bytes > 0);
    bf_status status = append_batch(&b, services, limit_bytes, ret_state, err);
    if (status != BF_OK) {
        // What never changes is not written: a transport may compare the ids of runs at the same time.
        cursor->n_open = n_open;
        cursor->after = after;
        cursor->has_begun = has_begun;
        out->n = start;
        if (out->bytes != NULL)
            out->bytes[start] = '\0';
    }
    return status;
}

const char *stream_heartbeat(stream_format format)
{
    return format == STREAM_SSE ? ":\n\n" : "\n";
}

bf_status stream_open(const stream_cursor *cursor, body_source *ret_source, bf_error *err)
{
    stream_cursor *state = memory_alloc(1, sizeof *state);

    if (state == NULL)
        return bf_fail_memory(err);
    *state = *cursor;
    *ret_source = (body_source){ .state = state,
                                 .next_chunk = stream_next,
                                 .destroy = memory_free,
                                 .is_stream = true,
                                 .heartbeat = stream_heartbeat(cursor->format),
                                 .n_runs = cursor->n_runs,
                                 .runs = (const char(*)[API_ID_SIZE])state->runs };
    return BF_OK;
}
