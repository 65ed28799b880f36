// The schemas of the events of a run: the data of each kind, and an event as a line of NDJSON.

#include "api/openapi/openapi_priv.h"

#include "api/services.h"

#include <string.h>

static const openapi_member of_run[] = { { "run", "#Id", "Whose event it is" }, { 0 } };

static const openapi_member progress[] = {
    { "run", "#Id", "Whose event it is" },
    { "t_s", "number", "Simulated time [s]" },
    { "progress", "#Share", "Which share of its way the run has made" },
    { "steps_per_s", "number?", "Time steps in a second of wall time [1/s]; null: not known" },
    { "eta_s", "number?", "Wall time to the end [s]; null: not known" },
    { 0 },
};

static const openapi_member curve[] = {
    { "run", "#Id", "Whose event it is" },
    { "first", "#Count", "Index of the first of these samples in the whole curve" },
    { "t_s", "[number]", "Times of the samples [s]" },
    { "left_domain", "[number]", "Parts that have left the domain at each time" },
    { 0 },
};

static const openapi_member snapshot[] = {
    { "run", "#Id", "Whose event it is" },
    { "n", "#Count", "Number of the snapshot, from 0" },
    { "t_s", "number", "Its time [s]" },
    { "peak", "number", "The largest density; 1 is close packing" },
    { "mass", "number", "Parts in the domain" },
    { "shape", "#Shape2", "Rows along y and columns along x" },
    { "url", "#Path", "Where its density is" },
    { "parts_url?", "#Path", "Where its parts are (microscopic model)" },
    { "data?", "#Base64?",
      "With `inline=1`: the grid as float32, little-endian, rows along y, in base64; null: it is "
      "too "
      "large, or gone" },
    { 0 },
};

static const openapi_member end[] = {
    { "run", "#Id", "Whose event it is" },
    { "status", "#RunStatus", "How the run ended" },
    { "progress", "#Share", "Which share of its way it had made" },
    { "finished_at", "#Time?", "When" },
    { "n_samples", "#Count", "Samples of its curve" },
    { "n_snapshots", "#Count", "Its snapshots" },
    { "error", "#RunError?", "Why it failed; null: it did not" },
    { 0 },
};

// An event as a line of its own; the member `event` says which of the schemas above its data has.
#define LINE(word, schema)                                                                         \
    {                                                                                              \
        { "id", "#Count", "Rises; send it as Last-Event-ID to go on behind this event" },          \
            { "run", "#Id", "Whose event it is" }, { "event", "=" word, "What kind it is" },       \
            { "data", "#" schema, "What it tells" }, { 0 },                                        \
    }

static const openapi_member lines[API_EVENT_TYPE_COUNT][5] = {
    [API_EVENT_STATUS] = LINE("status", "StatusEvent"),
    [API_EVENT_PROGRESS] = LINE("progress", "ProgressEvent"),
    [API_EVENT_CURVE] = LINE("curve", "CurveEvent"),
    [API_EVENT_SNAPSHOT] = LINE("snapshot", "SnapshotEvent"),
    [API_EVENT_END] = LINE("end", "EndEvent"),
};

static const openapi_schema table[] = {
    { .name = "Base64",
      .help = "Bytes as text",
      .type = "string",
      .limits = "\"contentEncoding\":\"base64\"" },
    { .name = "EventData",
      .help = "What an event tells",
      .one_of = "StatusEvent ProgressEvent CurveEvent SnapshotEvent EndEvent" },
    { .name = "StatusEvent",
      .help = "The run has changed its state: all of it",
      .members = of_run,
      .more = openapi__run_members },
    { .name = "ProgressEvent", .help = "How far the run is", .members = progress },
    { .name = "CurveEvent",
      .help = "Samples of the outflow curve: one list for each counter, under its id",
      .members = curve,
      .others = "[number]" },
    { .name = "SnapshotEvent", .help = "A snapshot was taken", .members = snapshot },
    { .name = "EndEvent", .help = "The run has ended; nothing follows", .members = end },
    { .name = "EventLine",
      .help = "An event",
      .one_of = "StatusLine ProgressLine CurveLine SnapshotLine EndLine" },
    { .name = "StatusLine", .help = "A status event", .members = lines[API_EVENT_STATUS] },
    { .name = "ProgressLine", .help = "A progress event", .members = lines[API_EVENT_PROGRESS] },
    { .name = "CurveLine", .help = "A curve event", .members = lines[API_EVENT_CURVE] },
    { .name = "SnapshotLine", .help = "A snapshot event", .members = lines[API_EVENT_SNAPSHOT] },
    { .name = "EndLine", .help = "An end event", .members = lines[API_EVENT_END] },
};

const openapi_schema *openapi__event_schemas(size_t *ret_n)
{
    *ret_n = sizeof table / sizeof *table;
    return table;
}
