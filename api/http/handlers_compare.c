// Runs and measurements against a reference among them: their curves by core/compare.
//
// Memory  one column of two curves is held at a time, then two snapshots, however many are compared.

#include "api/http/access.h"
#include "api/http/http_priv.h"
#include "api/json/json_out.h"
#include "api/results/compare_json.h"
#include "api/results/compare_verdict.h"
#include "core/base/memory.h"
#include "core/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// A run or a measurement.
typedef struct entry {
    char id[API_ID_SIZE];        // as the query has it
    char pointer[32];            // where: "/a", "/runs/2"
    bool is_run;                 // which of the two is filled:
    api_run run;                 // of a run
    api_measurement measurement; // of a measurement
    bf_buffer columns;           // of its curve
    compare_figures figures;     // of its curve
    compare_measures measures;   // against the reference, which is a; not filled of itself
    bool has_side;               // its scenario can be read by this version:
    compare_side side;           // what verdicts are about
    compare_flows flows;         // of a run
} entry;

// What one request compares.
typedef struct comparison {
    bool is_pair; // requested by a and b
    size_t n;
    size_t reference; // index
    entry entries[API_COMPARE_MAX];
    char column[COLUMN_NAME_SIZE]; // that is compared
} comparison;

static const double s_per_h = 3600.0;

enum { PIECE_SAMPLES = 4096 }; // of a run's curve that are read at once

// A column of a curve, owned.
typedef struct column {
    bf_buffer t;
    bf_buffer parts;
} column;

static void fini_column(column *c)
{
    buffer_fini(&c->t);
    buffer_fini(&c->parts);
}

static bf_status read_pair(exchange *x, comparison *c, bf_error *err)
{
    static const char *const names[] = { "a", "b" };

    c->is_pair = true;
    c->n = 2;
    for (size_t i = 0; i < 2; i++) {
        const char *id = exchange__text(x, names[i]);
        entry *e = &c->entries[i];
        if (id == NULL)
            return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is missing: the id of a run",
                           names[i]);
        snprintf(e->pointer, sizeof e->pointer, "/%s", names[i]);
        snprintf(e->id, sizeof e->id, "%s", id);
    }
    return BF_OK;
}

static bf_status read_runs(const exchange *x, comparison *c, bf_error *err)
{
    const char *reference = exchange__text(x, "reference");
    char ids[API_COMPARE_MAX][API_ID_SIZE];

    c->n = exchange__ids(x, "runs", ids);
    if (c->n == 0)
        return bf_fail(err, BF_EINPUT, "", "query parameter 'runs' is missing: ids with commas");
    c->reference = reference == NULL ? 0 : c->n;
    for (size_t i = 0; i < c->n; i++) {
        memcpy(c->entries[i].id, ids[i], sizeof ids[i]);
        snprintf(c->entries[i].pointer, sizeof c->entries[i].pointer, "/runs/%zu", i);
        if (reference != NULL && strcmp(ids[i], reference) == 0)
            c->reference = i;
    }
    if (c->reference < c->n)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "/reference", "'%.64s' is not one of the runs", reference);
}

static bf_status read_query(exchange *x, comparison *c, bf_error *err)
{
    bool has_pair = exchange__text(x, "a") != NULL || exchange__text(x, "b") != NULL;
    bool has_runs = exchange__text(x, "runs") != NULL || exchange__text(x, "reference") != NULL;

    if (has_pair && has_runs)
        return bf_fail(err, BF_EINPUT, "",
                       "either 'a' and 'b', or 'runs' and 'reference', not both");
    if (!has_pair && !has_runs)
        return bf_fail(err, BF_EINPUT, "",
                       "query parameter 'runs' is missing: two to %d ids, with commas",
                       API_COMPARE_MAX);
    return has_pair ? read_pair(x, c, err) : read_runs(x, c, err);
}

