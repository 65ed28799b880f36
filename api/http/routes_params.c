// The parameters of routes: one row each, also where several routes have it.

#include "api/http/routes_params.h"

#include "api/http/http_priv.h"
#include "api/http/run_sort.h"
#include "api/json/text.h"
#include "api/results/colormap.h"
#include "api/results/picture.h"
#include "api/scenario/condition.h"
#include "api/scenario/submission.h"

#define TEXT_OF(macro)   TEXT_OF_IT(macro)
#define TEXT_OF_IT(text) #text

#define PARAM(in_, name_, kind_, ...)                                                              \
    {                                                                                              \
        .name = (name_), .in = (in_), .kind = &param_##kind_, __VA_ARGS__                          \
    }
#define PATH(name_, kind_, ...)   PARAM("path", name_, kind_, .is_required = true, __VA_ARGS__)
#define QUERY(name_, kind_, ...)  PARAM("query", name_, kind_, __VA_ARGS__)
#define HEADER(name_, kind_, ...) PARAM("header", name_, kind_, __VA_ARGS__)

static bool is_state(const char *text)
{
    return text_find_word(run_state_words, RUN_STATE_COUNT, text) != RUN_STATE_COUNT;
}

static bool is_model(const char *text)
{
    return text_has_word(run_model_words, text);
}

static bool is_study_state(const char *text)
{
    return text_find_word(api_study_state_words, API_STUDY_STATES, text) != API_STUDY_STATES;
}

static bool is_measured_kind(const char *text)
{
    return text_has_word(api_measured_words, text);
}

static bool is_colormap(const char *text)
{
    return colormap_find(text) != NULL;
}

const param routes__run_id = PATH("id", id, .help = "Which run");
const param routes__study_id = PATH("id", id, .help = "Which study");
const param routes__lease_id = PATH("id", id, .help = "Which lease");

// One of several that are counted.
#define COUNTED(word, what) PATH(word, whole, .type = "#Count", .most = UINT64_MAX, .help = what)

const param routes__trial_number = COUNTED("number", "Which trial, from 0");
const param routes__grant_number = COUNTED("number", "Which grant");
const param routes__snapshot_n = COUNTED("n", "Which snapshot, from 0");

const param routes__measurement_id = PATH("id", id, .help = "Which measurement");

const param routes__example_name =
    PATH("name", text, .limits = "\"pattern\":\"^[a-z0-9-]+$\"", .help = "Which ready scenario");

const param routes__problem_word = PATH("kind", text, .limits = "\"pattern\":\"^[a-z-]+$\"",
                                        .help = "The last segment of a problem's type");

const param routes__compared_a = QUERY(
    "a", id,
    .help = "The first of two runs or measurements, and the reference; with b, without `runs`");

const param routes__compared_b = QUERY("b", id, .help = "The second of them");

const param routes__compared_runs =
    QUERY("runs", ids, .least = 2, .most = API_COMPARE_MAX,
          .help = "Which runs and measurements, with commas between; without a and b");

const param routes__reference =
    QUERY("reference", text, .type = "#Id",
          .help = "Which of `runs` the others are compared with; the first one if missing");

const param routes__column = QUERY("column", text, .type = "#ColumnName",
                                   .help = "Which column of the curves is compared; the first one "
                                           "of the reference that all have if missing");

const param routes__csv_label = QUERY("label", member, .most = API_LABEL_SIZE - 1,
                                      .help = "The label of the measurement", .formats = "csv");

const param routes__csv_counter =
    QUERY("counter", member, .type = "#CounterId",
          .help = "Which column of a curve was measured; the name of its own if missing",
          .formats = "csv");

const param routes__csv_kind =
    QUERY("kind", word, .type = "#MeasuredKind", .is_word = is_measured_kind,
          .help = "A curve to compare with, or for feeds a profile or a schedule, their list of "
                  "arrivals; a curve if missing",
          .formats = "csv");

const param routes__run_status = QUERY("status", word, .type = "#RunStatus", .is_word = is_state,
                                       .help = "Only runs in this state");

const param routes__run_model_word =
    QUERY("model", word, .type = "#Model", .is_word = is_model, .help = "Only runs of this model");

const param routes__run_label =
    QUERY("label", text, .most = API_LABEL_SIZE - 1, .help = "Only runs with this label");

const param routes__of_line =
    QUERY("line", text, .most = API_LABEL_SIZE - 1, .help = "Only those that belong to this line");

const param routes__of_owner =
    QUERY("owner", text, .most = API_OWNER_SIZE - 1,
          .help = "Only what is this owner's; of another one than the sender it needs the scope "
                  "admin");

const param routes__run_search = QUERY(
    "search", text, .most = API_LABEL_SIZE - 1,
    .help = "Only runs whose name, label or line contains this, A to Z being the same as a to z");

const param routes__run_sort =
    QUERY("sort", word, .type = "string",
          .limits = "\"default\":\"-created\",\"examples\":[\"name\",\"-throughput_per_h\","
                    "\"residence_s.p95\"]",
          .is_word = run_sort_is_word, .list_words = run_sort_words,
          .help = "The order: created, finished, name, label, model, status, or a key figure of "
                  "the run, rising; falling with `-` before it. Runs without a value come last");

const param routes__run_created_from =
    QUERY("created_from", time, .help = "Only runs that were accepted then or later");

const param routes__run_created_before =
    QUERY("created_before", time, .help = "Only runs that were accepted earlier");

const param routes__run_starred =
    QUERY("starred", flag, .default_text = "0", .most = 1, .help = "1: only starred runs");

static bf_status read_where(const param *row, const char *text, param_value *ret_value,
                            bf_error *err)
{
    api_conditions conditions;
    bf_error fault;

    (void)ret_value;
    if (condition_list_read(text, &conditions, &fault) == BF_OK)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "query parameter '%s': %s", row->name, fault.text);
}

