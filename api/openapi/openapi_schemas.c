// The schemas of what is answered, one row a member. Those of what is sent follow from the tables of
// members.h (openapi_members.c); the events of streams stand in openapi_schemas_events.c.

#include "api/openapi/openapi_priv.h"

#define OBJECT(name_, members_, help_)                                                             \
    {                                                                                              \
        .name = (name_), .help = (help_), .members = (members_)                                    \
    }
#define TYPE(name_, type_, limits_, help_)                                                         \
    {                                                                                              \
        .name = (name_), .help = (help_), .type = (type_), .limits = (limits_)                     \
    }
#define WRITTEN(name_, write_, help_)                                                              \
    {                                                                                              \
        .name = (name_), .help = (help_), .write = (write_)                                        \
    }

const openapi_member openapi__run_members[] = {
    { "id", "#Id", "Its name for ever" },
    { "status", "#RunStatus", "Where it is in its life" },
    { "progress", "#Share", "Which share of its way it has made" },
    { "model", "#Model", "Which solver" },
    { "label", "string", "The client's own name of it; empty if none was given" },
    { "priority", "integer", "Higher ones are solved first" },
    { "name", "string", "The scenario's name" },
    { "created_at", "#Time", "When it was accepted" },
    { "started_at", "#Time?", "When it was last started; null: never" },
    { "finished_at", "#Time?", "When it ended; null: not yet" },
    { "eta_s", "number?", "Wall time to its end [s]; null: not known" },
    { "error", "#RunError?", "Why it failed; null: it did not" },
    { "cached", "boolean", "Its results were known from a run before" },
    { "links", "#RunLinks", "Where its resources are" },
    { 0 },
};

static const openapi_member run_error[] = {
    { "code", "#ErrorCode", "The kind of failure" },
    { "pointer", "#JsonPointer", "The place in the scenario; empty if it is none" },
    { "detail", "string", "What happened, for people" },
    { 0 },
};

static const openapi_member run_links[] = {
    { "self", "#Path", "The run" },
    { "scenario", "#Path", "Its resolved scenario" },
    { "summary", "#Path", "Its figures, once it has ended" },
    { "curve", "#Path", "Its outflow curve so far" },
    { "snapshots", "#Path", "Its snapshots so far" },
    { "series", "#Path", "Its snapshots in time, for ParaView" },
    { "parts_series?", "#Path", "Its parts in time, for ParaView (microscopic model)" },
    { "results", "#Path", "All its results in one archive, once it has ended" },
    { "events", "#Path", "Its event stream" },
    { "cancel", "#Path", "To be POSTed to when it shall stop" },
    { 0 },
};

static const openapi_member run_list[] = {
    { "runs", "[#Run]", "A page of them, newest first" },
    { 0 },
};

static const openapi_member validation[] = {
    { "valid", "boolean", "Always true: what is not valid is answered with a problem" },
    { "model", "#Model", "The model that it was checked for" },
    { "resolved", "#ResolvedScenario", "The scenario with every default filled in" },
    { 0 },
};

static const openapi_member curve[] = {
    { "t_s", "[number]", "Times of the samples [s]" },
    { "left_domain", "[number]", "Parts that have left the domain at each time" },
    { 0 },
};

static const openapi_member grid[] = {
    { "origin_m", "#Pair", "The corner with the smallest x and y [m, m]" },
    { "cell_m", "#Pair", "Edges of a cell along x and y [m, m]" },
    { "shape", "#Shape2", "Rows along y and columns along x" },
    { 0 },
};

static const openapi_member parts_layout[] = {
    { "rows", "#Count", "Parts, in the order of their placement" },
    { "columns", "[string]", "What the values of a part are, with their units" },
    { 0 },
};

static const openapi_member snapshot_item[] = {
    { "n", "#Count", "Its number, from 0" },
    { "t_s", "number", "Its time [s]" },
    { "url", "#Path", "Where its density is" },
    { "peak", "number", "The largest density; 1 is close packing" },
    { "mass", "number", "Parts in the domain" },
    { "parts_url?", "#Path", "Where its parts are (microscopic model)" },
    { 0 },
};

