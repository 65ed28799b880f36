#include "api/results/events.h"

#include "api/json/json_out.h"
#include "api/results/run_json.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// The end of every event. An event that ran out of memory leaves no part of itself behind.
static bf_status finish(json_out *w, size_t start, bf_error *err)
{
    json_out_object_end(w);
    bf_status status = json_out_status(w, err);
    if (status != BF_OK && w->buffer->bytes != NULL) {
        w->buffer->n = start;
        w->buffer->bytes[start] = '\0';
    }
    return status;
}

static json_out begin(const char *run_id, bf_buffer *out)
{
    json_out w = json_out_to(out);

    json_out_object(&w);
    json_out_key_string(&w, "run", run_id);
    return w;
}

bf_status events_status(const api_run *record, bf_buffer *out, bf_error *err)
{
    size_t start = out->n;
    json_out w = begin(record->id, out);

    run_json_members(&w, record);
    return finish(&w, start, err);
}

bf_status events_progress(const char *run_id, const frame_progress *p, double steps_per_s,
                          bf_buffer *out, bf_error *err)
{
    size_t start = out->n;
    double share = p->n_steps == 0 ? 1.0 : (double)p->step / (double)p->n_steps;
    bool is_known = steps_per_s > 0.0;

    json_out w = begin(run_id, out);
    json_out_key_number(&w, "t_s", p->t);
    json_out_key_number(&w, "progress", fmin(share, 1.0));
    json_out_key_number(&w, "steps_per_s", is_known ? steps_per_s : (double)NAN);
    double left = p->step < p->n_steps ? (double)(p->n_steps - p->step) : 0.0;
    json_out_key_number(&w, "eta_s", is_known ? left / steps_per_s : (double)NAN);
    return finish(&w, start, err);
}

bf_status events_curve(const char *run_id, const frame_curve *c, const char *columns,
                       bf_buffer *out, bf_error *err)
{
    size_t start = out->n;
    char name[SCENE_ID_SIZE];

    json_out w = begin(run_id, out);
    json_out_key_integer(&w, "first", (int64_t)c->first);
    json_out_key(&w, "t_s");
    json_out_numbers(&w, c->t, c->n, 1);
    for (size_t column = 0; column < c->n_columns; column++) {
        bool has_name = api_take_column(&columns, name);
        BF_CHECK(has_name);
        json_out_key(&w, name);
        json_out_numbers(&w, c->values + column, c->n, c->n_columns);
    }
    BF_CHECK(*columns == '\0');
    return finish(&w, start, err);
}

bf_status events_snapshot(const char *run_id, const frame_snapshot *s, bool has_parts,
                          bf_buffer *out, bf_error *err)
{
    size_t start = out->n;
    char url[API_ID_SIZE + 64];

    snprintf(url, sizeof url, "/v1/runs/%s/snapshots/%" PRIu64, run_id, s->index);
    json_out w = begin(run_id, out);
    json_out_key_integer(&w, "n", (int64_t)s->index);
    json_out_key_number(&w, "t_s", s->t);
    json_out_key_number(&w, "peak", s->peak);
    json_out_key_number(&w, "mass", s->mass);
    json_out_key(&w, "shape");
    json_out_array(&w);
    json_out_integer(&w, s->n2);
    json_out_integer(&w, s->n1);
    json_out_array_end(&w);
    json_out_key_string(&w, "url", url);
    if (has_parts) {
        snprintf(url, sizeof url, "/v1/runs/%s/parts/%" PRIu64, run_id, s->index);
        json_out_key_string(&w, "parts_url", url);
    }
    return finish(&w, start, err);
}

bf_status events_end(const api_run *record, bf_buffer *out, bf_error *err)
{
    size_t start = out->n;
    json_out w = begin(record->id, out);

    json_out_key_string(&w, "status", run_state_word(record->state));
    json_out_key_number(&w, "progress", record->progress);
    run_json_time(&w, "finished_at", record->finished_ms);
    json_out_key_integer(&w, "n_samples", (int64_t)record->n_samples);
    json_out_key_integer(&w, "n_snapshots", (int64_t)record->n_snapshots);
    run_json_error(&w, &record->error);
    return finish(&w, start, err);
}