static const param_kind kind_where = { "string", read_where, NULL };

const param routes__run_where = {
    .name = "where",
    .in = "query",
    .kind = &kind_where,
    .limits = "\"examples\":[\"angle_deg>50\",\"cargo/mass_kg<=2,throughput_per_h>20000\"]",
    .help = "Only runs in whose scenario or key figures numbers are so: at most 4 conditions with "
            "commas between, a name, "
            "<, <=, =, >= or >, and a number. The name is a member's, or the end of its JSON "
            "pointer; any member of this "
            "name will do; numbers with the same six significant digits are equal. `angle_deg` is "
            "also of a straight plate that is written by its ends, "
            "`speed_m_s` the speed of a belt",
};

const param routes__run_count = QUERY("count", flag, .default_text = "0", .most = 1,
                                      .help = "1: the answer has the `total` of all pages");

const param routes__run_cursor = { .name = "cursor",
                                   .in = "query",
                                   .kind = &run_sort_cursor_kind,
                                   .help = "Where the page begins; take it from the `next` link" };

const param routes__run_study = QUERY(
    "study", id,
    .help = "The runs of this study's trials; if missing, only runs that are nobody's trials");

const param routes__study_status =
    QUERY("status", word, .type = "#StudyStatus", .is_word = is_study_state,
          .help = "Only studies in this state");

const param routes__trials_from =
    QUERY("from", whole, .type = "#Count", .default_text = "0", .most = STUDY_TRIALS_MAX,
          .help = "Number of the first trial on the page", .formats = "json");

const param routes__trials_limit =
    QUERY("limit", whole, .default_text = "100", .least = 1, .most = API_TRIALS_PAGE_MAX,
          .help = "Trials on a page", .formats = "json");

const param routes__measurement_label =
    QUERY("label", text, .most = API_LABEL_SIZE - 1, .help = "Only measurements with this label");

const param routes__page_limit = QUERY("limit", whole, .default_text = "50", .least = 1,
                                       .most = API_LIST_MAX, .help = "Items on a page");

const param routes__page_cursor =
    QUERY("cursor", cursor, .help = "Where the page begins; take it from the `next` link");

const param routes__wait_s =
    QUERY("wait", whole, .default_text = "0", .most = API_WAIT_MAX_S,
          .help = "Answer when the run has ended, or with If-None-Match when it is another, at the "
                  "latest after so many seconds [s]");

const param routes__format =
    QUERY("format", format, .help = "The format, in preference to what the Accept header asks for");

const param routes__snapshot_count = QUERY(
    "count", whole, .least = 1, .most = EXCHANGE_SNAPSHOTS_MAX,
    .help = "So many snapshots from this one on, their files one after the other, as numpy.load() "
            "reads them from one file: as many as there are, and as 4 MB hold. Default: 1",
    .formats = "npy");

const param routes__picture_width =
    QUERY("width", whole, .least = 1, .most = PICTURE_WIDTH_MAX,
          .help = "Its width in pixels; some 1000 if missing", .formats = "png");

const param routes__picture_colormap =
    QUERY("colormap", word, .type = "#Colormap", .is_word = is_colormap,
          .list_words = colormap_words, .help = "Its colours", .formats = "png");

const param routes__picture_max =
    QUERY("max", real, .default_text = TEXT_OF(PICTURE_TOP), .least_real = 1e-3, .most_real = 1e3,
          .help = "The density at the end of the scale; 1 is close packing", .formats = "png");

const param routes__with_vtk = QUERY("vtk", flag, .default_text = "0", .most = 1,
                                     .help = "1: with files for ParaView beside the others");

const param routes__with_densities =
    QUERY("densities", flag, .default_text = "1", .most = 1,
          .help = "0: without the densities, which take most time");

const param routes__start_parts =
    QUERY("parts", whole, .default_text = "0", .most = SUBMISSION_PARTS_MAX,
          .help = "How many of the parts at the start are listed at most");

const param routes__followed_runs =
    QUERY("runs", ids, .least = 1, .most = API_STREAM_RUNS_MAX, .is_required = true,
          .help = "Which runs, with commas between");

const param routes__inline_grids = QUERY("inline", flag, .default_text = "0", .most = 1,
                                         .help = "1: snapshot events contain the grid, as `data`");

const param routes__last_event_id =
    QUERY("last_event_id", whole, .type = "#Count", .default_text = "0", .most = UINT64_MAX,
          .help = "Only events after the one with this id; the header Last-Event-ID counts more");

const param routes__idempotency_key =
    HEADER("Idempotency-Key", text, .limits = "\"minLength\":1",
           .help = "Any text: a request with the same key and body gets the first answer again");

const param routes__if_match =
    HEADER("If-Match", text, .help = "The ETag that the resource must still have");

const param routes__if_none_match =
    HEADER("If-None-Match", text,
           .help = "The ETag of an answer before; 304 if nothing has changed since");

const param routes__if_range =
    HEADER("If-Range", text, .help = "The ETag that the bytes asked for must still belong to",
           .formats = "npy png vti vtp");

const param routes__last_event_id_header =
    HEADER("Last-Event-ID", whole, .type = "#Count",
           .help = "Only events after the one with this id; browsers send it by themselves");

const param routes__prefer = HEADER(
    "Prefer", text, .limits = "\"examples\":[\"wait=30\"]",
    .help =
        "`wait=N`: answer when the run has ended, at the latest after N seconds, 60 at most [s]");

const param routes__range =
    HEADER("Range", text, .limits = "\"examples\":[\"bytes=0-1023\"]",
           .help = "Which bytes of a binary body", .formats = "npy png vti vtp");
