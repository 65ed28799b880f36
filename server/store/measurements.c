#include "server/store/quotas.h"
#include "server/store/store_priv.h"

#include "server/base/clock.h"
#include "server/base/run_id.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

// A measurement to be inserted or removed.
typedef struct measure_context {
    const store *store; // whose quotas count
    api_measurement about;
    const api_curve *curve; // to be inserted
    const bf_buffer *csv;   // same
} measure_context;

static bf_status fail_absent(const char *id, bf_error *err)
{
    return bf_fail(err, BF_ENOTFOUND, "", "there is no measurement %.40s", id);
}

static bf_status check_count(store__connection *writer, bf_error *err)
{
    int64_t n = 0;

    BF_TRY(store__read_number(writer, STORE__SQL_COUNT_MEASUREMENTS, &n, err));
    if (n >= API_MEASUREMENTS_MAX)
        return bf_fail(err, BF_ECONFLICT, "",
                       "%lld measurements are stored, the limit is %d: remove some first",
                       (long long)n, API_MEASUREMENTS_MAX);
    return BF_OK;
}

static bf_status apply_add(store__connection *writer, store__operation *operation, bf_error *err)
{
    const measure_context *context = operation->context;
    const api_measurement *about = &context->about;

    BF_TRY(check_count(writer, err));
    BF_TRY(store__check_measurements(writer, context->store, about->owner, err));
    BF_TRY(store__check_bytes(writer, context->store, about->owner, err));
#define X(kind, column, member) kind(about->member),
    return store__exec(writer, STORE__SQL_INSERT_MEASUREMENT, err, TEXT(about->id),
                       STORE__MEASUREMENT_LIST(X)
                           BLOB(context->curve->t.bytes, context->curve->t.n),
                       BLOB(context->curve->values.bytes, context->curve->values.n),
                       TEXT_OF(context->csv->bytes, context->csv->n));
#undef X
}

bf_status store_add_measurement(store *s, const api_measurement *measurement,
                                const api_curve *curve, const bf_buffer *csv,
                                api_measurement *ret_measurement, bf_error *err)
{
    measure_context context = { .store = s, .about = *measurement, .curve = curve, .csv = csv };

    BF_TRY(run_id_make(context.about.id, err));
    BF_TRY(store__check_room(s, err));
    context.about.created_ms = clock_unix_ms();
    if (context.about.kind == API_MEASURED_CURVE)
        context.about.n_samples = curve->n;
    BF_TRY(store__write(s, apply_add, &context, err));
    *ret_measurement = context.about;
    return BF_OK;
}

static bf_status apply_remove(store__connection *writer, store__operation *operation, bf_error *err)
{
    const measure_context *context = operation->context;
    const char *id = context->about.id;

    BF_TRY(store__exec(writer, STORE__SQL_DELETE_MEASUREMENT, err, TEXT(id)));
    if (sqlite3_changes(writer->db) == 0)
        return fail_absent(id, err);
    return BF_OK;
}

bf_status store_remove_measurement(store *s, const char *id, bf_error *err)
{
    measure_context context = { .curve = NULL };

    snprintf(context.about.id, sizeof context.about.id, "%s", id);
    return store__write_freeing(s, apply_remove, &context, err);
}

static bf_status check_row(const store__query *q, void *of, bool is_whole, bf_error *err)
{
    const api_measurement *about = of;

    (void)q;
    if (!is_whole || (unsigned)about->kind >= API_MEASURED_COUNT)
        return bf_fail(err, BF_ECORRUPT, "", "the stored measurement %s is damaged", about->id);
    return BF_OK;
}

// As STORE__MEASUREMENT_COLUMNS.
#define X(kind, column, member) COLUMN(kind, api_measurement, member),
static const store__column columns[] = { COLUMN(ID, api_measurement, id),
                                         STORE__MEASUREMENT_LIST(X) };
#undef X

static const store__record record = RECORD(columns, api_measurement, check_row);

static bf_status read_samples(const store__query *q, const api_measurement *about, api_curve *curve,
                              bf_error *err)
{
    enum { T = sizeof columns / sizeof *columns, COUNTS };
    size_t n = (size_t)about->n_samples, n_bytes = n * sizeof(double);

    BF_TRY(store__column_bytes(q, T, &curve->t, err));
    BF_TRY(store__column_bytes(q, COUNTS, &curve->values, err));
    if (curve->t.n != n_bytes || curve->values.n != n_bytes)
        return bf_fail(err, BF_ECORRUPT, "", "the stored measurement %s is damaged", about->id);
    if (buffer_append(&curve->columns, about->counter, strlen(about->counter)) != BF_OK)
        return bf_fail_memory(err);
    curve->n = n;
    curve->n_columns = 1;
    return BF_OK;
}

// Reads the measurement, and its samples into *curve unless that is NULL.
static bf_status read_measurement(store *s, const char *id, api_curve *curve,
                                  api_measurement *ret_about, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    api_measurement about;
    bf_status status = BF_OK;

    store__query q = store__start(reader, STORE__SQL_FIND_MEASUREMENT, TEXT(id));
    const bool has_row = store__next(&q, &status, err);
    if (status == BF_OK && !has_row)
        status = fail_absent(id, err);
    if (status == BF_OK)
        status = store__read(&q, &record, &about, err);
    if (status == BF_OK && curve != NULL)
        status = read_samples(&q, &about, curve, err);
    store__end(&q);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_about = about;
    return status;
}

bf_status store_find_measurement(store *s, const char *id, api_measurement *ret_measurement,
                                 bf_error *err)
{
    return read_measurement(s, id, NULL, ret_measurement, err);
}

bf_status store_read_measurement(store *s, const char *id, api_curve *ret_curve, bf_error *err)
{
    api_curve curve = { 0 };
    api_measurement about;

    bf_status status = read_measurement(s, id, &curve, &about, err);
    if (status == BF_OK)
        *ret_curve = curve;
    else
        api_curve_fini(&curve);
    return status;
}

bf_status store_read_measurement_csv(store *s, const char *id, bf_buffer *out, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    bool has_row = false;

    const bf_status status =
        store__find_bytes(reader, STORE__SQL_GET_MEASUREMENT_CSV, out, &has_row, err, TEXT(id));
    store__release_reader(&s->pool, reader);
    return status == BF_OK && !has_row ? fail_absent(id, err) : status;
}

bf_status store_list_measurements(store *s, const api_page_query *query, api_page *ret_page,
                                  bf_error *err)
{
    static const store__listing measurements = { "measurements", &record, 0,
                                                 sizeof(api_measurement), 4 };
    const store__sql sql =
        query->label[0] == '\0' ? STORE__SQL_LIST_MEASUREMENTS : STORE__SQL_LIST_MEASUREMENTS_LABEL;

    return store__list_page(&s->pool, sql, &measurements, query, ret_page, err);
}
