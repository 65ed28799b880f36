#include "api/results/measurement.h"

#include "api/json/text.h"
#include "api/results/results.h"
#include "api/scenario/feed_csv.h"
#include "core/base/memory.h"
#include "core/scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT_COLUMN    "count"
#define COUNTER_DEFAULT "upstream" // as a scenario has it

enum { SAMPLES_MIN = 2 };

// What a JSON body is read into.
typedef struct body {
    char label[API_LABEL_SIZE];
    char counter[SCENE_ID_SIZE];
    double *t;
    size_t n_t;
    double *counts;
    size_t n_counts;
} body;

static const bf_range not_negative = { .minimum = 0.0, .maximum = INFINITY };

#define AT(place) offsetof(body, place)
static const member members[] = {
    MEMBER("label", text, AT(label), "the client's own name of the measurement",
           .limit = API_LABEL_SIZE, .flags = MEMBER_INIT),
    MEMBER("counter", text, AT(counter), "which column of a curve was measured", .least = 1,
           .limit = SCENE_ID_SIZE, .flags = MEMBER_INIT),
    MEMBER("t_s", numbers, AT(t), "times of the samples, rising", .unit = "s", .offset_n = AT(n_t),
           .least = SAMPLES_MIN, .limit = API_MEASUREMENT_SAMPLES_MAX),
    MEMBER(COUNT_COLUMN, numbers, AT(counts), "what was counted at these times", .unit = "parts",
           .range = &not_negative, .offset_n = AT(n_counts), .least = SAMPLES_MIN,
           .limit = API_MEASUREMENT_SAMPLES_MAX),
};
#undef AT

static void init_body(void *item, size_t place)
{
    (void)place;
    *(body *)item = (body){ .counter = COUNTER_DEFAULT };
}

const member_table measurement_members = { MEMBER_TABLE("measurement", members),
                                           .size = sizeof(body), .init = init_body };

// Samples that are checked, and the lines in which they stand (NULL: JSON).
typedef struct samples {
    size_t n;
    const double *t;
    const double *counts;
    const size_t *lines;
} samples;

static const char *place_of(const samples *s, const char *list, size_t k, char *pointer,
                            size_t size)
{
    if (s->lines != NULL)
        snprintf(pointer, size, "/line/%zu", s->lines[k]);
    else
        snprintf(pointer, size, "/%s/%zu", list, k);
    return pointer;
}

static void check_samples(const samples *s, bf_faults *faults)
{
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n; k++) {
        if (k > 0 && !(s->t[k] > s->t[k - 1]))
            faults_add(faults, place_of(s, "t_s", k, pointer, sizeof pointer),
                       "times must rise: %.9g s follows %.9g s", s->t[k], s->t[k - 1]);
        if (!(s->counts[k] >= 0.0))
            faults_add(faults, place_of(s, COUNT_COLUMN, k, pointer, sizeof pointer),
                       "must not be negative, as %.9g is", s->counts[k]);
    }
}

static void check_counter(const char *counter, const char *pointer, bf_faults *faults)
{
    if (!scene_is_id(counter))
        faults_add(faults, pointer, "must be 1 to %d letters, digits, '_', '.' and '-'",
                   SCENE_ID_SIZE - 1);
    else if (strcmp(counter, "t_s") == 0)
        faults_add(faults, pointer, "'t_s' is the time");
}

static bf_status make_measurement(const samples *s, const char *label, const char *counter,
                                  measurement *ret_measurement, bf_error *err)
{
    measurement made = { .curve = { .n = s->n, .n_columns = 1 } };
    size_t n_bytes = s->n * sizeof(double);

    snprintf(made.about.label, sizeof made.about.label, "%s", label);
    snprintf(made.about.counter, sizeof made.about.counter, "%s", counter);
    made.about.n_samples = s->n;
    made.about.t_start = s->t[0];
    made.about.t_end = s->t[s->n - 1];
    if (buffer_append(&made.curve.columns, counter, strlen(counter)) != BF_OK ||
        buffer_append(&made.curve.t, s->t, n_bytes) != BF_OK ||
        buffer_append(&made.curve.values, s->counts, n_bytes) != BF_OK) {
        measurement_fini(&made);
        return bf_fail_memory(err);
    }
    *ret_measurement = made;
    return BF_OK;
}

static bf_status read_body(json_in *in, const struct json_t *root, body *b,
                           measurement *ret_measurement, bf_error *err)
{
    members_read(in, root, &measurement_members, b);
    if (in->has_failed || in->faults->n > 0)
        return json_in_status(in, err);
    check_counter(b->counter, "/counter", in->faults);
    if (b->n_t != b->n_counts)
        faults_add(in->faults, "/" COUNT_COLUMN, "has %zu items, but /t_s has %zu", b->n_counts,
                   b->n_t);
    const samples s = { .n = b->n_t < b->n_counts ? b->n_t : b->n_counts,
                        .t = b->t,
                        .counts = b->counts };
    check_samples(&s, in->faults);
    BF_TRY(json_in_status(in, err));
    return make_measurement(&s, b->label, b->counter, ret_measurement, err);
}

