// The table of routes: one row each, with all that is known of it. Parameters that several routes have
// are written once.

#include "api/http/http_priv.h"
#include "api/http/routes.h"
#include "api/results/colormap.h"
#include "api/results/picture.h"

#include <string.h>

#define TEXT_OF(macro)   TEXT_OF_IT(macro)
#define TEXT_OF_IT(text) #text

static bool is_state(const char *text)
{
    return run_state_find(text) != RUN_STATE_COUNT;
}

static bool is_model(const char *text)
{
    int model = 0;

    while (model < RUN_MODEL_COUNT && strcmp(run_model_words[model], text) != 0)
        model++;
    return model < RUN_MODEL_COUNT;
}

static bool is_measured_kind(const char *text)
{
    int kind = 0;

    while (kind < API_MEASURED_COUNT && strcmp(api_measured_words[kind], text) != 0)
        kind++;
    return kind < API_MEASURED_COUNT;
}

static bool is_colormap(const char *text)
{
    return colormap_find(text) != NULL;
}

static const param run_id = {
    .name = "id", .in = "path", .kind = &param_id, .is_required = true, .help = "Which run"
};

static const param measurement_id = {
    .name = "id", .in = "path", .kind = &param_id, .is_required = true, .help = "Which measurement"
};

static const param snapshot_n = { .name = "n",
                                  .in = "path",
                                  .kind = &param_whole,
                                  .type = "#Count",
                                  .most = UINT64_MAX,
                                  .is_required = true,
                                  .help = "Which snapshot, from 0" };

static const param example_name = { .name = "name",
                                    .in = "path",
                                    .kind = &param_text,
                                    .limits = "\"pattern\":\"^[a-z0-9-]+$\"",
                                    .is_required = true,
                                    .help = "Which ready scenario" };

static const param compared_a = {
    .name = "a",
    .in = "query",
    .kind = &param_id,
    .help = "The first of two runs or measurements, and the reference; with b, without `runs`"
};

static const param compared_b = {
    .name = "b", .in = "query", .kind = &param_id, .help = "The second of them"
};

static const param compared_runs = {
    .name = "runs",
    .in = "query",
    .kind = &param_ids,
    .least = 2,
    .most = API_COMPARE_MAX,
    .help = "Which runs and measurements, with commas between; without a and b"
};

static const param reference = {
    .name = "reference",
    .in = "query",
    .kind = &param_text,
    .type = "#Id",
    .help = "Which of `runs` the others are compared with; the first one if missing"
};

static const param column = { .name = "column",
                              .in = "query",
                              .kind = &param_text,
                              .type = "#ColumnName",
                              .help = "Which column of the curves is compared; the first one of "
                                      "the reference that all have if missing" };

static const param csv_label = { .name = "label",
                                 .in = "query",
                                 .kind = &param_member,
                                 .most = API_LABEL_SIZE - 1,
                                 .help = "Of CSV: the label of the measurement" };

static const param csv_counter = {
    .name = "counter",
    .in = "query",
    .kind = &param_member,
    .type = "#CounterId",
    .help = "Of CSV: which column of a curve was measured; the name of its own if missing"
};

static const param csv_kind = { .name = "kind",
                                .in = "query",
                                .kind = &param_word,
                                .type = "#MeasuredKind",
                                .is_word = is_measured_kind,
                                .help =
                                    "Of CSV: a curve to compare with, or for feeds a profile or "
                                    "a schedule, their list of arrivals; a curve if missing" };

static const param run_status = { .name = "status",
                                  .in = "query",
                                  .kind = &param_word,
                                  .type = "#RunStatus",
                                  .is_word = is_state,
                                  .help = "Only runs in this state" };

static const param run_model_word = { .name = "model",
                                      .in = "query",
                                      .kind = &param_word,
                                      .type = "#Model",
                                      .is_word = is_model,
                                      .help = "Only runs of this model" };

