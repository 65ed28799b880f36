// Sets of results. A run that is solved has one of its own; a run whose results are known joins the
// set of the run that was solved before (I10). Samples, snapshots and chunks belong to sets; texts
// and events to runs.
//
// The curve and snapshot events of a run that joined a set are rows without data: what they say
// stands in the set, and only the run's id differs from what the other runs' events say.

#include "server/store/share_priv.h"

#include "api/results/events.h"

#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

// Results of one solver are never taken for those of another.
static void name_solver(char *ret_name, size_t size)
{
    (void)snprintf(ret_name, size, "%s/%d", BELTFLOW_VERSION, RUN_VERSION);
}

enum { SOLVER_SIZE = 64 };

void store__digest_work(const api_submission *submission,
                        unsigned char ret_digest[STORE__DIGEST_SIZE])
{
    const char *model = run_model_words[submission->model];
    crypto_hash_sha256_state s;

    (void)crypto_hash_sha256_init(&s);
    // The word's terminator parts it from the document.
    (void)crypto_hash_sha256_update(&s, (const unsigned char *)model, strlen(model) + 1);
    (void)crypto_hash_sha256_update(&s, (const unsigned char *)submission->identity.bytes,
                                    submission->identity.n);
    (void)crypto_hash_sha256_final(&s, ret_digest);
}

bf_status store__insert_results(store__connection *writer, const unsigned char *digest,
                                store__row *row, bf_error *err)
{
    char solver[SOLVER_SIZE];

    name_solver(solver, sizeof solver);
    store__query q = store__begin(writer, STORE__SQL_INSERT_RESULTS);
    store__bind_blob(&q, digest, digest == NULL ? 0 : STORE__DIGEST_SIZE);
    store__bind_text(&q, solver, strlen(solver));
    bf_status status = store__run(&q, err);
    if (status == BF_OK)
        row->results = sqlite3_last_insert_rowid(writer->db);
    return status;
}

bf_status store__mark_results(store__connection *writer, int64_t results, store__results state,
                              bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_MARK_RESULTS);
    store__bind_integer(&q, results);
    store__bind_integer(&q, state);
    return store__run(&q, err);
}

bf_status store__disown_results(store__connection *writer, bf_error *err)
{
    char solver[SOLVER_SIZE];

    name_solver(solver, sizeof solver);
    store__query q = store__begin(writer, STORE__SQL_DISOWN_RESULTS);
    store__bind_text(&q, solver, strlen(solver));
    return store__run(&q, err);
}

bf_status store__find_solved(store__connection *c, const unsigned char digest[STORE__DIGEST_SIZE],
                             store__row *ret_row, bool *ret_is_solved, bf_error *err)
{
    char solver[SOLVER_SIZE];

    name_solver(solver, sizeof solver);
    store__query q = store__begin(c, STORE__SQL_FIND_SOLVED);
    store__bind_blob(&q, digest, STORE__DIGEST_SIZE);
    store__bind_text(&q, solver, strlen(solver));
    bf_status status = store__next(&q, ret_is_solved, err);
    if (status == BF_OK && *ret_is_solved)
        store__read_row(&q, ret_row);
    store__end(&q);
    return status;
}

static bf_status share_texts(store__connection *writer, const store__row *solved,
                             const bf_buffer *scenario, const bf_buffer *summary,
                             const store__row *row, bf_error *err)
{
    bf_buffer columns = { 0 };

    bf_status status = store__get_text(writer, solved->number, STORE__TEXT_COLUMNS, &columns, err);
    if (status == BF_OK)
        status = store__put_text(writer, row->number, STORE__TEXT_COLUMNS, columns.bytes, columns.n,
                                 err);
    if (status == BF_OK)
        status = store__put_text(writer, row->number, STORE__TEXT_SCENARIO, scenario->bytes,
                                 scenario->n, err);
    if (status == BF_OK && row->run.has_summary)
        status = store__put_text(writer, row->number, STORE__TEXT_SUMMARY, summary->bytes,
                                 summary->n, err);
    buffer_fini(&columns);
    return status;
}

static bf_status share_events(store__connection *writer, const store__row *solved,
                              const store__row *row, bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_SHARE_EVENTS);
    store__bind_integer(&q, row->number);
    store__bind_integer(&q, solved->number);
    return store__run(&q, err);
}

bf_status store__share_results(store__connection *writer, const store__row *solved,
                               const bf_buffer *scenario, const bf_buffer *summary, store__row *row,
                               bf_error *err)
{
    row->results = solved->results;
    row->grid = solved->grid;
    row->parts = solved->parts;
    row->run.state = RUN_SUCCEEDED;
    row->run.is_cached = true;
    row->run.progress = 1.0;
    row->run.finished_ms = row->run.created_ms;
    row->run.n_samples = solved->run.n_samples;
    row->run.n_snapshots = solved->run.n_snapshots;
    row->run.has_summary = solved->run.has_summary;
    bf_status status = store__insert_row(writer, row, err);
    if (status == BF_OK)
        status = share_texts(writer, solved, scenario, summary, row, err);
    if (status == BF_OK)
        status = share_events(writer, solved, row, err);
    return status == BF_OK ? store__tell_row(writer, row, err) : status;
}