// Finds a run, or else a measurement, and the columns of its curve.
static bf_status find_entry(exchange *x, entry *e, bf_error *err)
{
    const api_services *services = x->services;
    api_curve curve = { 0 };

    bf_status status = access_find_run(x, e->id, &e->run, err);
    e->is_run = status == BF_OK;
    if (status == BF_ENOTFOUND)
        status = access_find_measurement(x, e->id, &e->measurement, err);
    if (status == BF_ENOTFOUND)
        return exchange__refuse(x, 404, e->pointer, err, "there is nothing with the id '%s'",
                                e->id);
    if (status == BF_OK && !e->is_run && e->measurement.kind != API_MEASURED_CURVE)
        return exchange__refuse(x, 422, e->pointer, err, "measurement '%s' is a %s, not a curve",
                                e->id, api_measured_words[e->measurement.kind]);
    if (status == BF_OK && e->is_run && e->run.n_samples == 0)
        return exchange__refuse(x, 409, e->pointer, err, "run '%s' has no samples of its curve yet",
                                e->id);
    if (status == BF_OK && !e->is_run &&
        buffer_printf(&e->columns, "%s", e->measurement.counter) != BF_OK)
        return bf_fail_memory(err);
    if (status != BF_OK || !e->is_run)
        return status;
    // From behind the last sample on: the columns alone.
    BF_TRY(services->read_curve(services->store, e->id, e->run.n_samples, 0, &curve, err));
    e->columns = curve.columns;
    curve.columns = (bf_buffer){ 0 };
    api_curve_fini(&curve);
    return BF_OK;
}

static const char *columns_of(const entry *e)
{
    return e->columns.bytes == NULL ? "" : e->columns.bytes;
}

// Where the column stands in the entry's curve. False: it has none of that name.
static bool find_column(const entry *e, const char *wanted, size_t *ret_index)
{
    const char *names = columns_of(e);
    char name[COLUMN_NAME_SIZE];

    for (size_t index = 0; api_next_column(&names, name); index++) {
        if (strcmp(name, wanted) == 0) {
            if (ret_index != NULL)
                *ret_index = index;
            return true;
        }
    }
    return false;
}

// The entry that lacks the column, or NULL.
static const entry *find_lack(const comparison *c, const char *name)
{
    for (size_t i = 0; i < c->n; i++) {
        if (!find_column(&c->entries[i], name, NULL))
            return &c->entries[i];
    }
    return NULL;
}

// The requested column, else the first one of the reference that all have.
static bf_status choose_column(exchange *x, comparison *c, bf_error *err)
{
    const char *wanted = exchange__text(x, "column");
    const char *names = columns_of(&c->entries[c->reference]);
    const entry *lack = NULL;

    if (wanted != NULL) {
        lack = find_lack(c, wanted);
        if (lack != NULL)
            return exchange__refuse(x, 422, lack->pointer, err,
                                    "the curve of '%s' has no column '%.80s'; it has %.120s",
                                    lack->id, wanted, columns_of(lack));
        snprintf(c->column, sizeof c->column, "%s", wanted);
        return BF_OK;
    }
    while (api_next_column(&names, c->column)) {
        lack = find_lack(c, c->column);
        if (lack == NULL)
            return BF_OK;
    }
    return exchange__refuse(x, 422, lack == NULL ? "/column" : lack->pointer, err,
                            "the curves have no column in common; that of the reference has "
                            "%.200s",
                            columns_of(&c->entries[c->reference]));
}

// Appends one column of a curve, or of a piece of it.
static bf_status take_column(const comparison *c, const entry *e, const api_curve *curve,
                             column *to, bf_error *err)
{
    const double *values = (const double *)(const void *)curve->values.bytes;
    const size_t n_bytes = curve->n * sizeof(double);
    size_t index = 0;

    if (!find_column(e, c->column, &index) || index >= curve->n_columns)
        return bf_fail(err, BF_ECORRUPT, "", "the curve of '%s' has changed its columns", e->id);
    char *parts = buffer_reserve(&to->parts, n_bytes);
    if (parts == NULL || buffer_append(&to->t, curve->t.bytes, n_bytes) != BF_OK)
        return bf_fail_memory(err);
    for (size_t i = 0; i < curve->n; i++)
        memcpy(parts + i * sizeof(double), &values[i * curve->n_columns + index], sizeof(double));
    to->parts.n += n_bytes;
    return BF_OK;
}

// The caller's also on failure. All columns of a long curve of a run would take much more memory than the one.
static bf_status read_column(exchange *x, const comparison *c, const entry *e, column *ret_column,
                             bf_error *err)
{
    const api_services *services = x->services;
    bf_status status = BF_OK;
    uint64_t at = 0;

    do {
        const uint64_t n_left = e->run.n_samples - at;
        api_curve curve = { 0 };
        status = e->is_run ? services->read_curve(services->store, e->id, at,
                                                  n_left < PIECE_SAMPLES ? n_left : PIECE_SAMPLES,
                                                  &curve, err)
                           : services->read_measurement(services->store, e->id, &curve, err);
        if (status == BF_OK)
            status = take_column(c, e, &curve, ret_column, err);
        api_curve_fini(&curve);
        at += PIECE_SAMPLES;
    } while (status == BF_OK && e->is_run && at < e->run.n_samples);
    return status;
}