static const param run_label = { .name = "label",
                                 .in = "query",
                                 .kind = &param_text,
                                 .most = API_LABEL_SIZE - 1,
                                 .help = "Only runs with this label" };

static const param measurement_label = { .name = "label",
                                         .in = "query",
                                         .kind = &param_text,
                                         .most = API_LABEL_SIZE - 1,
                                         .help = "Only measurements with this label" };

static const param page_limit = { .name = "limit",
                                  .in = "query",
                                  .kind = &param_whole,
                                  .default_text = "50",
                                  .least = 1,
                                  .most = API_LIST_MAX,
                                  .help = "Items on a page" };

static const param page_cursor = { .name = "cursor",
                                   .in = "query",
                                   .kind = &param_cursor,
                                   .help = "Where the page begins; take it from the `next` link" };

static const param wait_s = { .name = "wait",
                              .in = "query",
                              .kind = &param_whole,
                              .default_text = "0",
                              .most = API_WAIT_MAX_S,
                              .help = "Answer when the run has ended, or with If-None-Match when "
                                      "it is another, at the latest after so many seconds [s]" };

static const param format = { .name = "format",
                              .in = "query",
                              .kind = &param_format,
                              .help =
                                  "The format, in preference to what the Accept header asks for" };

static const param picture_width = { .name = "width",
                                     .in = "query",
                                     .kind = &param_whole,
                                     .least = 1,
                                     .most = PICTURE_WIDTH_MAX,
                                     .help = "Of png: its width in pixels; some 1000 if missing" };

static const param picture_colormap = { .name = "colormap",
                                        .in = "query",
                                        .kind = &param_word,
                                        .type = "#Colormap",
                                        .is_word = is_colormap,
                                        .list_words = colormap_words,
                                        .help = "Of png: its colours" };

static const param picture_max = {
    .name = "max",
    .in = "query",
    .kind = &param_real,
    .default_text = TEXT_OF(PICTURE_TOP),
    .least_real = 1e-3,
    .most_real = 1e3,
    .help = "Of png: the density at the end of the scale; 1 is close packing"
};

static const param with_vtk = { .name = "vtk",
                                .in = "query",
                                .kind = &param_flag,
                                .default_text = "0",
                                .most = 1,
                                .help = "1: with files for ParaView beside the others" };

static const param followed_runs = { .name = "runs",
                                     .in = "query",
                                     .kind = &param_ids,
                                     .least = 1,
                                     .most = API_STREAM_RUNS_MAX,
                                     .is_required = true,
                                     .help = "Which runs, with commas between" };

static const param inline_grids = { .name = "inline",
                                    .in = "query",
                                    .kind = &param_flag,
                                    .default_text = "0",
                                    .most = 1,
                                    .help = "1: snapshot events contain the grid, as `data`" };

static const param last_event_id = {
    .name = "last_event_id",
    .in = "query",
    .kind = &param_whole,
    .type = "#Count",
    .default_text = "0",
    .most = UINT64_MAX,
    .help = "Only events after the one with this id; the header Last-Event-ID counts more"
};

static const param idempotency_key = {
    .name = "Idempotency-Key",
    .in = "header",
    .kind = &param_text,
    .limits = "\"minLength\":1",
    .help = "Any text: a request with the same key and body gets the first answer again"
};

static const param if_match = { .name = "If-Match",
                                .in = "header",
                                .kind = &param_text,
                                .help = "The ETag that the resource must still have" };

static const param if_none_match = {
    .name = "If-None-Match",
    .in = "header",
    .kind = &param_text,
    .help = "The ETag of an answer before; 304 if nothing has changed since"
};

static const param if_range = { .name = "If-Range",
                                .in = "header",
                                .kind = &param_text,
                                .help = "The ETag that the bytes asked for must still belong to" };

static const param last_event_id_header = {
    .name = "Last-Event-ID",
    .in = "header",
    .kind = &param_whole,
    .type = "#Count",
    .help = "Only events after the one with this id; browsers send it by themselves"
};