static const openapi_member snapshot_list[] = {
    { "grid", "#Grid", "That of every snapshot" },
    { "parts?", "#PartsLayout", "What every snapshot has of parts (microscopic model)" },
    { "snapshots", "[#SnapshotItem]", "Those that are there so far" },
    { 0 },
};

static const openapi_member snapshot[] = {
    { "n", "#Count", "Its number, from 0" },
    { "t_s", "number", "Its time [s]" },
    { "peak", "number", "The largest density" },
    { "mass", "number", "Parts in the domain" },
    { "density", "[[number?]]", "Rows along y of cells along x; 1 is close packing" },
    { 0 },
};

static const openapi_member parts[] = {
    { "n", "#Count", "Number of the snapshot" },
    { "t_s", "number", "Its time [s]" },
    { "columns", "[string]", "What the values of a part are, with their units" },
    { "parts", "[[number?]?]", "The values of each part; null: it has left the domain" },
    { 0 },
};

static const openapi_member summary[] = {
    { "solver_version", "string", "The version that solved it" },
    { "stopped", "boolean", "It was stopped before its time" },
    { "steps", "#Count", "Time steps" },
    { "step_s", "number", "Length of a step [s]" },
    { "duration_s", "number", "Simulated time that was reached [s]" },
    { "wall_time_s", "number", "Time spent solving [s]" },
    { "threads", "#Count", "Threads used" },
    { "samples", "#Count", "Samples of the curve" },
    { "snapshots", "#Count", "Snapshots" },
    { "parts_start", "number", "Parts in the domain at the start" },
    { "parts_end", "number", "Parts in the domain at the end" },
    { "parts_left", "number", "Parts that left it" },
    { "largest_density", "number", "At any time; 1 is close packing" },
    { "digest", "string", "Of the final state: the same for the same results" },
    { "packing_density_per_m2", "number", "Parts in close packing [1/m2]" },
    { "warnings", "[string]", "What should make one doubt the results" },
    { "cached?", "boolean", "They were known from a run before" },
    { "scenario", "#ResolvedScenario", "What was solved" },
    { 0 },
};

static const openapi_member summary_macro[] = {
    { "model", "=macro", "Which solver" },
    { "cells", "#Count", "Cells of the grid" },
    { "cell_steps_per_s", "number?", "How fast it was [1/s]" },
    { 0 },
};

static const openapi_member summary_micro[] = {
    { "model", "=micro", "Which solver" },
    { "path", "string", "Its equations of motion: planar or spatial" },
    { "parts", "#Count", "Parts at the start" },
    { "particle_steps_per_s", "number?", "How fast it was [1/s]" },
    { "largest_overlap_m", "number", "Of two parts, at any time [m]" },
    { "largest_overlap_share", "number", "The same, of the smaller part's radius" },
    { "contacts", "#Count", "Contacts at the end" },
    { "kinetic_energy_j", "number", "Of all parts at the end [J]" },
    { 0 },
};

static const openapi_member self_links[] = { { "self", "#Path", "It" }, { 0 } };

static const openapi_member measurement_item[] = {
    { "id", "#Id", "Its name for ever" },
    { "label", "string", "The client's own name of it; empty if none was given" },
    { "counter", "#CounterId", "Which column of a curve was measured" },
    { "created_at", "#Time", "When it was stored" },
    { "n_samples", "#Count", "Samples" },
    { "t_start_s", "number", "Time of the first one [s]" },
    { "t_end_s", "number", "Time of the last one [s]" },
    { "links", "#SelfLinks", "Where it is" },
    { 0 },
};

static const openapi_member measurement_samples[] = {
    { "t_s", "[number]", "Times of the samples [s]" },
    { "count", "[number]", "What was counted at each time [parts]" },
    { 0 },
};

static const openapi_member measurement_list[] = {
    { "measurements", "[#MeasurementItem]", "A page of them, newest first" },
    { 0 },
};