static compare_curve view_of(const column *c)
{
    return (compare_curve){ .n = c->t.n / sizeof(double),
                            .t = (const double *)(const void *)c->t.bytes,
                            .parts = (const double *)(const void *)c->parts.bytes };
}

// Curves that are each valid may still not be comparable.
static bf_status refuse_curves(exchange *x, const entry *e, bf_status status, const bf_error *why,
                               bf_error *err)
{
    if (status == BF_EINPUT)
        return exchange__refuse(x, 422, e->pointer, err, "%s", why->text);
    return bf_fail(err, status, why->pointer, "%s", why->text);
}

static bf_status measure_entry(exchange *x, const comparison *c, const compare_curve *reference,
                               entry *e, bf_error *err)
{
    column col = { .t = { 0 } };
    bf_error why = { 0 };

    bf_status status = read_column(x, c, e, &col, err);
    if (status != BF_OK) {
        fini_column(&col);
        return status;
    }
    compare_curve curve = view_of(&col);
    status = compare_figures_of(&curve, &e->figures, &why);
    if (status == BF_OK)
        status = compare_curves(reference, &curve, &e->measures, &why);
    fini_column(&col);
    return status == BF_OK ? BF_OK : refuse_curves(x, e, status, &why, err);
}

static bf_status find_side_of_run(exchange *x, entry *e, bf_error *err)
{
    const api_services *services = x->services;
    bf_buffer scenario = { 0 }, text = { 0 };
    bf_status status = BF_OK;

    if (e->run.has_summary) {
        status = services->read_text(services->store, e->id, API_TEXT_SUMMARY, &text, err);
        if (status == BF_OK)
            status = compare_verdict_side_of_summary(text.bytes, text.n, &e->side, &e->flows, err);
        if (status == BF_EINPUT)
            status = bf_fail(err, BF_ECORRUPT, "", "a stored summary is damaged");
    } else {
        status = services->read_text(services->store, e->id, API_TEXT_SCENARIO, &scenario, err);
        if (status == BF_OK && e->run.figures[0] != '\0')
            status = services->read_text(services->store, e->id, API_TEXT_FIGURES, &text, err);
        if (status == BF_OK)
            status = compare_verdict_side(e->run.model, scenario.bytes, scenario.n, text.bytes,
                                          text.n, &e->side, &e->flows, err);
    }
    buffer_fini(&scenario);
    buffer_fini(&text);
    return status;
}

// What is known of an entry whose curve was measured. A scenario that an earlier version stored may not be read any more.
static bf_status find_side(exchange *x, entry *e, bf_error *err)
{
    bf_status status = BF_OK;

    if (e->is_run)
        status = find_side_of_run(x, e, err);
    else
        e->side = (compare_side){ .throughput_per_h = s_per_h * e->figures.throughput,
                                  .error_per_h = (double)NAN,
                                  .needs_s = (double)NAN };
    e->has_side = status == BF_OK;
    return status == BF_ECORRUPT ? BF_OK : status;
}

// A run that is compared with counts has the throughput of the same column.
static bf_status write_verdicts(json_out *w, const comparison *c, const entry *e, bf_error *err)
{
    const entry *reference = &c->entries[c->reference];
    compare_side a = reference->side, b = e->side;

    verdicts *all = memory_alloc(1, sizeof *all);
    if (all == NULL)
        return bf_fail_memory(err);
    if (!a.is_run || !b.is_run) {
        a.throughput_per_h = s_per_h * reference->figures.throughput;
        b.throughput_per_h = s_per_h * e->figures.throughput;
        a.error_per_h = b.error_per_h = (double)NAN;
    }
    if (reference->has_side && e->has_side) {
        compare_verdict_find(&a, &b, all);
        compare_verdict_flows(&a, &b, &reference->flows, &e->flows, all);
    }
    json_out_key(w, "verdicts");
    verdict_write_all(w, all);
    memory_free(all);
    json_out_key(w, "flows");
    compare_flows_write(w, &reference->flows, &e->flows);
    return BF_OK;
}

