// Schemas of answers. Schemas of request bodies are generated from the input tables (schema_writer.c),
// and those of answers that have a table from it. The rows here are for answers that code writes
// member by member, and for values that are no objects.

#include "api/openapi/openapi_priv.h"

#include "api/http/problem.h"
#include "api/results/compare_json.h"
#include "api/results/events.h"
#include "api/results/measurement.h"
#include "api/results/results.h"
#include "api/results/run_json.h"
#include "api/results/service_json.h"
#include "api/scenario/examples.h"
#include "api/scenario/review_members.h"
#include "api/scenario/submission.h"

#define OBJECT(table_, help_)                                                                      \
    {                                                                                              \
        .help = (help_), .table = &(table_)                                                        \
    }
#define TYPE(name_, type_, limits_, help_)                                                         \
    {                                                                                              \
        .name = (name_), .help = (help_), .type = (type_), .limits = (limits_)                     \
    }
#define WRITTEN(name_, write_, help_)                                                              \
    {                                                                                              \
        .name = (name_), .help = (help_), .write = (write_)                                        \
    }
#define ROW(name, type_, ...) MEMBER(name, described, 0, __VA_ARGS__, .type = (type_))
#define ROWS(title, name)     static const member_table name = { MEMBER_TABLE(title, name##_members) }

static const member density_measures_members[] = {
    ROW("same_grid", "boolean", "Both have the same grid; else nothing is compared"),
    ROW("n_common", "#Count", "Snapshots at common times"),
    ROW("snapshots", "[#DensityDistance]", "Of the common times, where many only some"),
    ROW("mean", "#Distance", "Mean of each measure"),
};
ROWS("DensityMeasures", density_measures);

#define MEASURES                                                                                   \
    ROW("curve", "#CurveMeasures", "Between the curves"),                                          \
        ROW("density", "#DensityMeasures", "Between the densities", .null = "one was measured")
static const member compared_two_members[] = {
    ROW("a", "#Compared", "The first one"),
    ROW("b", "#Compared", "The second one"),
    MEASURES,
};
ROWS("ComparedTwo", compared_two);

static const member compared_pair_members[] = {
    ROW("a", "#Id", "The reference"),
    ROW("b", "#Id", "What is compared with it"),
    MEASURES,
};
ROWS("ComparedPair", compared_pair);

static const member compared_many_members[] = {
    ROW("reference", "#Id", "What the others are compared with"),
    ROW("entries", "[#Compared 2-8]", "All of them, in the order of the request"),
    ROW("pairs", "[#ComparedPair 1-7]", "The reference with each of the others"),
};
ROWS("ComparedMany", compared_many);

static const member document_members[] = {
    ROW("openapi", "string", "Version of the format"),
    ROW("info", "object", "Title, description and version of the API"),
    ROW("paths", "object", "The operations"),
    ROW("components", "object", "What the operations refer to"),
};
ROWS("Document", document);

// An event as a line of its own; the member `event` says which schema its data has.
#define LINE(title, name, word, data)                                                              \
    static const member name##_members[] = {                                                       \
        ROW("id", "#Count", "Rises; send it as Last-Event-ID to continue after this event"),       \
        ROW("run", "#Id", "Identifier of the run"),                                                \
        ROW("event", "=" word, "Kind of event"),                                                   \
        ROW("data", "#" data, "Data of the event"),                                                \
    };                                                                                             \
    ROWS(title, name)
LINE("StatusLine", status_line, "status", "StatusEvent");
LINE("ProgressLine", progress_line, "progress", "ProgressEvent");
LINE("CurveLine", curve_line, "curve", "CurveEvent");
LINE("SnapshotLine", snapshot_line, "snapshot", "SnapshotEvent");
LINE("EndLine", end_line, "end", "EndEvent");
LINE("FiguresLine", figures_line, "figures", "FiguresEvent");
LINE("PhotoEyeLine", eye_line, "photo_eye", "PhotoEyeEvent");
LINE("ActionLine", action_line, "action", "ActionEvent");

