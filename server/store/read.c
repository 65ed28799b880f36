// Reading runs, curves, snapshots and parts.

#include "server/store/store_priv.h"
#include "server/store/texts.h"

#include <sqlite3.h>
#include <string.h>

bf_status store_find(store *s, const char *id, api_run *ret_run, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    store__row row;

    bf_status status = store__find_row(reader, id, &row, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_run = row.run;
    return status;
}

bf_status store_read_text(store *s, const char *id, api_text which, bf_buffer *out, bf_error *err)
{
    static const store__text kinds[] = { [API_TEXT_SCENARIO] = STORE__TEXT_SCENARIO,
                                         [API_TEXT_SUMMARY] = STORE__TEXT_SUMMARY,
                                         [API_TEXT_FIGURES] = STORE__TEXT_FIGURES };
    store__connection *reader = store__acquire_reader(&s->pool);
    store__row row;

    bf_status status = store__find_row(reader, id, &row, err);
    if (status == BF_OK && which == API_TEXT_SUMMARY && !row.run.has_summary)
        status = bf_fail(err, BF_ECONFLICT, "", "the run is %s and has no summary yet",
                         run_state_word(row.run.state));
    if (status == BF_OK && which == API_TEXT_FIGURES && row.run.figures[0] == '\0')
        status = bf_fail(err, BF_ECONFLICT, "", "the run is %s and has no key figures yet",
                         run_state_word(row.run.state));
    if (status == BF_OK)
        status = store__get_run_text(reader, &row, kinds[which], out, err);
    store__release_reader(&s->pool, reader);
    return status;
}

// Take the samples of the present row from index `first` on, until there are n_most.
static bf_status take_samples(const store__query *q, uint64_t first, uint64_t n_most,
                              api_curve *curve, bf_error *err)
{
    uint64_t row_first = (uint64_t)sqlite3_column_int64(q->statement, 0);
    uint64_t n = (uint64_t)sqlite3_column_int64(q->statement, 1);
    uint64_t skip = first > row_first ? first - row_first : 0;
    const char *t = sqlite3_column_blob(q->statement, 2);
    const char *parts = sqlite3_column_blob(q->statement, 3);
    size_t n_row = curve->n_columns * sizeof(double);

    if (skip >= n)
        return BF_OK;
    if (t == NULL || parts == NULL ||
        (size_t)sqlite3_column_bytes(q->statement, 2) != n * sizeof(double) ||
        (size_t)sqlite3_column_bytes(q->statement, 3) != n * n_row)
        return bf_fail(err, BF_ECORRUPT, "", "the stored curve is damaged at sample %llu",
                       (unsigned long long)row_first);
    const uint64_t n_left = n_most - curve->n;
    const size_t n_taken = (size_t)(n - skip < n_left ? n - skip : n_left);
    if (buffer_append(&curve->t, t + skip * sizeof(double), n_taken * sizeof(double)) != BF_OK ||
        buffer_append(&curve->values, parts + skip * n_row, n_taken * n_row) != BF_OK)
        return bf_fail_memory(err);
    curve->n += n_taken;
    return BF_OK;
}

bf_status store_read_curve(store *s, const char *id, uint64_t first, uint64_t n_most,
                           api_curve *ret_curve, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    api_curve curve = { 0 };
    store__row row;

    bf_status status = store__find_row(reader, id, &row, err);
    if (status == BF_OK)
        status = store__get_text(reader, row.rowid, STORE__TEXT_COLUMNS, &curve.columns, err);
    if (status == BF_OK)
        curve.n_columns = api_count_columns(&curve.columns);
    if (status == BF_OK && first < row.run.n_samples) {
        store__query q =
            store__start(reader, STORE__SQL_LIST_SAMPLES, INTEGER(row.results), INTEGER(first));
        while (curve.n < n_most && store__next(&q, &status, err))
            status = take_samples(&q, first, n_most, &curve, err);
        store__end(&q);
    }
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_curve = curve;
    else
        api_curve_fini(&curve);
    return status;
}

static const store__column columns[] = {
    COLUMN(INTEGER, api_snapshot, index),
    COLUMN(REAL, api_snapshot, t),
    COLUMN(REAL, api_snapshot, peak),
    COLUMN(REAL, api_snapshot, mass),
};
static const store__record snapshot_record = RECORD(columns, api_snapshot, NULL);

bf_status store_list_snapshots(store *s, const char *id, api_snapshot_list *ret_list, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    api_snapshot_list list = { 0 };
    store__row row = { .rowid = 0 };

    bf_status status = store__find_row(reader, id, &row, err);
    list.grid = row.run.grid;
    list.parts = row.run.parts;
    store__query q = store__start(reader, STORE__SQL_LIST_SNAPSHOTS, INTEGER(row.results));
    while (store__next(&q, &status, err)) {
        api_snapshot snapshot;
        status = store__read(&q, &snapshot_record, &snapshot, err);
        if (status == BF_OK && buffer_append(&list.items, &snapshot, sizeof snapshot) != BF_OK)
            status = bf_fail_memory(err);
        else
            list.n++;
    }
    store__end(&q);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_list = list;
    else
        buffer_fini(&list.items);
    return status;
}

bf_status store__find_snapshot(store__connection *reader, int64_t results, uint64_t index,
                               api_snapshot *ret_snapshot, bf_error *err)
{
    bool has_row = false;

    BF_TRY(store__find(reader, STORE__SQL_GET_SNAPSHOT, &snapshot_record, ret_snapshot, &has_row,
                       err, INTEGER(results), INTEGER(index)));
    if (!has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no snapshot %llu",
                       (unsigned long long)index);
    return BF_OK;
}

bf_status store__find_array(store__connection *reader, const char *id, store__blob kind,
                            uint64_t index, store__row *row, api_snapshot *ret_snapshot,
                            bf_error *err)
{
    BF_TRY(store__find_row(reader, id, row, err));
    if (kind == STORE__BLOB_PARTS && row->run.parts.n_values == 0)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no parts: its model is %s",
                       run_model_words[row->run.model]);
    return store__find_snapshot(reader, row->results, index, ret_snapshot, err);
}

