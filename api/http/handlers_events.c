// Event streams, of one run and of several.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "api/http/stream.h"
#include "api/json/number.h"

// The header counts more: a browser that reconnects sends it, with the URL unchanged.
bf_status handlers__read_last_event(const exchange *x, uint64_t *ret_id, bf_error *err)
{
    const char *last = exchange__header(x, "Last-Event-ID");
    uint64_t id = 0;

    if (last == NULL || *last == '\0')
        id = exchange__whole(x, "last_event_id");
    else if (!number_read_digits(last, 0, UINT64_MAX, &id))
        return bf_fail(err, BF_EINPUT, "", "Last-Event-ID is no event's id: '%.64s'", last);
    *ret_id = id;
    return BF_OK;
}

static bf_status begin_stream(exchange *x, const char (*runs)[API_ID_SIZE], size_t n_runs,
                              bf_error *err)
{
    stream_format format = x->media->format == MEDIA_SSE ? STREAM_SSE : STREAM_NDJSON;
    api_response *response = x->response;
    stream_cursor cursor;
    bool is_inline = exchange__whole(x, "inline") == 1;
    uint64_t after = 0;

    BF_TRY(handlers__read_last_event(x, &after, err));
    BF_TRY(stream_begin(x->services, format, is_inline, runs, n_runs, after, &cursor, err));
    if (cursor.n_open == 0) {
        response->status = 204; // tells a browser not to reconnect
        return BF_OK;
    }
    api_response_header(response, "X-Accel-Buffering", "no");
    return stream_open(&cursor, &response->source, err);
}

bf_status handlers_results_events(exchange *x, bf_error *err)
{
    return begin_stream(x, (const char(*)[API_ID_SIZE])x->named->run.id, 1, err);
}

bf_status handlers_results_events_of_runs(exchange *x, bf_error *err)
{
    char runs[API_STREAM_RUNS_MAX][API_ID_SIZE];
    size_t n = exchange__ids(x, "runs", runs);
    api_run record;

    for (size_t i = 0; i < n; i++)
        BF_TRY(access_find_run(x, runs[i], &record, err));
    return begin_stream(x, (const char(*)[API_ID_SIZE])runs, n, err);
}
