#include "api/results/run_json.h"

#include <stdio.h>
#include <time.h>

void run_json_time(json_out *w, const char *key, int64_t unix_ms)
{
    time_t seconds = (time_t)(unix_ms / 1000);
    struct tm tm;
    char text[80];

    json_out_key(w, key);
    if (unix_ms <= 0 || gmtime_r(&seconds, &tm) == NULL) {
        json_out_null(w);
        return;
    }
    snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ", tm.tm_year + 1900,
             tm.tm_mon + 1, tm.tm_mday, tm.tm_hour, tm.tm_min, tm.tm_sec, (int)(unix_ms % 1000));
    json_out_string(w, text);
}

void run_json_error(json_out *w, const bf_error *error)
{
    json_out_key(w, "error");
    if (error->code == BF_OK) {
        json_out_null(w);
        return;
    }
    json_out_object(w);
    json_out_key_string(w, "code", bf_status_word(error->code));
    json_out_key_string(w, "pointer", error->pointer);
    json_out_key_string(w, "detail", error->text);
    json_out_object_end(w);
}

// What there is below a run of a model; cancel is for POST.
static void write_links(json_out *w, const char *id, run_model model)
{
    static const struct {
        const char *key;
        const char *path;
        bool needs_parts;
    } parts[] = {
        { "scenario", "scenario", false },    { "summary", "summary", false },
        { "curve", "curve", false },          { "snapshots", "snapshots", false },
        { "series", "snapshots.pvd", false }, { "parts_series", "parts.pvd", true },
        { "results", "results.zip", false },  { "events", "events", false },
        { "cancel", "cancel", false },
    };
    char url[API_ID_SIZE + 32];

    json_out_key(w, "links");
    json_out_object(w);
    snprintf(url, sizeof url, "/v1/runs/%s", id);
    json_out_key_string(w, "self", url);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (parts[i].needs_parts && model != RUN_MICRO)
            continue;
        snprintf(url, sizeof url, "/v1/runs/%s/%s", id, parts[i].path);
        json_out_key_string(w, parts[i].key, url);
    }
    json_out_object_end(w);
}

void run_json_members(json_out *w, const api_run *record)
{
    json_out_key_string(w, "id", record->id);
    json_out_key_string(w, "status", run_state_word(record->state));
    json_out_key_number(w, "progress", record->progress);
    json_out_key_string(w, "model", run_model_words[record->model]);
    json_out_key_string(w, "label", record->label);
    json_out_key_integer(w, "priority", record->priority);
    json_out_key_string(w, "name", record->name);
    run_json_time(w, "created_at", record->created_ms);
    run_json_time(w, "started_at", record->started_ms);
    run_json_time(w, "finished_at", record->finished_ms);
    json_out_key_number(w, "eta_s", record->eta_s);
    run_json_error(w, &record->error);
    json_out_key_bool(w, "cached", record->is_cached);
    write_links(w, record->id, record->model);
}

bf_status run_json_write(const api_run *record, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    json_out_object(&w);
    run_json_members(&w, record);
    json_out_object_end(&w);
    return json_out_status(&w, err);
}