static const openapi_member compared[] = {
    { "id", "#Id", "Which run or measurement" },
    { "kind", "#ComparedKind", "Which of both" },
    { "label", "string", "The client's own name of it" },
    { "name", "string?", "The scenario's name; null: it was measured" },
    { "model", "#Model?", "Which solver; null: it was measured" },
    { "status", "#RunStatus?", "Where it is in its life; null: it was measured" },
    { "column", "#CounterId", "The column of its curve" },
    { "t_start_s", "number?", "Time of its first sample [s]" },
    { "t_end_s", "number?", "Time of its last sample [s]" },
    { "parts_start", "number?", "First value [parts]" },
    { "parts_end", "number?", "Last value [parts]" },
    { "drain_time_s", "number?",
      "First time with at most 1 % of the first value [s]; null: never" },
    { "t10_s", "number?", "When 10 % of what leaves has left [s]" },
    { "t90_s", "number?", "When 90 % of it has [s]" },
    { "throughput_per_s", "number?", "Between these two times [parts/s]; null: nothing left" },
    { 0 },
};

static const openapi_member curve_measures[] = {
    { "t_start_s", "number", "Start of the common interval [s]" },
    { "t_end_s", "number", "End of it [s]" },
    { "l1", "number?", "Mean gap [parts]" },
    { "l2", "number?", "Root of the mean square of the gap [parts]" },
    { "largest", "number?", "Largest gap [parts]" },
    { "largest_at_s", "number?", "When it is reached first [s]" },
    { "drain_time_a_s", "number?",
      "First time with at most 1 % of a's first value [s]; null: never" },
    { "drain_time_b_s", "number?", "The same of b [s]" },
    { "drain_time_gap_s", "number?", "That of b minus that of a [s]" },
    { "rate_a_per_s", "number?", "Mean outflow of a [parts/s]" },
    { "rate_b_per_s", "number?", "Mean outflow of b [parts/s]" },
    { "throughput_a_per_s", "number?", "Of a, between 10 and 90 % of what leaves [parts/s]" },
    { "throughput_b_per_s", "number?", "The same of b [parts/s]" },
    { "throughput_gap_per_s", "number?", "That of b minus that of a [parts/s]" },
    { 0 },
};

static const openapi_member distance[] = {
    { "mean_abs", "number?", "Mean absolute difference of a cell's density" },
    { "l1", "number?",
      "Sum of the differences by sum of the densities: 0 the same, 1 nothing in common" },
    { "emd_x_m", "number?", "Earth mover's distance of the densities summed across the belt [m]" },
    { "emd_y_m", "number?", "The same of those summed along it [m]" },
    { 0 },
};

static const openapi_member density_distance[] = {
    { "t_s", "number", "The common time [s]" },
    { "a", "#Count", "Number of a's snapshot" },
    { "b", "#Count", "Number of b's snapshot" },
    { "mass_a", "number?", "Parts in the domain of a" },
    { "mass_b", "number?", "Parts in the domain of b" },
    { 0 },
};

static const openapi_member density_measures[] = {
    { "same_grid", "boolean", "Both have the same grid; else nothing is compared" },
    { "n_common", "#Count", "Snapshots at common times" },
    { "snapshots", "[#DensityDistance]", "Of the common times, where many only some" },
    { "mean", "#Distance", "The means of them" },
    { 0 },
};

static const openapi_member measures[] = {
    { "curve", "#CurveMeasures", "Between the curves" },
    { "density", "#DensityMeasures?", "Between the densities; null: one was measured" },
    { 0 },
};

static const openapi_member compared_two[] = {
    { "a", "#Compared", "The first one" },
    { "b", "#Compared", "The second one" },
    { 0 },
};

static const openapi_member compared_pair[] = {
    { "a", "#Id", "The reference" },
    { "b", "#Id", "What is compared with it" },
    { 0 },
};

static const openapi_member compared_many[] = {
    { "reference", "#Id", "What the others are compared with" },
    { "entries", "[#Compared 2-8]", "All of them, in the order of the request" },
    { "pairs", "[#ComparedPair 1-7]", "The reference with each of the others" },
    { 0 },
};

