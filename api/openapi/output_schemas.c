// Schemas of answers. Schemas of request bodies are generated from the input tables (schema_writer.c),
// and those of answers that have a table from it. The rows here are for answers that code writes
// member by member, and for values that are no objects.

#include "api/openapi/openapi_priv.h"

#include "api/http/problem.h"
#include "api/results/compare_flows.h"
#include "api/results/compare_json.h"
#include "api/results/events.h"
#include "api/results/grant_json.h"
#include "api/results/lease_json.h"
#include "api/results/line_json.h"
#include "api/results/measurement.h"
#include "api/results/results.h"
#include "api/results/run_json.h"
#include "api/results/service_json.h"
#include "api/results/verdict.h"
#include "api/run_state.h"
#include "api/scenario/examples.h"
#include "api/scenario/goods_json.h"
#include "api/scenario/review_members.h"
#include "api/scenario/submission.h"
#include "api/studies.h"
#include "api/study/study_document.h"
#include "api/study/study_json.h"
#include "api/study/study_trial.h"

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
#define FIGURES(name_, scope, help_)                                                               \
    {                                                                                              \
        .name = (name_), .help = (help_), .write = openapi__write_item_figures, .tag = (scope)     \
    }
#define WORDS(name_, words_, help_)                                                                \
    {                                                                                              \
        .name = (name_), .help = (help_), .words = (words_)                                        \
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
    ROW("verdicts", "[#Verdict]",                                                                  \
        "What the throughputs are to each other, in sentences: models_agree, models_disagree, "    \
        "too_early, more, less, equal, same, uncertain or no_throughput; and flows_differ"),       \
        ROW("flows", "[#CompareFlow]",                                                             \
            "Of the counters, outlets and sinks that both have; of runs"),                         \
        ROW("curve", "#CurveMeasures", "Between the curves"),                                      \
        ROW("density", "#DensityMeasures", "Between the densities",                                \
            .null = "one was measured, or not wanted")
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
LINE("DriveLine", drive_line, "drive", "DriveEvent");
LINE("BeltLine", belt_line, "belt", "BeltEvent");

// The same of a study; `status` has no id.
#define STUDY_LINE(title, name, word, data, ...)                                                   \
    static const member name##_members[] = {                                                       \
        __VA_ARGS__ ROW("study", "#Id", "Identifier of the study"),                                \
        ROW("event", "=" word, "Kind of event"),                                                   \
        ROW("data", "#" data, "Data of the event"),                                                \
    };                                                                                             \
    ROWS(title, name)
#define PLACE ROW("id", "#Count", "Place of the trial among those that have ended, from 1"),
#define LAST  ROW("id", "#Count", "One more than that of the last trial"),
STUDY_LINE("TrialLine", trial_line, "trial", "Trial", PLACE);
STUDY_LINE("StudyStatusLine", study_status_line, "status", "Study", );
STUDY_LINE("StudyEndLine", study_end_line, "end", "Study", LAST);

static const member trial_list_members[] = {
    ROW("trials", "[#Trial]", "A page of the list, by number"),
    ROW("has_more", "boolean", "Further ones follow"),
    ROW("next_from", "#Count", "The `from` of the page that follows", .flags = MEMBER_OPTIONAL),
};
ROWS("TrialList", trial_list);

static const member_table numbers_by_name = { .title = "NumbersByName" };
static const member_table values_by_name = { .title = "ValuesByName" };

static const member best_members[] = {
    ROW("name", "string", "For people; empty if none was given"),
    ROW("method", "#StudyMethodWord", "How its points are chosen"),
    ROW("is_ended", "boolean", "There is nothing more to try"),
    ROW("trials", "#Count", "Trials so far"),
    ROW("points", "#Count", "Points so far"),
    ROW("best", "#StudyPoint", "The point of the set that is chosen so far",
        .null = "there is none yet"),
    ROW("has_chance", "boolean",
        "Runs of a point at other substreams may differ; else each point is solved once"),
    ROW("set", "[#StudySetPoint]",
        "The points that may be best: all that are not worse than the best one by more than the "
        "indifference, or than what chance leaves open",
        .null = "not known: one run of each point, or a method that searches"),
    ROW("indifference", "number", "A difference of the first objective that counts as none",
        .flags = MEMBER_OPTIONAL),
    ROW("demand", "number", "With a demand: at least so much of the first objective",
        .flags = MEMBER_OPTIONAL),
    ROW("is_met", "boolean",
        "With a demand: the best point meets it; else it is the nearest one, and the set is empty",
        .flags = MEMBER_OPTIONAL),
    ROW("verdicts", "[#Verdict]",
        "What this says, in sentences: equal, alone, one_run_each, everything_through, edge, "
        "demand_met, demand_not_met, front, no_chance, no_value, confirmed, undecided or "
        "unconfirmed; of a base that is repeated replications and jams"),
    ROW("front", "[#StudyPoint]",
        "Where a second objective is given: the points to none of which another one is better in "
        "one of the two and not worse in the other, by their means",
        .flags = MEMBER_OPTIONAL),
    ROW("is_decided", "boolean", "Of screen: the selection ended by itself, with its confidence",
        .flags = MEMBER_OPTIONAL),
    ROW("confirmed", "[#ConfirmedPoint]", "Of screen: the points that the microscopic model tried",
        .flags = MEMBER_OPTIONAL),
    ROW("left_out", "[#LeftOutCurve]", "Of calibrate: each curve predicted from the others",
        .flags = MEMBER_OPTIONAL),
    ROW("profiles", "[#ParameterProfile]", "Of calibrate: what the curves say of each parameter",
        .flags = MEMBER_OPTIONAL),
    ROW("warnings", "[string]", "Reasons to doubt the best point", .flags = MEMBER_OPTIONAL),
};
ROWS("StudyBest", best);