bf_status measurement_read_json(const char *json, size_t n, measurement *ret_measurement,
                                bf_faults *faults, bf_error *err)
{
    json_in in = json_in_to(faults);
    struct json_t *root = json_in_parse(&in, json, n);
    body b;

    if (root == NULL)
        return json_in_status(&in, err);
    init_body(&b, 0);
    bf_status status = read_body(&in, root, &b, ret_measurement, err);
    json_in_free(root);
    memory_free(b.t);
    memory_free(b.counts);
    return status;
}

static void check_label(const char *label, bf_faults *faults)
{
    if (strlen(label) >= API_LABEL_SIZE)
        faults_add_limit(faults, "/label", "has %zu bytes, the limit is %d", strlen(label),
                         API_LABEL_SIZE - 1);
    else if (!text_is_utf8(label))
        faults_add(faults, "/label", "must be UTF-8");
}

// The counter that the column belongs to, as the request or else the column says.
static void choose_counter(const char *column, const char *wanted, char *ret_counter,
                           bf_faults *faults)
{
    bool is_count = strcmp(column, COUNT_COLUMN) == 0;

    if (wanted == NULL) {
        snprintf(ret_counter, SCENE_ID_SIZE, "%s", is_count ? COUNTER_DEFAULT : column);
        check_counter(ret_counter, "/line/1", faults);
        return;
    }
    check_counter(wanted, "/counter", faults);
    if (!is_count && strcmp(column, wanted) != 0)
        faults_add(faults, "/line/1", "the first column is neither '" COUNT_COLUMN "' nor '%.64s'",
                   wanted);
    snprintf(ret_counter, SCENE_ID_SIZE, "%s", wanted);
}

// Buffers of a CSV text that is read.
typedef struct columns {
    bf_buffer t;
    bf_buffer counts;
    bf_buffer lines;
} columns;

// What is wrong with the text is a fault of the document like others.
static bf_status note(bf_status status, const bf_error *why, bf_faults *faults, bf_error *err)
{
    if (status == BF_EINPUT)
        faults_add_error(faults, why);
    if (status == BF_OK || status == BF_EINPUT)
        return faults_status(faults, err);
    if (err != NULL)
        *err = *why;
    return status;
}

static bf_status read_columns(const char *text, size_t n, const char *column, columns *c,
                              samples *ret_samples, bf_faults *faults, bf_error *err)
{
    bf_error why = { 0 };

    bf_status status = results_read_curve_csv(text, n, column, &c->t, &c->counts, &c->lines, &why);
    if (status == BF_OK) {
        *ret_samples = (samples){ .n = c->t.n / sizeof(double),
                                  .t = (const double *)(const void *)c->t.bytes,
                                  .counts = (const double *)(const void *)c->counts.bytes,
                                  .lines = (const size_t *)(const void *)c->lines.bytes };
        char pointer[BF_POINTER_SIZE];
        if (ret_samples->n < SAMPLES_MIN)
            faults_add(faults, "/line/1", "must be followed by at least %d samples, not %zu",
                       SAMPLES_MIN, ret_samples->n);
        if (ret_samples->n > API_MEASUREMENT_SAMPLES_MAX)
            faults_add_limit(
                faults,
                place_of(ret_samples, "", API_MEASUREMENT_SAMPLES_MAX, pointer, sizeof pointer),
                "is the first of too many: there are %zu samples, the limit is %d", ret_samples->n,
                API_MEASUREMENT_SAMPLES_MAX);
        else
            check_samples(ret_samples, faults);
    }
    return note(status, &why, faults, err);
}

bf_status measurement_read_csv(const char *text, size_t n, const char *label, const char *counter,
                               measurement *ret_measurement, bf_faults *faults, bf_error *err)
{
    char column[SCENE_ID_SIZE], belongs_to[SCENE_ID_SIZE];
    columns c = { .t = { 0 } };
    bf_error why = { 0 };
    samples s = { 0 };

    if (label == NULL)
        label = "";
    check_label(label, faults);
    bf_status status = results_read_curve_column(text, n, column, &why);
    if (status != BF_OK)
        return note(status, &why, faults, err);
    choose_counter(column, counter, belongs_to, faults);
    status = read_columns(text, n, column, &c, &s, faults, err);
    if (status == BF_OK)
        status = make_measurement(&s, label, belongs_to, ret_measurement, err);
    buffer_fini(&c.t);
    buffer_fini(&c.counts);
    buffer_fini(&c.lines);
    return status;
}

