#include "api/http/study_stream.h"

#include "api/study/study_json.h"
#include "core/base/memory.h"

#include <inttypes.h>
#include <string.h>

enum { PAGE = 64 }; // trials that are read at once

bool study_stream_begin(study_stream *stream, const api_study *about)
{
    const bool has_end = api_study_state_is_end(about->state);
    const uint64_t newest = api_study_ended(about) + (has_end ? 1 : 0);

    memcpy(stream->id, about->id, sizeof stream->id);
    if (stream->after > newest)
        stream->after = newest;
    return !has_end || stream->after < newest;
}

// id 0: the event has none.
static bf_status append_object(const study_stream *s, uint64_t id, const char *word,
                               const member_table *table, const void *item, bf_buffer *out,
                               bf_error *err)
{
    const bool is_sse = s->format == STREAM_SSE;
    json_out w = json_out_to(out);

    bf_status status = buffer_printf(out, "%s", is_sse ? "" : "{");
    if (status == BF_OK && id > 0)
        status = buffer_printf(out, is_sse ? "id: %" PRIu64 "\n" : "\"id\":%" PRIu64 ",", id);
    if (status == BF_OK)
        status =
            is_sse ? buffer_printf(out, "event: %s\ndata: ", word)
                   : buffer_printf(out, "\"study\":\"%s\",\"event\":\"%s\",\"data\":", s->id, word);
    w.has_failed = status != BF_OK;
    members_write(&w, table, item);
    w.has_failed = w.has_failed || buffer_printf(out, "%s", is_sse ? "\n\n" : "}\n") != BF_OK;
    return json_out_status(&w, err);
}

// A batch.
typedef struct batch {
    study_stream *stream;
    bf_buffer *out;
} batch;

static bf_status append_trial(void *context, const api_trial *trial, bf_error *err)
{
    const batch *b = context;
    const study_trial_item item = { .columns = &b->stream->columns, .trial = *trial };

    BF_TRY(
        append_object(b->stream, trial->ended, "trial", &study_trial_members, &item, b->out, err));
    b->stream->after = trial->ended;
    return BF_OK;
}

// Trials that ended after the study was found come, too: they wake the stream again, and their places are past.
static bf_status append_trials(study_stream *s, const api_services *services, uint64_t n_ended,
                               size_t limit_bytes, bf_buffer *out, bf_error *err)
{
    batch b = { .stream = s, .out = out };
    const size_t start = out->n;
    bf_status status = BF_OK;

    while (status == BF_OK && s->after < n_ended && out->n - start < limit_bytes) {
        const uint64_t before = s->after;
        const api_trial_query wanted = { .order = API_TRIALS_BY_END,
                                         .from = before + 1,
                                         .limit = PAGE };
        status = services->read_trials(services->store, s->id, &wanted, append_trial, &b, err);
        if (s->after == before)
            break; // the study was removed
    }
    return status;
}

static bf_status append_batch(study_stream *s, const api_services *services, const api_study *about,
                              size_t limit_bytes, bf_buffer *out, body_state *ret_state,
                              bf_error *err)
{
    const uint64_t n_ended = api_study_ended(about);
    const bool has_end = api_study_state_is_end(about->state);
    bf_status status = BF_OK;

    if (about->revision != s->revision)
        status = append_object(s, 0, "status", &study_json, about, out, err);
    s->revision = about->revision;
    if (status == BF_OK)
        status = append_trials(s, services, n_ended, limit_bytes, out, err);
    *ret_state = s->after < n_ended ? BODY_MORE : has_end ? BODY_DONE : BODY_WAIT;
    if (status == BF_OK && *ret_state == BODY_DONE)
        status = append_object(s, n_ended + 1, "end", &study_json, about, out, err);
    return status;
}

// A study that was removed has ended.
static bf_status next_chunk(void *state, const api_services *services, size_t limit_bytes,
                            bf_buffer *out, body_state *ret_state, bf_error *err)
{
    study_stream *s = state;
    api_study about;

    if (!s->has_begun && s->format == STREAM_SSE && buffer_printf(out, "retry: 3000\n\n") != BF_OK)
        return bf_fail_memory(err);
    s->has_begun = true;
    const bf_status status = services->find_study(services->store, s->id, &about, err);
    *ret_state = BODY_DONE;
    if (status == BF_ENOTFOUND)
        return BF_OK;
    return status == BF_OK ? append_batch(s, services, &about, limit_bytes, out, ret_state, err)
                           : status;
}

bf_status study_stream_open(const study_stream *stream, body_source *ret_source, bf_error *err)
{
    study_stream *state = memory_alloc(1, sizeof *state);

    if (state == NULL)
        return bf_fail_memory(err);
    *state = *stream;
    *ret_source = (body_source){ .state = state,
                                 .next_chunk = next_chunk,
                                 .destroy = memory_free,
                                 .is_stream = true,
                                 .heartbeat = stream_heartbeat(stream->format),
                                 .n_runs = 1,
                                 .runs = (const char(*)[API_ID_SIZE])state->id };
    return BF_OK;
}