static const member set_point_members[] = {
    ROW("point", "#Count", "Its number"),
    ROW("parameters", "#NumbersByName", "Its numbers, by their pointers"),
};
ROWS("StudySetPoint", set_point);

static const member point_members[] = {
    ROW("point", "#Count", "Its number"),
    ROW("model", "#Model", "Which solver"),
    ROW("parameters", "#NumbersByName", "Its numbers, by their pointers"),
    ROW("values", "#ValuesByName", "What its trials said"),
};
ROWS("StudyPoint", point);

static const member value_members[] = {
    ROW("n", "#Count", "Trials that have the value"),
    ROW("mean", "number", "Of them", .null = "none has it"),
    ROW("deviation", "number", "Standard deviation, of two trials or more",
        .flags = MEMBER_OPTIONAL),
    ROW("interval_95", "[number 2]", "Of the mean, by Student's distribution",
        .flags = MEMBER_OPTIONAL),
    ROW("jam_probability", "#StudyProbability", "Of jam.count: how many trials had jams",
        .flags = MEMBER_OPTIONAL),
};
ROWS("StudyValue", value);

static const member probability_members[] = {
    ROW("mean", "number", "Share of the trials", .null = "none has the value"),
    ROW("interval_95", "[number? 2]", "By Wilson's formula"),
};
ROWS("StudyProbability", probability);

static const member confirmed_members[] = {
    ROW("is_dropped", "boolean",
        "The selection has dropped it: worse than another one, or equal but for the indifference"),
    ROW("is_in_set", "boolean", "It may be the best one"),
    ROW("micro", "#StudyPoint", "What the microscopic model said"),
    ROW("macro", "#StudyPoint", "What the macroscopic model said"),
    ROW("difference", "number", "Objective of the macroscopic model minus that of the other",
        .null = "not known yet"),
};
ROWS("ConfirmedPoint", confirmed);

static const member left_out_members[] = {
    ROW("counter", "string", "Whose curve was left out"),
    ROW("rmse", "number", "Its distance from the one computed with what the others gave",
        .null = "not known yet", .unit = "parts"),
};
ROWS("LeftOutCurve", left_out);

static const member profile_members[] = {
    ROW("pointer", "string", "Which parameter"),
    ROW("is_identifiable", "boolean", "The curves determine it"),
    ROW("interval", "[number? 2]", "Where it lies with the confidence of the method"),
};
ROWS("ParameterProfile", profile);

// The first one, BF_OK, is no failure.
static const char *const status_words[] = {
#define X(code, word) word,
    BF_STATUS_LIST(X)
#undef X
        NULL
};