bf_status measurement_read_feed(const char *text, size_t n, api_measured kind, const char *label,
                                measurement *ret_measurement, bf_faults *faults, bf_error *err)
{
    measurement made = { .about = { .kind = kind } };
    json_in in = json_in_to(faults);
    feed_csv_about about;

    if (label == NULL)
        label = "";
    check_label(label, faults);
    if (strlen(text) != n)
        faults_add(faults, "", "must not have zero bytes");
    else if (faults->n == 0 &&
             (kind == API_MEASURED_PROFILE ? feed_csv_check_profile(&in, text, &about)
                                           : feed_csv_check_schedule(&in, text, &about)) &&
             buffer_append(&made.csv, text, n) != BF_OK)
        in.has_failed = true;
    const bf_status status = json_in_status(&in, err);
    if (status != BF_OK) {
        measurement_fini(&made);
        return status;
    }
    snprintf(made.about.label, sizeof made.about.label, "%s", label);
    made.about.n_samples = about.n;
    made.about.t_start = about.t_start;
    made.about.t_end = about.t_end;
    *ret_measurement = made;
    return BF_OK;
}

static bool is_curve(const void *item)
{
    return ((const api_measurement *)item)->kind == API_MEASURED_CURVE;
}

static bool is_text(const void *item)
{
    return !is_curve(item);
}

#define AT(place) offsetof(api_measurement, place)
static const member link_members[] = {
    MEMBER("self", link, AT(id), "The resource itself", .path = "/v1/measurements/{id}"),
};
const member_table measurement_links = { MEMBER_TABLE("SelfLinks", link_members) };

static const member item_members[] = {
    MEMBER("id", text, AT(id), "Identifier of the measurement", .type = "#Id"),
    MEMBER("kind", enum, AT(kind), "What it is for feeds; missing of a measured curve",
           .words = api_measured_words, .type = "#MeasuredKind", .applies = is_text),
    MEMBER("label", text, AT(label),
           "The client's own name of the measurement; empty if none was given"),
    MEMBER("counter", text, AT(counter), "Of a measured curve: which column of a curve it is",
           .type = "#CounterId", .applies = is_curve),
    MEMBER("created_at", time, AT(created_ms), "When it was stored"),
    MEMBER("owner", text, AT(owner), "Whose it is, where the service has tokens",
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("n_samples", size, AT(n_samples), "Number of samples or rows"),
    MEMBER("t_start_s", number, AT(t_start), "Time of the first sample", .unit = "s"),
    MEMBER("t_end_s", number, AT(t_end), "Time of the last sample", .unit = "s"),
    MEMBER("links", object, 0, "Its resource", .table = &measurement_links),
};
const member_table measurement_item = { MEMBER_TABLE("MeasurementItem", item_members),
                                        .size = sizeof(api_measurement) };
#undef AT

#define AT(place) offsetof(api_page, place)
static const member measurement_list_members[] = {
    MEMBER("measurements", array, AT(measurements), "A page of the list, newest first",
           .offset_n = AT(n), .table = &measurement_item),
    MEMBER("has_more", bool, AT(has_more), "Older ones follow"),
    MEMBER("next_cursor", text, AT(next_cursor), "The `cursor` of the page that follows",
           .flags = MEMBER_OMIT_EMPTY),
};
const member_table measurement_list = { MEMBER_TABLE("MeasurementList", measurement_list_members) };
#undef AT

// A measurement with its samples or its text, as it is answered.
typedef struct stored {
    api_measurement about; // first, for its members' rules
    const char *csv;
    const double *t;
    const double *counts;
    size_t n;
} stored;

#define AT(place) offsetof(stored, place)
static const member stored_members[] = {
    MEMBER_INLINE(&measurement_item, AT(about)),
    MEMBER("t_s", numbers, AT(t), "Of a curve: times of the samples", .unit = "s",
           .offset_n = AT(n), .applies = is_curve),
    MEMBER(COUNT_COLUMN, numbers, AT(counts), "Of a curve: what was counted at each time",
           .unit = "parts", .offset_n = AT(n), .applies = is_curve),
    MEMBER("csv", string, AT(csv), "Its text where it is no curve", .applies = is_text),
};
const member_table measurement_stored = { MEMBER_TABLE("StoredMeasurement", stored_members) };
#undef AT

bf_status measurement_json(const api_measurement *about, const api_curve *curve,
                           const bf_buffer *csv, bf_buffer *out, bf_error *err)
{
    const stored view = { .about = *about,
                          .csv = csv->bytes,
                          .t = (const double *)(const void *)curve->t.bytes,
                          .counts = (const double *)(const void *)curve->values.bytes,
                          .n = curve->n };
    json_out w = json_out_to(out);

    members_write(&w, &measurement_stored, &view);
    return json_out_status(&w, err);
}

void measurement_fini(measurement *m)
{
    if (m == NULL)
        return;
    api_curve_fini(&m->curve);
    buffer_fini(&m->csv);
    *m = (measurement){ 0 };
}