static const param prefer = {
    .name = "Prefer",
    .in = "header",
    .kind = &param_text,
    .limits = "\"examples\":[\"wait=30\"]",
    .help = "`wait=N`: answer when the run has ended, at the latest after N seconds, 60 at most [s]"
};

static const param range = { .name = "Range",
                             .in = "header",
                             .kind = &param_text,
                             .limits = "\"examples\":[\"bytes=0-1023\"]",
                             .help = "Which bytes of a binary body" };

#define PARAMS(...)                                                                                \
    (const param *const[])                                                                         \
    {                                                                                              \
        __VA_ARGS__, NULL                                                                          \
    }
#define NO_PARAMS                                                                                  \
    (const param *const[])                                                                         \
    {                                                                                              \
        NULL                                                                                       \
    }

#define CACHED "ETag Cache-Control"
#define UNCHANGED                                                                                  \
    {                                                                                              \
        304, NULL, CACHED, "Nothing has changed since the ETag in If-None-Match", NULL             \
    }

// Of a body in one of the formats that are not text.
#define PART(binary)                                                                               \
    {                                                                                              \
        206, NULL, CACHED " Accept-Ranges Content-Range Content-Disposition",                      \
            "The bytes that Range asked for", (binary)                                             \
    }

static const route table[] = {
    { .method = "POST",
      .path = "/v1/runs",
      .handle = handlers_runs_submit,
      .cost = API_COST_WORK,
      .scope = ROUTE_WRITE,
      .formats = "json",
      .params = PARAMS(&idempotency_key, &prefer),
      .id = "submitRun",
      .tag = "Runs",
      .summary = "Accept a run; it is on disk before the answer is sent",
      .help = "The whole scenario is checked first: every fault that can be found is reported with "
              "its place. A 201 means that the run is on disk and will be solved, even if the "
              "daemon is restarted meanwhile. With `Prefer: wait=N` the answer comes when the run "
              "has ended. If the same scenario was solved before, the run ends at once with those "
              "results (`cached`), unless `fresh` is given. With Idempotency-Key a request can be "
              "repeated safely: the same key with another body is a 422. 429 means that the "
              "client's quota of queued runs is used up, 503 that the queue is full.",
      .body = "Submission",
      .refusals = "403 409 413 415 422",
      .answers = { { 201, "Run",
                     "Location ETag Cache-Control Preference-Applied Idempotent-Replayed",
                     "The run was accepted" } } },
    { .method = "GET",
      .path = "/v1/runs",
      .handle = handlers_runs_list,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&run_status, &run_model_word, &run_label, &page_limit, &page_cursor,
                       &if_match, &if_none_match),
      .id = "listRuns",
      .tag = "Runs",
      .summary = "List runs, newest first",
      .help = "Filters narrow the list; the `next` link, where there is one, leads to older runs.",
      .refusals = "412",
      .answers = { { 200, "RunList", CACHED " Link", "A page of runs" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}",
      .handle = handlers_runs_show,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&run_id, &wait_s, &if_match, &if_none_match),
      .id = "getRun",
      .tag = "Runs",
      .summary = "Show a run: state, progress, times, links",
      .help = "The ETag changes with every change of the run. To follow a run, use its events "
              "rather than polling.",
      .refusals = "404 412",
      .answers = { { 200, "Run", CACHED, "The run" }, UNCHANGED } },
    { .method = "DELETE",
      .path = "/v1/runs/{id}",
      .handle = handlers_runs_remove,
      .cost = API_COST_STORE,
      .scope = ROUTE_WRITE,
      .formats = "json",
      .params = PARAMS(&run_id, &if_match),
      .id = "deleteRun",
      .tag = "Runs",
      .summary = "Stop a run if need be and remove it with its results",
      .help = "A run that is being solved is stopped first. This cannot be undone.",
      .refusals = "403 404 412",
      .answers = { { 204, NULL, "Cache-Control", "The run was removed" } } },
    { .method = "POST",
      .path = "/v1/runs/{id}/cancel",
      .handle = handlers_runs_cancel,
      .cost = API_COST_STORE,
      .scope = ROUTE_WRITE,
      .formats = "json",
      .params = PARAMS(&run_id, &if_match),
      .id = "cancelRun",
      .tag = "Runs",
      .summary = "Stop a run and keep its results so far",
      .help = "The results so far are kept and can be read.",
      .refusals = "403 404 409 412",
      .answers = { { 200, "Run", "Cache-Control", "The run had not started and is cancelled" },
                   { 202, "Run", "Cache-Control", "The run will stop shortly" } } },
    { .method = "GET",
      .path = "/v1/runs/{id}/scenario",
      .handle = handlers_results_scenario,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&run_id, &if_match, &if_none_match),
      .id = "getScenario",
      .tag = "Results",
      .summary = "The resolved scenario, every default filled in",
      .help = "Submitted again it gives the same results, byte by byte.",
      .refusals = "404 412",
      .answers = { { 200, "ResolvedScenario", CACHED, "The scenario" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/summary",
      .handle = handlers_results_summary,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&run_id, &if_match, &if_none_match),
      .id = "getSummary",
      .tag = "Results",
      .summary = "The figures of a run that has ended",
      .help = "409 before the run has ended.",
      .refusals = "404 409 412",
      .answers = { { 200, "Summary", CACHED, "The figures" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/curve",
      .handle = handlers_results_curve,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json csv",
      .params = PARAMS(&run_id, &format, &if_match, &if_none_match),
      .id = "getCurve",
      .tag = "Results",
      .summary = "The outflow curve so far",
      .help = "U(t) of the paper: how many parts are inside each counter at each time. As CSV the "
              "header is `t_s`, the counters' ids and `left_domain`.",
      .refusals = "404 412",
      .answers = { { 200, "Curve", CACHED, "The curve" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/photo_eyes",
      .handle = handlers_results_photo_eyes,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json csv",
      .params = PARAMS(&run_id, &format, &if_match, &if_none_match),
      .id = "getPhotoEyes",
      .tag = "Results",
      .summary = "Changes of photo eyes and their actions so far",
      .help = "Both lists by rising time, empty for a run without photo eyes. As CSV the changes "
              "alone, as photo_eyes.csv. A run keeps the first 100,000 of both together; `is_cut` "
              "says when there are so many.",
      .refusals = "404 412",
      .answers = { { 200, "PhotoEyes", CACHED, "The changes and actions" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/key_figures",
      .handle = handlers_results_figures,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json csv",
      .params = PARAMS(&run_id, &format, &if_match, &if_none_match),
      .id = "getKeyFigures",
      .tag = "Results",
      .summary = "The key figures so far",
      .help =
          "Throughput, residence, queues, jams, gaps; at the end those of the summary. As CSV the "
          "header is `figure,of,id,value,unit`. 409 while there are none.",
      .refusals = "404 409 412",
      .answers = { { 200, "KeyFigures", CACHED, "The key figures" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/snapshots",
      .handle = handlers_results_snapshots,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&run_id, &if_match, &if_none_match),
      .id = "listSnapshots",
      .tag = "Results",
      .summary = "List the density snapshots so far",
      .help = "Their times, largest densities and addresses, and their common grid.",
      .refusals = "404 412",
      .answers = { { 200, "SnapshotList", CACHED, "The list" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/snapshots/{n}",
      .handle = handlers_results_snapshot,
      .cost = API_COST_STORE,
      .text_cost = API_COST_WORK,
      .scope = ROUTE_READ,
      .formats = "npy json csv png vti",
      .params = PARAMS(&run_id, &snapshot_n, &format, &picture_width, &picture_colormap,
                       &picture_max, &if_match, &if_none_match, &range, &if_range),
      .id = "getSnapshot",
      .tag = "Results",
      .summary = "One density snapshot",
      .help = "Density on the grid, rows along y; 1 is close packing. A microscopic run has its "
              "parts as a density on the same grid. A snapshot never changes and may be cached "
              "without limit. 406 if the grid is too large for the format.",
      .refusals = "404 412 416 422",
      .answers = { { 200, "Snapshot", CACHED " Accept-Ranges Content-Disposition", "The density" },
                   PART("npy png vti"),
                   UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/snapshots.pvd",
      .handle = handlers_results_snapshots,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "pvd",
      .params = PARAMS(&run_id, &if_match, &if_none_match),
      .id = "getSnapshotSeries",
      .tag = "Results",
      .summary = "The snapshots of results.zip?vtk=1 in time, for ParaView",
      .help = "Names the files of `results.zip?vtk=1` with their times: open it beside them.",
      .refusals = "404 412",
      .answers = { { 200, NULL, CACHED " Content-Disposition", "The series" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/parts/{n}",
      .handle = handlers_results_parts,
      .cost = API_COST_STORE,
      .text_cost = API_COST_WORK,
      .scope = ROUTE_READ,
      .formats = "npy json csv vtp",
      .params = PARAMS(&run_id, &snapshot_n, &format, &if_match, &if_none_match, &range, &if_range),
      .id = "getParts",
      .tag = "Results",
      .summary = "The parts at the time of a snapshot (micro)",
      .help = "One row for each part, in the order of their placement: place, heading, velocity "
              "and spin. 404 also for a macroscopic run. The rows never change and may be cached "
              "without limit.",
      .refusals = "404 412 416",
      .answers = { { 200, "Parts", CACHED " Accept-Ranges Content-Disposition", "The parts" },
                   PART("npy vtp"),
                   UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/parts.pvd",
      .handle = handlers_results_parts_series,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "pvd",
      .params = PARAMS(&run_id, &if_match, &if_none_match),
      .id = "getPartsSeries",
      .tag = "Results",
      .summary = "The parts of results.zip?vtk=1 in time, for ParaView (micro)",
      .help = "Names the files of `results.zip?vtk=1` with their times. 404 for a macroscopic run.",
      .refusals = "404 412",
      .answers = { { 200, NULL, CACHED " Content-Disposition", "The series" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/results.zip",
      .handle = handlers_results_archive,
      .cost = API_COST_WORK,
      .scope = ROUTE_READ,
      .formats = "zip",
      .params = PARAMS(&run_id, &with_vtk, &if_match, &if_none_match),
      .id = "getResults",
      .tag = "Results",
      .summary = "All results of a run that has ended",
      .help = "The files that `beltflow solve` writes: scenario, summary, curve, snapshots, parts. "
              "409 before the run has ended.",
      .refusals = "404 409 412",
      .answers = { { 200, NULL, CACHED " Content-Disposition", "The archive" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/events",
      .handle = handlers_results_events,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "sse ndjson",
      .params = PARAMS(&run_id, &format, &inline_grids, &last_event_id, &last_event_id_header),
      .id = "followRun",
      .tag = "Events",
      .summary = "Follow a run: its events from the first one on, until it has ended",
      .help = "The stream begins with the run's first event and ends with its last one. A client "
              "that reconnects with Last-Event-ID misses no event and receives none twice.",
      .refusals = "404",
      .answers = { { 200, NULL, "Cache-Control X-Accel-Buffering", "The stream" },
                   { 204, NULL, "Cache-Control",
                     "All events were sent before; do not reconnect" } } },
    { .method = "GET",
      .path = "/v1/events",
      .handle = handlers_results_events_of_runs,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "sse ndjson",
      .params =
          PARAMS(&followed_runs, &format, &inline_grids, &last_event_id, &last_event_id_header),
      .id = "followRuns",
      .tag = "Events",
      .summary = "Follow several runs in one stream",
      .help = "A browser has six connections to a host, so this one stream serves many runs. Each "
              "event has the id of its run in `run`.",
      .refusals = "404",
      .answers = { { 200, NULL, "Cache-Control X-Accel-Buffering", "The stream" },
                   { 204, NULL, "Cache-Control",
                     "All events were sent before; do not reconnect" } } },
    { .method = "POST",
      .path = "/v1/measurements",
      .handle = handlers_measurements_add,
      .cost = API_COST_WORK,
      .scope = ROUTE_WRITE,
      .formats = "json",
      .params = PARAMS(&csv_label, &csv_counter, &csv_kind),
      .id = "addMeasurement",
      .tag = "Comparison",
      .summary = "Store a measured curve, JSON or CSV, or a text for feeds; it is on disk before "
                 "the answer is sent",
      .help =
          "A measured curve can take the place of a run in a comparison. Of CSV the first "
          "column after `t_s` is read; label and counter then come in the query, with JSON "
          "they are in the body. With `kind` the CSV is a profile or a list of arrivals that feeds "
          "of a scenario name by the id of the measurement. It never changes. 409 when there "
          "are too many.",
      .body = "Measurement",
      .body_formats = "json csv",
      .refusals = "403 409 413 415 422",
      .answers = { { 201, "StoredMeasurement", "Location Cache-Control", "It was stored" } } },
    { .method = "GET",
      .path = "/v1/measurements",
      .handle = handlers_measurements_list,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&measurement_label, &page_limit, &page_cursor, &if_match, &if_none_match),
      .id = "listMeasurements",
      .tag = "Comparison",
      .summary = "List measurements, newest first",
      .help = "The list has all but samples and texts; the `next` link, where there is one, leads "
              "to older ones.",
      .refusals = "412",
      .answers = { { 200, "MeasurementList", CACHED " Link", "A page of them" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/measurements/{id}",
      .handle = handlers_measurements_show,
      .cost = API_COST_STORE,
      .scope = ROUTE_READ,
      .formats = "json csv",
      .params = PARAMS(&measurement_id, &format, &if_match, &if_none_match),
      .id = "getMeasurement",
      .tag = "Comparison",
      .summary = "A measurement with its samples or its text",
      .help = "As CSV a measured curve is a curve with the counter as its column, a text for feeds "
              "what was sent.",
      .refusals = "404 412",
      .answers = { { 200, "StoredMeasurement", CACHED, "The measurement" }, UNCHANGED } },
    { .method = "DELETE",
      .path = "/v1/measurements/{id}",
      .handle = handlers_measurements_remove,
      .cost = API_COST_STORE,
      .scope = ROUTE_WRITE,
      .formats = "json",
      .params = PARAMS(&measurement_id, &if_match),
      .id = "deleteMeasurement",
      .tag = "Comparison",
      .summary = "Remove a measurement",
      .help = "This cannot be undone.",
      .refusals = "403 404 412",
      .answers = { { 204, NULL, "Cache-Control", "The measurement was removed" } } },
    { .method = "GET",
      .path = "/v1/compare",
      .handle = handlers_compare_runs,
      .cost = API_COST_WORK,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&compared_a, &compared_b, &compared_runs, &reference, &column),
      .id = "compareRuns",
      .tag = "Comparison",
      .summary = "Measures between the curves and densities of two to eight runs and measurements",
      .help = "Two by `a` and `b`, or two to eight by `runs`, each with the reference. Curves are "
              "compared over the time that both have, densities at common times if the grids are "
              "the same. 409 if a run has nothing to compare yet, 422 if curves have no common "
              "column or time; `errors` names the parameter.",
      .refusals = "404 409 422",
      .answers = { { 200, "Comparison", "Cache-Control", "The measures" } } },
    { .method = "POST",
      .path = "/v1/validate",
      .handle = handlers_runs_validate,
      .cost = API_COST_WORK,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = NO_PARAMS,
      .id = "validateRun",
      .tag = "Scenarios",
      .summary = "Check a submission as POST /v1/runs does, and store nothing",
      .help = "The same checks and the same problems as when a run is submitted.",
      .body = "Submission",
      .refusals = "403 413 415 422",
      .answers = { { 200, "Validation", "Cache-Control", "It would be accepted" } } },
    { .method = "GET",
      .path = "/v1/examples",
      .handle = handlers_meta_examples,
      .cost = API_COST_NONE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&if_match, &if_none_match),
      .id = "listExamples",
      .tag = "Scenarios",
      .summary = "List the ready scenarios",
      .help = "The paper's Examples 1 to 3 and more.",
      .refusals = "412",
      .answers = { { 200, "ExampleList", CACHED, "The list" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/examples/{name}",
      .handle = handlers_meta_example,
      .cost = API_COST_NONE,
      .scope = ROUTE_READ,
      .formats = "json",
      .params = PARAMS(&example_name, &if_match, &if_none_match),
      .id = "getExample",
      .tag = "Scenarios",
      .summary = "One ready scenario",
      .help = "It can be submitted as it is, as `scenario` of a submission.",
      .refusals = "404 412",
      .answers = { { 200, "Scenario", CACHED, "The scenario" }, UNCHANGED } },
    { .method = "GET",
      .path = "/livez",
      .handle = handlers_meta_livez,
      .cost = API_COST_HEALTH,
      .scope = ROUTE_OPEN,
      .formats = "json",
      .params = NO_PARAMS,
      .id = "getLiveness",
      .tag = "Service",
      .summary = "Is the daemon alive?",
      .help = "Answers as long as the program runs, even when all connections for other requests "
              "are taken.",
      .answers = { { 200, "Alive", "Cache-Control", "The daemon is alive" } } },
    { .method = "GET",
      .path = "/readyz",
      .handle = handlers_meta_readyz,
      .cost = API_COST_HEALTH,
      .scope = ROUTE_OPEN,
      .formats = "json",
      .params = NO_PARAMS,
      .id = "getReadiness",
      .tag = "Service",
      .summary = "Can the daemon accept runs?",
      .help = "503 while the daemon stops or its store cannot be written.",
      .answers = { { 200, "Ready", "Cache-Control", "The daemon can accept runs" } } },
    { .method = "GET",
      .path = "/metrics",
      .handle = handlers_meta_metrics,
      .cost = API_COST_HEALTH,
      .scope = ROUTE_READ,
      .formats = "prometheus",
      .params = NO_PARAMS,
      .id = "getMetrics",
      .tag = "Service",
      .summary = "The service's figures for Prometheus",
      .help =
          "Requests, streams, queue, runs, solvers, store and process, in the text format 0.0.4.",
      .answers = { { 200, NULL, "Cache-Control", "The figures" } } },
    { .method = "GET",
      .path = "/version",
      .handle = handlers_meta_version,
      .cost = API_COST_NONE,
      .scope = ROUTE_OPEN,
      .formats = "json",
      .params = PARAMS(&if_match, &if_none_match),
      .id = "getVersion",
      .tag = "Service",
      .summary = "Which build this is",
      .help = "For bug reports.",
      .refusals = "412",
      .answers = { { 200, "Version", CACHED, "The build" }, UNCHANGED } },
    { .method = "GET",
      .path = "/openapi.json",
      .handle = handlers_meta_openapi,
      .cost = API_COST_STORE,
      .scope = ROUTE_OPEN,
      .formats = "json",
      .params = PARAMS(&if_match, &if_none_match),
      .id = "getDocument",
      .tag = "Service",
      .summary = "This API as an OpenAPI 3.1 document",
      .help = "Generated from the tables by which the daemon handles requests.",
      .refusals = "412",
      .answers = { { 200, "Document", CACHED, "This document" }, UNCHANGED } },
};

const route *routes_list(size_t *ret_n)
{
    *ret_n = sizeof table / sizeof *table;
    return table;
}