// What is read of a snapshot: its row, the run's, and one of its blobs.
typedef struct reading {
    store__blob kind;
    api_snapshot snapshot;
    store__row row;
    bf_buffer compressed;
} reading;

// Append the blob, which should have its size, and note of parts how many there are.
static bf_status unpack(reading *r, bf_buffer *out, bf_error *err)
{
    const size_t row = r->row.run.parts.n_values * sizeof(double);
    const bool is_parts = r->kind == STORE__BLOB_PARTS;
    const bool is_fed = is_parts && frame_has_ids(r->row.run.parts.n_values);
    const size_t before = out->n;

    // No rows are no blob.
    bf_status status = BF_OK;
    if (r->compressed.n > 0 || !is_fed)
        status = store__unpack(&r->compressed, out, err);
    if (is_fed)
        r->row.run.parts.n_parts = (out->n - before) / row;
    if (status == BF_OK && out->n - before != store__array_bytes(&r->row.run, r->kind)) {
        out->n = before;
        status = bf_fail(err, BF_ECORRUPT, "", "a stored snapshot does not have its size");
    }
    return status;
}

bf_status store_read_array(store *s, const char *id, uint64_t index, api_array_kind kind,
                           api_array *ret_array, bf_buffer *out, bf_error *err)
{
    reading r = { .kind = store__blob_of(kind) };
    store__connection *reader = store__acquire_reader(&s->pool);

    bf_status status = store__find_array(reader, id, r.kind, index, &r.row, &r.snapshot, err);
    if (status == BF_OK)
        status = store__get_chunks(reader, r.row.results, r.kind, index, &r.compressed, err);
    store__release_reader(&s->pool, reader); // before what takes a while
    if (status == BF_OK)
        status = unpack(&r, out, err);
    buffer_fini(&r.compressed);
    if (status == BF_OK)
        *ret_array = (api_array){ r.snapshot, r.row.run.grid, r.row.run.parts };
    return status;
}