static const openapi_member example_item[] = {
    { "name", "string", "Its name in addresses" },
    { "title", "string", "Its name for people" },
    { "url", "#Path", "Where it is" },
    { 0 },
};

static const openapi_member example_list[] = {
    { "examples", "[#ExampleItem]", "All of them, by name" },
    { 0 },
};

static const openapi_member alive[] = { { "status", "=alive", "So it is" }, { 0 } };
static const openapi_member ready[] = { { "status", "=ready", "Runs are accepted" }, { 0 } };

static const openapi_member version[] = {
    { "name", "=beltflow", "The program" },
    { "version", "string", "Of the program" },
    { "api", "=v1", "Of the API" },
    { "compiler", "string", "What it was built with" },
    { 0 },
};

static const openapi_member document[] = {
    { "openapi", "string", "Version of the format" },
    { "info", "object", "What this is" },
    { "paths", "object", "What can be asked" },
    { "components", "object", "What the paths share" },
    { 0 },
};

static const openapi_member problem[] = {
    { "type", "#ProblemType", "The kind of problem" },
    { "title", "string", "The same for people" },
    { "status", "integer", "The HTTP status" },
    { "detail", "string", "What is wrong with this request, for people" },
    { "instance", "#Path", "The path that was asked for" },
    { "request_id?", "string", "The request's id, as in X-Request-Id" },
    { "errors?", "[#ProblemError]", "Each fault of a document, up to 64" },
    { 0 },
};

static const openapi_member problem_error[] = {
    { "pointer", "#JsonPointer", "The place in the document" },
    { "detail", "string", "What is wrong there" },
    { 0 },
};