/// A batch of samples as it is stored.
typedef struct samples {
    size_t n;
    bf_buffer t;
    bf_buffer values;
    bf_buffer columns; ///< of the curve
} samples;

static bf_status get_samples(store__connection *reader, const store__row *row, uint64_t first,
                             samples *got, bf_error *err)
{
    bool has_row = false;

    store__query q = store__begin(reader, STORE__SQL_GET_SAMPLES);
    store__bind_integer(&q, row->results);
    store__bind_integer(&q, (int64_t)first);
    bf_status status = store__next(&q, &has_row, err);
    if (status == BF_OK && has_row) {
        got->n = (size_t)sqlite3_column_int64(q.statement, 0);
        status = store__column_bytes(&q, 1, &got->t, err);
    }
    if (status == BF_OK && has_row)
        status = store__column_bytes(&q, 2, &got->values, err);
    store__end(&q);
    return status == BF_OK
               ? store__get_text(reader, row->number, STORE__TEXT_COLUMNS, &got->columns, err)
               : status;
}

static bf_status tell_curve(store__connection *reader, const store__row *row, uint64_t first,
                            bf_buffer *out, bf_error *err)
{
    samples got = { 0 };

    bf_status status = get_samples(reader, row, first, &got, err);
    size_t n_columns = 1;
    for (size_t i = 0; i < got.columns.n; i++)
        n_columns += got.columns.bytes[i] == ',';
    frame_curve curve = {
        .first = first,
        .n = (uint32_t)got.n,
        .n_columns = (uint32_t)n_columns,
        .t = (const double *)(const void *)got.t.bytes,
        .values = (const double *)(const void *)got.values.bytes,
    };
    bool is_whole = got.n > 0 && got.t.n == got.n * sizeof(double) &&
                    got.values.n == got.n * n_columns * sizeof(double);
    if (status == BF_OK && !is_whole)
        status = bf_fail(err, BF_ECORRUPT, "", "the stored curve is damaged at sample %llu",
                         (unsigned long long)first);
    if (status == BF_OK)
        status = events_curve(row->run.id, &curve, got.columns.bytes, out, err);
    buffer_fini(&got.t);
    buffer_fini(&got.values);
    buffer_fini(&got.columns);
    return status;
}

static bf_status tell_snapshot(store__connection *reader, const store__row *row, uint64_t index,
                               bf_buffer *out, bf_error *err)
{
    api_snapshot found;

    bf_status status = store__find_snapshot(reader, row->results, index, &found, err);
    if (status != BF_OK)
        return status;
    frame_snapshot told = {
        .index = index,
        .t = found.t,
        .peak = found.peak,
        .mass = found.mass,
        .n1 = (uint32_t)row->grid.n1,
        .n2 = (uint32_t)row->grid.n2,
    };
    return events_snapshot(row->run.id, &told, row->parts.n_values > 0, out, err);
}

bf_status store__tell_shared(store__connection *reader, const store__row *row, api_event_type type,
                             uint64_t item, bf_buffer *out, bf_error *err)
{
    return type == API_EVENT_CURVE ? tell_curve(reader, row, item, out, err)
                                   : tell_snapshot(reader, row, item, out, err);
}

static bf_status are_shared(store__connection *writer, int64_t results, bool *ret_are_shared,
                            bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_ARE_SHARED);
    store__bind_integer(&q, results);
    bf_status status = store__next(&q, ret_are_shared, err);
    store__end(&q);
    return status;
}

// Foreign keys delete with the set the samples and snapshots that refer to it (I9).
static bf_status delete_results(store__connection *writer, int64_t results, bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_DELETE_RESULTS);
    store__bind_integer(&q, results);
    return store__run(&q, err);
}

static bf_status sweep(store__connection *writer, int64_t results, bool *ret_is_over, bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_SWEEP_CHUNKS);
    store__bind_integer(&q, results);
    store__bind_integer(&q, STORE__SWEEP_CHUNKS);
    bf_status status = store__run(&q, err);
    if (status != BF_OK)
        return status;
    *ret_is_over = sqlite3_changes(writer->db) < STORE__SWEEP_CHUNKS;
    return *ret_is_over ? delete_results(writer, results, err)
                        : store__mark_results(writer, results, STORE__RESULTS_LEFT_OVER, err);
}

bf_status store__sweep_results(store__connection *writer, int64_t results, bool *ret_is_over,
                               bf_error *err)
{
    bool is_over = false;

    bf_status status = are_shared(writer, results, &is_over, err);
    if (status == BF_OK && !is_over)
        status = sweep(writer, results, &is_over, err);
    if (status == BF_OK)
        *ret_is_over = is_over;
    return status;
}

// Foreign keys delete with the row the texts and events that refer to it (I9).
bf_status store__remove_row(store__connection *writer, const store__row *row, bool *ret_is_over,
                            bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_DELETE_RUN);
    store__bind_integer(&q, row->number);
    bf_status status = store__run(&q, err);
    return status == BF_OK ? store__sweep_results(writer, row->results, ret_is_over, err) : status;
}
