// Event streams: the handler finds where the client stands; the transport pulls the bytes.

#include "api/http/exchange_priv.h"
#include "api/http/handlers.h"
#include "api/http/stream.h"

static bf_status read_flag(const exchange *x, const char *name, bool *ret_value, bf_error *err)
{
    uint64_t value = 0;

    bf_status status = query_number(&x->query, name, 0, 1, &value, err);
    if (status == BF_OK)
        *ret_value = value == 1;
    return status;
}

// A browser that reconnects sends the header; the address that it was given stays as it was.
static bf_status read_last_event(exchange *x, uint64_t *ret_id, bf_error *err)
{
    const char *last = exchange__header(x, "Last-Event-ID");
    uint64_t id = 0;

    if (last == NULL || *last == '\0')
        return query_number(&x->query, "last_event_id", 0, UINT64_MAX, ret_id, err);
    if (query_read_number(last, &id) != 0)
        return exchange__refuse(x, 400, err, "Last-Event-ID is no event's id: '%.64s'", last);
    *ret_id = id;
    return BF_OK;
}

static bf_status begin_stream(exchange *x, char (*runs)[API_ID_SIZE], size_t n_runs, bf_error *err)
{
    stream_format format = x->media->format == MEDIA_SSE ? STREAM_SSE : STREAM_NDJSON;
    api_response *response = x->response;
    stream_cursor cursor;
    uint64_t after = 0;
    bool is_inline = false;

    bf_status status = read_flag(x, "inline", &is_inline, err);
    if (status == BF_OK)
        status = read_last_event(x, &after, err);
    if (status == BF_OK)
        status = stream_begin(x->services, format, is_inline, (const char(*)[API_ID_SIZE])runs,
                              n_runs, after, &cursor, err);
    if (status != BF_OK)
        return status;
    if (cursor.n_open == 0) {
        response->status = 204; // tells a browser not to come back
        return BF_OK;
    }
    api_response_header(response, "X-Accel-Buffering", "no");
    return stream_open(&cursor, &response->source, err);
}

bf_status handlers_events_of_run(exchange *x, bf_error *err)
{
    api_run record;

    bf_status status = exchange__find_run(x, &record, err);
    if (status == BF_OK)
        status = begin_stream(x, &record.id, 1, err);
    return status;
}

bf_status handlers_events_of_runs(exchange *x, bf_error *err)
{
    char runs[API_STREAM_RUNS_MAX][API_ID_SIZE];
    size_t n = 0;

    bf_status status = exchange__read_ids(x, "runs", API_STREAM_RUNS_MAX, runs, &n, err);
    if (status == BF_OK)
        status = begin_stream(x, runs, n, err);
    return status;
}