static bf_status measure_curves(exchange *x, comparison *c, bf_error *err)
{
    entry *reference = &c->entries[c->reference];
    column col = { .t = { 0 } };
    bf_error why = { 0 };

    bf_status status = read_column(x, c, reference, &col, err);
    if (status != BF_OK) {
        fini_column(&col);
        return status;
    }
    compare_curve curve = view_of(&col);
    status = compare_figures_of(&curve, &reference->figures, &why);
    if (status != BF_OK)
        status = refuse_curves(x, reference, status, &why, err);
    for (size_t i = 0; i < c->n && status == BF_OK; i++) {
        if (i != c->reference)
            status = measure_entry(x, c, &curve, &c->entries[i], err);
    }
    fini_column(&col);
    return status;
}

static void write_entry(json_out *w, const comparison *c, const entry *e)
{
    const compare_json_entry view = {
        .id = e->id,
        .kind = e->is_run ? "run" : "measurement",
        .label = e->is_run ? e->run.label : e->measurement.label,
        .name = e->is_run ? e->run.name : NULL,
        .model = e->is_run ? run_model_words[e->run.model] : NULL,
        .status = e->is_run ? run_state_word(e->run.state) : NULL,
        .column = c->column,
        .figures = e->figures,
    };
    members_write(w, &compare_json_compared, &view);
}

// The members of the comparison of an entry with the reference.
static bf_status write_measures(exchange *x, json_out *w, const comparison *c, const entry *e,
                                bf_error *err)
{
    size_t n_pairs = c->n - 1;
    BF_TRY(write_verdicts(w, c, e, err));
    json_out_key(w, "curve");
    members_write(w, &compare_json_measures, &e->measures);
    json_out_key(w, "density");
    const entry *reference = &c->entries[c->reference];
    const bool are_wanted = exchange__whole(x, "densities") == 1;
    return handlers__write_density(x, w, reference->is_run && are_wanted ? reference->id : NULL,
                                   e->is_run ? e->id : NULL, n_pairs, err);
}

static bf_status write_pair(exchange *x, json_out *w, const comparison *c, bf_error *err)
{
    json_out_key(w, "a");
    write_entry(w, c, &c->entries[0]);
    json_out_key(w, "b");
    write_entry(w, c, &c->entries[1]);
    return write_measures(x, w, c, &c->entries[1], err);
}

static bf_status write_all(exchange *x, json_out *w, const comparison *c, bf_error *err)
{
    const entry *reference = &c->entries[c->reference];
    bf_status status = BF_OK;

    json_out_key_string(w, "reference", reference->id);
    json_out_key(w, "entries");
    json_out_array(w);
    for (size_t i = 0; i < c->n; i++)
        write_entry(w, c, &c->entries[i]);
    json_out_array_end(w);
    json_out_key(w, "pairs");
    json_out_array(w);
    for (size_t i = 0; i < c->n && status == BF_OK; i++) {
        if (i == c->reference)
            continue;
        json_out_object(w);
        json_out_key_string(w, "a", reference->id);
        json_out_key_string(w, "b", c->entries[i].id);
        status = write_measures(x, w, c, &c->entries[i], err);
        json_out_object_end(w);
    }
    json_out_array_end(w);
    return status;
}

static bf_status compare_all(exchange *x, comparison *c, bf_error *err)
{
    BF_TRY(read_query(x, c, err));
    for (size_t i = 0; i < c->n; i++)
        BF_TRY(find_entry(x, &c->entries[i], err));
    BF_TRY(choose_column(x, c, err));
    BF_TRY(measure_curves(x, c, err));
    for (size_t i = 0; i < c->n; i++)
        BF_TRY(find_side(x, &c->entries[i], err));
    for (size_t i = 0; i < c->n; i++)
        compare_verdict_leave_out(&c->entries[c->reference].side, &c->entries[i].side, c->column,
                                  &c->entries[i].figures, &c->entries[i].measures);
    exchange__cache_revalidate(x);
    json_out w = json_out_to(&x->response->body);
    json_out_object(&w);
    bf_status status = c->is_pair ? write_pair(x, &w, c, err) : write_all(x, &w, c, err);
    json_out_object_end(&w);
    return status == BF_OK ? json_out_status(&w, err) : status;
}

bf_status handlers_compare_runs(exchange *x, bf_error *err)
{
    comparison *c = memory_alloc(1, sizeof *c);

    if (c == NULL)
        return bf_fail_memory(err);
    bf_status status = compare_all(x, c, err);
    for (size_t i = 0; i < c->n; i++)
        buffer_fini(&c->entries[i].columns);
    memory_free(c);
    return status;
}
