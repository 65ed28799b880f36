// What the document says of each route beside its row in routes.c: one row a route, in the same
// order. The common refusals are those that any request can meet.

#include "api/openapi/openapi_priv.h"

#include <string.h>

const char openapi__common_refusals[] = "400 405 406 414 429 500 501 503";
const char openapi__common_headers[] = "Vary X-Request-Id RateLimit-Policy RateLimit";

#define CACHED "ETag Cache-Control"
#define UNCHANGED                                                                                  \
    {                                                                                              \
        304, NULL, CACHED, "Nothing has changed since the ETag in If-None-Match"                   \
    }

// Of a body in one of the formats that are no text.
#define PART(binary)                                                                               \
    {                                                                                              \
        206, NULL, CACHED " Accept-Ranges Content-Range Content-Disposition",                      \
            "The bytes that Range asked for", .formats = (binary)                                  \
    }

static const openapi_operation table[] = {
    { .method = "POST",
      .path = "/v1/runs",
      .id = "submitRun",
      .tag = "Runs",
      .help =
          "The scenario is checked as a whole first: every fault that can be found is told with "
          "its place. A 201 means that the run is stored safely and will be solved, whatever "
          "happens to the daemon meanwhile. With `Prefer: wait=N` the answer comes when the run "
          "has "
          "ended. What was solved before ends at once with those results (`cached`), unless it "
          "must be "
          "`fresh`. With Idempotency-Key a request can be sent again safely: the same key with "
          "another body is a 422. 429 and 503 mean that the client's share of the queue or the "
          "queue is full.",
      .body = "Submission",
      .headers = "Idempotency-Key Prefer",
      .refusals = "409 413 415 422",
      .answers = { { 201, "Run",
                     "Location ETag Cache-Control Preference-Applied Idempotent-Replayed",
                     "The run was accepted" } } },
    { .method = "GET",
      .path = "/v1/runs",
      .id = "listRuns",
      .tag = "Runs",
      .help = "Filters narrow the list; the `next` link, where there is one, leads to older runs.",
      .headers = "If-None-Match",
      .answers = { { 200, "RunList", CACHED " Link", "A page of runs" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}",
      .id = "getRun",
      .tag = "Runs",
      .help =
          "The ETag changes with every change of the run. To follow a run, its events are better "
          "than asking again and again.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, "Run", CACHED, "The run" }, UNCHANGED } },
    { .method = "DELETE",
      .path = "/v1/runs/{id}",
      .id = "deleteRun",
      .tag = "Runs",
      .help = "A run that is being solved is stopped first. There is no way back.",
      .headers = "If-Match",
      .refusals = "404 412",
      .answers = { { 204, NULL, "Cache-Control", "The run is gone" } } },
    { .method = "POST",
      .path = "/v1/runs/{id}/cancel",
      .id = "cancelRun",
      .tag = "Runs",
      .help = "What the run has given so far stays and can be read.",
      .headers = "If-Match",
      .refusals = "404 409 412",
      .answers = { { 200, "Run", "Cache-Control", "It had not begun, and is cancelled" },
                   { 202, "Run", "Cache-Control", "It will stop within a moment" } } },
    { .method = "GET",
      .path = "/v1/runs/{id}/scenario",
      .id = "getScenario",
      .tag = "Results",
      .help = "Submitted again it gives the same results, byte by byte.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, "ResolvedScenario", CACHED, "The scenario" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/summary",
      .id = "getSummary",
      .tag = "Results",
      .help = "There is none before the run has ended: 409 until then.",
      .headers = "If-None-Match",
      .refusals = "404 409",
      .answers = { { 200, "Summary", CACHED, "The figures" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/curve",
      .id = "getCurve",
      .tag = "Results",
      .help = "U(t) of the paper: how many parts are inside each counter at each time. As CSV the "
              "header is `t_s`, the counters' ids and `left_domain`.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, "Curve", CACHED, "The curve" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/snapshots",
      .id = "listSnapshots",
      .tag = "Results",
      .help = "Their times, largest densities and addresses, and the grid that they share.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, "SnapshotList", CACHED, "The list" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/snapshots/{n}",
      .id = "getSnapshot",
      .tag = "Results",
      .help =
          "Density on the grid, rows along y; 1 is close packing. A microscopic run has its parts "
          "as a density on the same grid. It never changes and may be kept for ever. 406 if the "
          "grid is too large for the format.",
      .headers = "If-None-Match Range If-Range",
      .refusals = "404 416 422",
      .answers = { { 200, "Snapshot", CACHED " Accept-Ranges Content-Disposition", "The density" },
                   PART("npy png vti"),
                   UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/snapshots.pvd",
      .id = "getSnapshotSeries",
      .tag = "Results",
      .help = "Names the files of `results.zip?vtk=1` with their times: open it beside them.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, NULL, CACHED " Content-Disposition", "The series" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/parts/{n}",
      .id = "getParts",
      .tag = "Results",
      .help = "One row a part, in the order of their placement: place, heading, velocity and spin. "
              "404 also for a macroscopic run. It never changes and may be kept for ever.",
      .headers = "If-None-Match Range If-Range",
      .refusals = "404 416",
      .answers = { { 200, "Parts", CACHED " Accept-Ranges Content-Disposition", "The parts" },
                   PART("npy vtp"),
                   UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/parts.pvd",
      .id = "getPartsSeries",
      .tag = "Results",
      .help = "Names the files of `results.zip?vtk=1` with their times. 404 for a macroscopic run.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, NULL, CACHED " Content-Disposition", "The series" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/results.zip",
      .id = "getResults",
      .tag = "Results",
      .help = "The files that `beltflow solve` writes: scenario, summary, curve, snapshots, parts. "
              "409 before the run has ended.",
      .headers = "If-None-Match",
      .refusals = "404 409",
      .answers = { { 200, NULL, CACHED " Content-Disposition", "The archive" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/runs/{id}/events",
      .id = "followRun",
      .tag = "Events",
      .help =
          "The stream begins with the run's first event and ends with its last one. A client that "
          "comes back with Last-Event-ID misses nothing and gets nothing twice.",
      .headers = "Last-Event-ID",
      .refusals = "404",
      .answers = { { 200, NULL, "Cache-Control X-Accel-Buffering", "The stream" },
                   { 204, NULL, "Cache-Control", "All was told before; do not come back" } } },
    { .method = "GET",
      .path = "/v1/events",
      .id = "followRuns",
      .tag = "Events",
      .help =
          "A browser has six connections to a host: this one stream is for many runs. Each event "
          "says in `run` whose it is.",
      .headers = "Last-Event-ID",
      .refusals = "404",
      .answers = { { 200, NULL, "Cache-Control X-Accel-Buffering", "The stream" },
                   { 204, NULL, "Cache-Control", "All was told before; do not come back" } } },
    { .method = "POST",
      .path = "/v1/measurements",
      .id = "addMeasurement",
      .tag = "Comparison",
      .help =
          "A curve that was measured elsewhere can stand wherever a run can in a comparison. As "
          "CSV "
          "the first column after `t_s` is read; label and counter then come in the query, of JSON "
          "they stand in the body. It never changes. 409 when there are too many.",
      .body = "Measurement",
      .body_formats = "json csv",
      .refusals = "409 413 415 422",
      .answers = { { 201, "StoredMeasurement", "Location Cache-Control", "It was stored" } } },
    { .method = "GET",
      .path = "/v1/measurements",
      .id = "listMeasurements",
      .tag = "Comparison",
      .help =
          "The list has all but the samples; the `next` link, where there is one, leads to older "
          "ones.",
      .headers = "If-None-Match",
      .answers = { { 200, "MeasurementList", CACHED " Link", "A page of them" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/measurements/{id}",
      .id = "getMeasurement",
      .tag = "Comparison",
      .help = "As CSV it is a curve with the counter as its column.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, "StoredMeasurement", CACHED, "The measurement" }, UNCHANGED } },
    { .method = "DELETE",
      .path = "/v1/measurements/{id}",
      .id = "deleteMeasurement",
      .tag = "Comparison",
      .help = "There is no way back.",
      .refusals = "404",
      .answers = { { 204, NULL, "Cache-Control", "The measurement is gone" } } },
    { .method = "GET",
      .path = "/v1/compare",
      .id = "compareRuns",
      .tag = "Comparison",
      .help =
          "Two by `a` and `b`, or two to eight by `runs`, each with the reference. Curves are "
          "compared over the time that both have, densities at common times where the grids are "
          "the same. 409 if a run has nothing to compare yet, 422 if curves have no common column "
          "or time; `errors` says which parameter.",
      .refusals = "404 409 422",
      .answers = { { 200, "Comparison", "Cache-Control", "The measures" } } },
    { .method = "POST",
      .path = "/v1/validate",
      .id = "validateRun",
      .tag = "Scenarios",
      .help = "The same checks and the same problems as when a run is submitted.",
      .body = "Submission",
      .refusals = "413 415 422",
      .answers = { { 200, "Validation", "Cache-Control", "It would be accepted" } } },
    { .method = "GET",
      .path = "/v1/examples",
      .id = "listExamples",
      .tag = "Scenarios",
      .help = "The paper's Examples 1 to 3 and more, to begin with.",
      .headers = "If-None-Match",
      .answers = { { 200, "ExampleList", CACHED, "The list" }, UNCHANGED } },
    { .method = "GET",
      .path = "/v1/examples/{name}",
      .id = "getExample",
      .tag = "Scenarios",
      .help = "It can be submitted as it is, as `scenario` of a submission.",
      .headers = "If-None-Match",
      .refusals = "404",
      .answers = { { 200, "Scenario", CACHED, "The scenario" }, UNCHANGED } },
    { .method = "GET",
      .path = "/livez",
      .id = "getLiveness",
      .tag = "Service",
      .help =
          "Answers as long as the program runs, even when it has no connection left for others.",
      .answers = { { 200, "Alive", "Cache-Control", "It is" } } },
    { .method = "GET",
      .path = "/readyz",
      .id = "getReadiness",
      .tag = "Service",
      .help = "503 while it stops or its store cannot be written.",
      .answers = { { 200, "Ready", "Cache-Control", "It can" } } },
    { .method = "GET",
      .path = "/metrics",
      .id = "getMetrics",
      .tag = "Service",
      .help =
          "Requests, streams, queue, runs, solvers, store and process, in the text format 0.0.4.",
      .answers = { { 200, NULL, "Cache-Control", "The figures" } } },
    { .method = "GET",
      .path = "/version",
      .id = "getVersion",
      .tag = "Service",
      .help = "What to tell when something is reported.",
      .headers = "If-None-Match",
      .answers = { { 200, "Version", CACHED, "The build" }, UNCHANGED } },
    { .method = "GET",
      .path = "/openapi.json",
      .id = "getDocument",
      .tag = "Service",
      .help = "Made from the tables that the daemon itself goes by.",
      .headers = "If-None-Match",
      .answers = { { 200, "Document", CACHED, "This document" }, UNCHANGED } },
};

const openapi_operation *openapi__operations(size_t *ret_n)
{
    *ret_n = sizeof table / sizeof *table;
    return table;
}

const openapi_operation *openapi__operation(const char *method, const char *path)
{
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        if (strcmp(table[k].method, method) == 0 && strcmp(table[k].path, path) == 0)
            return &table[k];
    }
    return NULL;
}