static const openapi_schema table[] = {
    TYPE("Id", "string",
         "\"pattern\":\"^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$\","
         "\"examples\":[\"0190a0b0-0000-7000-8000-000000000001\"]",
         "Name of a run or a measurement: a UUID of version 7, so that ids sort by time"),
    TYPE("Time", "string", "\"format\":\"date-time\"", "A moment in UTC"),
    TYPE("Share", "number", "\"minimum\":0,\"maximum\":1", "A fraction, 0 to 1"),
    TYPE("Count", "integer", "\"minimum\":0", "A number of things, or an index"),
    TYPE("Path", "string", "\"format\":\"uri-reference\",\"pattern\":\"^[/*]\"",
         "Path of a resource of this service"),
    TYPE("EntityTag", "string", "\"pattern\":\"^\\\"[^\\\"]+\\\"$\"", "A strong entity tag"),
    TYPE("JsonPointer", "string", "\"format\":\"json-pointer\"",
         "Place in a document (RFC 6901); empty is the whole document"),
    TYPE("CounterId", "string", "\"minLength\":1,\"maxLength\":64",
         "Name of a counter, which is a column of the curve"),
    TYPE("ColumnName", "string", "\"minLength\":1,\"maxLength\":80",
         "Name of a column of the curve: a counter, `left_domain`, or one of a feed or photo eye"),
    TYPE("ScenarioId", "string", "\"minLength\":1,\"maxLength\":64",
         "Id of another part of the scenario"),
    TYPE("Pair", "[number 2]", NULL, "Two numbers, of x and of y"),
    TYPE("Shape2", "[#Count 2]", NULL, "Rows and columns"),
    WRITTEN("RunStatus", openapi__write_states, "State of a run"),
    WRITTEN("Model", openapi__write_models, "A solver"),
    WRITTEN("MeasuredKind", openapi__write_measured_kinds, "What a measurement is"),
    WRITTEN("Colormap", openapi__write_colormaps,
            "Colour map of a picture; the first one is the default"),
    WRITTEN("ErrorCode", openapi__write_status_words, "A kind of failure"),
    WRITTEN("ProblemType", openapi__write_problem_types, "A kind of problem"),
    OBJECT(run_json, "A run"),
    OBJECT(run_json_error, "Why a run failed"),
    OBJECT(run_json_links, "The resources of a run"),
    OBJECT(run_json_list, "A page of the list of runs"),
    WRITTEN("KeyFigures", openapi__write_figures, "Key figures; what a run cannot say is missing"),
    WRITTEN("RunFigures", openapi__write_run_figures, "Key figures of a run alone"),
    WRITTEN("FeedFigures", openapi__write_feed_figures, "Key figures of a feed"),
    WRITTEN("CounterFigures", openapi__write_counter_figures, "Key figures of a counter"),
    WRITTEN("PhotoEyeFigures", openapi__write_eye_figures, "Key figures of a photo eye"),
    OBJECT(submission_validation_members, "A submission that is valid"),
    OBJECT(review_validity_members,
           "Whether the macroscopic model was compared with moving parts for scenarios like this "
           "one"),
    OBJECT(review_outside_members, "A figure of a scenario that is out of its range"),
    { .help = "Outflow curve: one list for each counter, under its id, all of the same length",
      .table = &results_curve_members,
      .others = "[number]" },
    OBJECT(results_changes_members, "What the photo eyes of a run saw and did"),
    OBJECT(results_eye_members, "A photo eye changed its state"),
    OBJECT(results_action_members, "An action of a photo eye was carried out"),
    OBJECT(results_grid_members, "Grid of a density"),
    OBJECT(results_parts_layout_members, "Layout of the parts of a snapshot"),
    OBJECT(results_snapshot_item_members, "A snapshot in a list"),
    OBJECT(results_snapshots_members, "The snapshots of a run"),
    OBJECT(results_snapshot_members, "A density snapshot"),
    OBJECT(results_parts_members, "The parts at one time"),
    { .name = "Summary", .help = "Summary of a run", .one_of = "MacroSummary MicroSummary" },
    { .name = "MacroSummary",
      .help = "Summary of a macroscopic run",
      .table = &results_summary_members,
      .tag = RUN_MACRO },
    { .name = "MicroSummary",
      .help = "Summary of a microscopic run",
      .table = &results_summary_members,
      .tag = RUN_MICRO },
    OBJECT(measurement_links, "The resource itself"),
    OBJECT(measurement_item, "A measurement without its samples or text"),
    OBJECT(measurement_list, "A page of the list of measurements"),
    OBJECT(measurement_stored, "A measurement"),
    { .name = "Comparison",
      .help = "Comparison of runs and measurements: of two by `a` and `b`, of several by `runs`",
      .one_of = "ComparedTwo ComparedMany" },
    OBJECT(compared_two, "Comparison of two"),
    OBJECT(compared_many, "Comparison of several with a reference"),
    OBJECT(compared_pair, "Comparison of one with the reference"),
    OBJECT(compare_json_compared, "A run or a measurement that is compared"),
    TYPE("ComparedKind", "string", "\"enum\":[\"run\",\"measurement\"]", "A run or a measurement"),
    OBJECT(compare_json_measures, "Distance of two curves"),
    OBJECT(density_measures, "Distance of the densities of two runs"),
    OBJECT(compare_json_distance, "Distance of two densities"),
    OBJECT(compare_json_density_distance, "Distance of two densities at a common time"),
    OBJECT(examples_members, "The ready scenarios"),
    OBJECT(examples_item_members, "A ready scenario"),
    OBJECT(service_json_alive_members, "The process answers"),
    OBJECT(service_json_ready_members, "Runs are accepted"),
    OBJECT(service_json_version_members, "Version of the service"),
    OBJECT(service_json_ticket_members, "What stands for an access token in a URL"),
    OBJECT(service_json_quotas_members, "What an owner uses and may use"),
    OBJECT(service_json_quota_members, "What is used of a quota"),
    { .help = "An OpenAPI document", .table = &document, .others = "" },
    OBJECT(problem_kind_members, "What a kind of problem means"),
    OBJECT(problem_members, "Why a request was refused (RFC 9457)"),
    OBJECT(problem_error_members, "A fault of a document"),
    TYPE("Csv", "string", NULL, "One line of names, then a line for each row; `nan`: not known"),
    TYPE("Npy", "string", "\"format\":\"binary\"", "A NumPy file of version 1.0, little-endian"),
    TYPE("Png", "string", "\"format\":\"binary\"", "A picture in true proportions"),
    TYPE("Vtk", "string", "\"format\":\"binary\"", "A VTK XML file with raw bytes appended"),
    TYPE("Pvd", "string", NULL, "A ParaView collection: files and their times [s]"),
    TYPE("Zip", "string", "\"format\":\"binary\"", "An archive"),
    TYPE("Metrics", "string", NULL, "A line for each metric: its name, its labels, its value"),
    TYPE(
        "EventStream", "string",
        "\"contentMediaType\":\"application/json\",\"contentSchema\":"
        "{\"$ref\":\"#/components/schemas/EventData\"}",
        "Server-sent events. `event` is one of status, progress, curve, snapshot, figures, "
        "photo_eye, action and end; `data` is an object in one line; `id` rises. A comment is sent "
        "while there are no events"),
    TYPE(
        "EventLines", "string",
        "\"contentMediaType\":\"application/json\",\"contentSchema\":"
        "{\"$ref\":\"#/components/schemas/EventLine\"}",
        "The same events, one JSON object a line. An empty line is sent while there are no events"),
    { .name = "Base64",
      .help = "Bytes as text",
      .type = "string",
      .limits = "\"contentEncoding\":\"base64\"" },
    { .name = "EventData",
      .help = "Data of an event",
      .one_of = "StatusEvent ProgressEvent CurveEvent SnapshotEvent EndEvent FiguresEvent "
                "PhotoEyeEvent ActionEvent" },
    OBJECT(events_status_data, "The run has changed its state; the whole run"),
    OBJECT(events_progress_data, "Progress of the run"),
    { .help = "Samples of the outflow curve: one list for each counter, under its id",
      .table = &events_curve_data,
      .others = "[number]" },
    OBJECT(events_snapshot_data, "A snapshot was taken"),
    OBJECT(events_end_data, "The run has ended; its last event"),
    OBJECT(events_figures_data, "Key figures so far"),
    OBJECT(events_eye_data, "A photo eye changed its state"),
    OBJECT(events_action_data, "An action of a photo eye was carried out"),
    { .name = "EventLine",
      .help = "An event",
      .one_of = "StatusLine ProgressLine CurveLine SnapshotLine EndLine FiguresLine PhotoEyeLine "
                "ActionLine" },
    OBJECT(status_line, "A status event"),
    OBJECT(progress_line, "A progress event"),
    OBJECT(curve_line, "A curve event"),
    OBJECT(snapshot_line, "A snapshot event"),
    OBJECT(end_line, "An end event"),
    OBJECT(figures_line, "A figures event"),
    OBJECT(eye_line, "An event of a photo eye"),
    OBJECT(action_line, "An event of an action"),
};

// Of the bodies of formats that are not JSON; a row each.
static const char *const format_schemas[] = {
    [MEDIA_JSON] = NULL,         [MEDIA_CSV] = "Csv",           [MEDIA_NPY] = "Npy",
    [MEDIA_PNG] = "Png",         [MEDIA_VTI] = "Vtk",           [MEDIA_VTP] = "Vtk",
    [MEDIA_PVD] = "Pvd",         [MEDIA_ZIP] = "Zip",           [MEDIA_PROMETHEUS] = "Metrics",
    [MEDIA_SSE] = "EventStream", [MEDIA_NDJSON] = "EventLines",
};

const openapi_schema *openapi__schemas(size_t *ret_n)
{
    *ret_n = sizeof table / sizeof *table;
    return table;
}

const char *openapi__format_schema(media_format format)
{
    return format < sizeof format_schemas / sizeof *format_schemas ? format_schemas[format] : NULL;
}