static const openapi_schema table[] = {
    TYPE("Id", "string",
         "\"pattern\":\"^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$\","
         "\"examples\":[\"0190a0b0-0000-7000-8000-000000000001\"]",
         "Name of a run or a measurement: a UUID of version 7, so that ids sort by time"),
    TYPE("Time", "string", "\"format\":\"date-time\"", "A moment in UTC"),
    TYPE("Share", "number", "\"minimum\":0,\"maximum\":1", "A part of the whole"),
    TYPE("Count", "integer", "\"minimum\":0", "How many, or which"),
    TYPE("Path", "string", "\"format\":\"uri-reference\",\"pattern\":\"^[/*]\"",
         "Path of a resource of this service"),
    TYPE("EntityTag", "string", "\"pattern\":\"^\\\"[^\\\"]+\\\"$\"", "A strong entity tag"),
    TYPE("JsonPointer", "string", "\"format\":\"json-pointer\"",
         "Place in a document (RFC 6901); empty is the whole document"),
    TYPE("CounterId", "string", "\"minLength\":1,\"maxLength\":64",
         "Name of a counter, which is a column of the curve"),
    TYPE("Pair", "[number 2]", NULL, "Two numbers, of x and of y"),
    TYPE("Shape2", "[#Count 2]", NULL, "Rows and columns"),
    WRITTEN("RunStatus", openapi__write_states, "Where a run is in its life"),
    WRITTEN("Model", openapi__write_models, "Which solver"),
    WRITTEN("Colormap", openapi__write_colormaps, "Colours of a picture, the usual ones first"),
    WRITTEN("ErrorCode", openapi__write_status_words, "A kind of failure"),
    WRITTEN("ProblemType", openapi__write_problem_types, "A kind of problem"),
    OBJECT("Run", openapi__run_members, "A run"),
    OBJECT("RunError", run_error, "Why a run failed"),
    OBJECT("RunLinks", run_links, "The resources of a run"),
    OBJECT("RunList", run_list, "A page of the list of runs"),
    OBJECT("Validation", validation, "A submission that is valid"),
    { .name = "Curve",
      .help = "Outflow curve: one list for each counter, under its id, all of the same length",
      .members = curve,
      .others = "[number]" },
    OBJECT("Grid", grid, "Where the cells are"),
    OBJECT("PartsLayout", parts_layout, "What a snapshot has of parts"),
    OBJECT("SnapshotItem", snapshot_item, "A snapshot in a list"),
    OBJECT("SnapshotList", snapshot_list, "The snapshots of a run"),
    { .name = "Snapshot", .help = "A density", .members = snapshot, .more = grid },
    OBJECT("Parts", parts, "The parts at one time"),
    { .name = "Summary", .help = "Figures of a run", .one_of = "MacroSummary MicroSummary" },
    { .name = "MacroSummary",
      .help = "Figures of a macroscopic run",
      .members = summary_macro,
      .more = summary },
    { .name = "MicroSummary",
      .help = "Figures of a microscopic run",
      .members = summary_micro,
      .more = summary },
    OBJECT("SelfLinks", self_links, "The resource itself"),
    OBJECT("MeasurementItem", measurement_item, "A measured curve without its samples"),
    OBJECT("MeasurementList", measurement_list, "A page of the list of measurements"),
    { .name = "StoredMeasurement",
      .help = "A measured curve",
      .members = measurement_item,
      .more = measurement_samples },
    { .name = "Comparison",
      .help = "How far runs and measurements are apart: of two by a and b, of several by runs",
      .one_of = "ComparedTwo ComparedMany" },
    { .name = "ComparedTwo",
      .help = "How far two are apart",
      .members = compared_two,
      .more = measures },
    OBJECT("ComparedMany", compared_many, "How far several are from a reference"),
    { .name = "ComparedPair",
      .help = "How far one is from the reference",
      .members = compared_pair,
      .more = measures },
    OBJECT("Compared", compared, "A run or a measurement that is compared"),
    TYPE("ComparedKind", "string", "\"enum\":[\"run\",\"measurement\"]", "A run or a measurement"),
    OBJECT("CurveMeasures", curve_measures, "How far two curves are apart"),
    OBJECT("DensityMeasures", density_measures, "How far the densities of two runs are apart"),
    OBJECT("Distance", distance, "How far two densities are apart"),
    { .name = "DensityDistance",
      .help = "How far the densities are apart at one time",
      .members = density_distance,
      .more = distance },
    OBJECT("ExampleList", example_list, "The ready scenarios"),
    OBJECT("ExampleItem", example_item, "A ready scenario"),
    OBJECT("Alive", alive, "The daemon lives"),
    OBJECT("Ready", ready, "The daemon is ready"),
    OBJECT("Version", version, "Which build this is"),
    { .name = "Document", .help = "An OpenAPI document", .members = document, .others = "" },
    OBJECT("Problem", problem, "Why a request was refused (RFC 9457)"),
    OBJECT("ProblemError", problem_error, "A fault of a document"),
    TYPE("Csv", "string", NULL, "One line of names, then a line for each row; `nan`: not known"),
    TYPE("Npy", "string", "\"format\":\"binary\"", "A NumPy file of version 1.0, little-endian"),
    TYPE("Png", "string", "\"format\":\"binary\"", "A picture in true proportions"),
    TYPE("Vtk", "string", "\"format\":\"binary\"", "A VTK XML file with raw bytes appended"),
    TYPE("Pvd", "string", NULL, "A ParaView collection: files and their times [s]"),
    TYPE("Zip", "string", "\"format\":\"binary\"", "An archive"),
    TYPE("Metrics", "string", NULL, "A line for each figure: its name, its labels, its value"),
    TYPE("EventStream", "string",
         "\"contentMediaType\":\"application/json\",\"contentSchema\":"
         "{\"$ref\":\"#/components/schemas/EventData\"}",
         "Server-sent events. `event` is one of status, progress, curve, snapshot and end; `data` "
         "is "
         "an object in one line; `id` rises. A comment comes when there is nothing to say"),
    TYPE("EventLines", "string",
         "\"contentMediaType\":\"application/json\",\"contentSchema\":"
         "{\"$ref\":\"#/components/schemas/EventLine\"}",
         "The same events, one JSON object a line. An empty line comes when there is nothing to "
         "say"),
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