static const openapi_schema table[] = {
    TYPE("Id", "string",
         "\"pattern\":\"^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$\","
         "\"examples\":[\"0190a0b0-0000-7000-8000-000000000001\"]",
         "Name of a run, a study or a measurement: a UUID of version 7, so that ids sort by time"),
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
         "Name of a column of the curve: a counter, `left_domain`, `fallen`, or one of a feed or "
         "photo eye"),
    TYPE("ScenarioId", "string", "\"minLength\":1,\"maxLength\":64",
         "Id of another part of the scenario"),
    TYPE("Pair", "[number 2]", NULL, "Two numbers, of x and of y"),
    TYPE("Shape2", "[#Count 2]", NULL, "Rows and columns"),
    WORDS("RunStatus", run_state_words, "State of a run"),
    WORDS("StudyStatus", api_study_state_words, "State of a study"),
    WORDS("TrialStatus", api_trial_state_words, "State of a trial"),
    WORDS("StudyMethodWord", study_document_methods, "How a study chooses its points"),
    WORDS("Model", run_model_words, "A solver"),
    WORDS("MeasuredKind", api_measured_words, "What a measurement is"),
    WRITTEN("Colormap", openapi__write_colormaps,
            "Colour map of a picture; the first one is the default"),
    WORDS("ErrorCode", status_words + 1, "A kind of failure"),
    WRITTEN("ProblemType", openapi__write_problem_types, "A kind of problem"),
    OBJECT(run_json, "A run"),
    OBJECT(run_json_error, "Why a run, a trial or a study failed"),
    OBJECT(run_json_links, "The resources of a run"),
    OBJECT(run_json_list, "A page of the list of runs"),
    OBJECT(study_json, "A study"),
    { .name = "RunOrStudy",
      .help = "A run, or with replications a study of it",
      .one_of = "Run Study" },
    OBJECT(study_json_trials, "Numbers of a study's trials"),
    OBJECT(study_json_links, "The resources of a study"),
    OBJECT(study_json_list, "A page of the list of studies"),
    OBJECT(study_trial_members, "A trial of a study"),
    OBJECT(trial_list, "A page of a study's trials"),
    { .help = "A number for each name", .table = &numbers_by_name, .others = "number" },
    { .help = "A value for each objective", .table = &values_by_name, .others = "#StudyValue" },
    OBJECT(best, "What a study found so far"),
    OBJECT(point, "A point of a study"),
    OBJECT(set_point, "A point that may be the best one"),
    OBJECT(verdict_members, "What results say, in sentences"),
    OBJECT(verdict_figure_members, "A figure that a verdict rests on"),
    OBJECT(value, "A value of a point, from the trials that it has"),
    OBJECT(probability, "A probability"),
    OBJECT(confirmed, "A point that both models tried"),
    OBJECT(left_out, "A curve that was left out"),
    OBJECT(profile, "What curves say of a parameter"),
    WRITTEN("KeyFigures", openapi__write_figures, "Key figures; what a run cannot say is missing"),
    FIGURES("RunFigures", FIGURE_OF_RUN, "Key figures of a run alone"),
    FIGURES("FeedFigures", FIGURE_OF_FEED, "Key figures of a feed"),
    FIGURES("CounterFigures", FIGURE_OF_COUNTER, "Key figures of a counter"),
    FIGURES("PhotoEyeFigures", FIGURE_OF_EYE, "Key figures of a photo eye"),
    FIGURES("BeltFigures", FIGURE_OF_BELT,
            "Key figures of a belt that a schedule or a photo eye commands"),
    FIGURES("FailureFigures", FIGURE_OF_FAILURE, "Key figures of a kind of failure of a belt"),
    FIGURES("OutletFigures", FIGURE_OF_OUTLET,
            "Key figures of a belt from which cargo leaves the domain, beside others or sinks"),
    FIGURES("SinkFigures", FIGURE_OF_SINK, "Key figures of a sink"),
    OBJECT(submission_validation_members, "A submission that is valid"),
    OBJECT(submission_part_members, "A part at the start"),
    OBJECT(review_validity_members, "Whether a model was compared for scenarios like this one"),
    OBJECT(review_like_members, "What scenes like this one say of the model"),
    OBJECT(review_outside_members,
           "A figure of a scenario that is out of its range or was never compared"),
    OBJECT(review_warning_members, "A reason to doubt the results; it is no fault"),
    OBJECT(results_curve_members, "Outflow curve"),
    { .help = "A list for each column under its name, each as long as that of the times: parts in "
              "each counter, under its id; `left_domain`, that have left the domain; `fallen` off "
              "the belts, where some of the domain is under no belt; of each feed "
              "`<feed>.offered`, `.admitted`, `.waiting` and `.discarded`; of each photo eye "
              "`<eye>.blocked`; of each belt whose speed changes `<belt>.speed_m_s`; of each kind "
              "of failure `<failure>.failed`, 1 while a belt is down by it; with feeds, of each "
              "belt from which cargo leaves the domain, where there are several, `<belt>.left`",
      .table = &results_columns_members,
      .others = "[number]" },
    OBJECT(results_changes_members, "What the photo eyes of a run saw and did"),
    OBJECT(results_eye_members, "A photo eye changed its state"),
    OBJECT(results_action_members, "An action of a photo eye was carried out"),
    OBJECT(results_drive_members, "Cargo holds an obstacle back, or no longer"),
    OBJECT(results_stop_members, "A failure or a break stops a belt, or no longer"),
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
    OBJECT(line_json_item, "A line"),
    OBJECT(line_json_list, "A page of the list of lines"),
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
    OBJECT(compare_flow_members, "The flow of a counter, an outlet or a sink in two runs"),
    OBJECT(compare_json_density_distance, "Distance of two densities at a common time"),
    OBJECT(examples_members, "The ready scenarios"),
    OBJECT(examples_item_members, "A ready scenario"),
    OBJECT(goods_json_members, "Usual goods and frictions"),
    OBJECT(goods_json_item, "Goods of a name"),
    OBJECT(goods_json_surface, "A surface"),
    OBJECT(goods_json_friction, "The friction of two surfaces"),
    OBJECT(service_json_alive_members, "The process answers"),
    OBJECT(service_json_ready_members, "Runs are accepted"),
    OBJECT(service_json_version_members, "Version of the service"),
    OBJECT(service_json_ticket_members, "What stands for an access token in a URL"),
    OBJECT(grant_json_list_members, "Grants that count"),
    OBJECT(grant_json_members, "An access token that reads one run or study"),
    OBJECT(service_json_quotas_members, "What an owner uses and may use"),
    OBJECT(service_json_quota_members, "What is used of a quota"),
    OBJECT(lease_json_lease, "Jobs that a worker has for a time"),
    OBJECT(lease_json_job, "A job: an attempt at a run"),
    OBJECT(lease_json_states, "What is known of jobs"),
    OBJECT(lease_json_state, "What is known of a job, and asked of its worker"),
    OBJECT(lease_json_workers, "The workers"),
    OBJECT(lease_json_worker, "A worker"),
    OBJECT(lease_json_view, "A lease of a worker"),
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
    TYPE("Frames", "string", "\"format\":\"binary\"",
         "Bytes of frames, as solvers read and write them"),
    TYPE("Metrics", "string", NULL, "A line for each metric: its name, its labels, its value"),
    TYPE("EventStream", "string",
         "\"contentMediaType\":\"application/json\",\"contentSchema\":"
         "{\"$ref\":\"#/components/schemas/EventData\"}",
         "Server-sent events. `event` is one of status, progress, curve, snapshot, figures, "
         "photo_eye, action, drive, belt and end, of a study trial, status and end; `data` is an "
         "object in one line; `id` rises. A comment is sent while there are no events"),
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
                "PhotoEyeEvent ActionEvent DriveEvent BeltEvent Trial Study" },
    OBJECT(events_status_data, "The run has changed its state; the whole run"),
    OBJECT(events_progress_data, "Progress of the run"),
    OBJECT(events_curve_data, "Samples of the outflow curve"),
    OBJECT(events_snapshot_data, "A snapshot was taken"),
    OBJECT(events_end_data, "The run has ended; its last event"),
    OBJECT(events_figures_data, "Key figures so far"),
    OBJECT(events_eye_data, "A photo eye changed its state"),
    OBJECT(events_action_data, "An action of a photo eye was carried out"),
    OBJECT(events_drive_data, "Cargo holds an obstacle back, or no longer"),
    OBJECT(events_belt_data, "A failure or a break stops a belt, or no longer"),
    { .name = "EventLine",
      .help = "An event",
      .one_of = "StatusLine ProgressLine CurveLine SnapshotLine EndLine FiguresLine PhotoEyeLine "
                "ActionLine DriveLine BeltLine TrialLine StudyStatusLine StudyEndLine" },
    OBJECT(status_line, "A status event"),
    OBJECT(progress_line, "A progress event"),
    OBJECT(curve_line, "A curve event"),
    OBJECT(snapshot_line, "A snapshot event"),
    OBJECT(end_line, "An end event"),
    OBJECT(figures_line, "A figures event"),
    OBJECT(eye_line, "An event of a photo eye"),
    OBJECT(action_line, "An event of an action"),
    OBJECT(drive_line, "An event of a drive"),
    OBJECT(belt_line, "An event of a belt that fails or has a break"),
    OBJECT(trial_line, "A trial of a study has ended"),
    OBJECT(study_status_line, "A study has changed"),
    OBJECT(study_end_line, "A study has ended; its last event"),
};

// Of the bodies of formats that are not JSON; a row each.
static const char *const format_schemas[] = {
    [MEDIA_JSON] = NULL,         [MEDIA_CSV] = "Csv",           [MEDIA_NPY] = "Npy",
    [MEDIA_PNG] = "Png",         [MEDIA_VTI] = "Vtk",           [MEDIA_VTP] = "Vtk",
    [MEDIA_PVD] = "Pvd",         [MEDIA_ZIP] = "Zip",           [MEDIA_PROMETHEUS] = "Metrics",
    [MEDIA_SSE] = "EventStream", [MEDIA_NDJSON] = "EventLines", [MEDIA_FRAMES] = "Frames",
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
