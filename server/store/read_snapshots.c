#include "server/store/store_priv.h"

#include <sqlite3.h>

static api_snapshot read_snapshot_row(const store__query *q)
{
    return (api_snapshot){
        .index = (uint64_t)sqlite3_column_int64(q->statement, 0),
        .t = store__column_real(q, 1),
        .peak = store__column_real(q, 2),
        .mass = store__column_real(q, 3),
    };
}

static bf_status read_items(store__connection *reader, int64_t results, api_snapshot_list *list,
                            bf_error *err)
{
    bool has_row = true;
    bf_status status = BF_OK;

    store__query q = store__begin(reader, STORE__SQL_LIST_SNAPSHOTS);
    store__bind_integer(&q, results);
    while (status == BF_OK && has_row) {
        status = store__next(&q, &has_row, err);
        if (status != BF_OK || !has_row)
            break;
        api_snapshot snapshot = read_snapshot_row(&q);
        if (buffer_append(&list->items, &snapshot, sizeof snapshot) != BF_OK)
            status = bf_fail(err, BF_ENOMEM, "", "out of memory");
        else
            list->n++;
    }
    store__end(&q);
    return status;
}

static bf_status read_list(store__connection *reader, const char *id, api_snapshot_list *list,
                           bf_error *err)
{
    store__row row;

    bf_status status = store__find_row(reader, id, &row, err);
    if (status != BF_OK)
        return status;
    list->grid = row.grid;
    list->parts = row.parts;
    return read_items(reader, row.results, list, err);
}

bf_status store_list_snapshots(store *s, const char *id, api_snapshot_list *ret_list, bf_error *err)
{
    store__connection *reader = NULL;
    api_snapshot_list list = { 0 };

    bf_status status = store__take_reader(s, &reader, err);
    if (status != BF_OK)
        return status;
    status = read_list(reader, id, &list, err);
    store__give_reader(s, reader);
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

    store__query q = store__begin(reader, STORE__SQL_GET_SNAPSHOT);
    store__bind_integer(&q, results);
    store__bind_integer(&q, (int64_t)index);
    bf_status status = store__next(&q, &has_row, err);
    if (status == BF_OK && has_row)
        *ret_snapshot = read_snapshot_row(&q);
    store__end(&q);
    if (status == BF_OK && !has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no snapshot %llu",
                       (unsigned long long)index);
    return status;
}

// What is read of a snapshot: its row, the run's, and one of its blobs.
typedef struct reading {
    store__blob kind;
    uint64_t index;
    api_snapshot snapshot;
    store__row row;
    bf_buffer packed;
} reading;

static bf_status read_packed(store__connection *reader, const char *id, reading *r, bf_error *err)
{
    bf_status status = store__find_row(reader, id, &r->row, err);
    if (status == BF_OK && r->kind == STORE__BLOB_PARTS && r->row.parts.n_values == 0)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no parts: its model is %s",
                       run_model_words[r->row.run.model]);
    if (status == BF_OK)
        status = store__find_snapshot(reader, r->row.results, r->index, &r->snapshot, err);
    if (status == BF_OK)
        status = store__get_chunks(reader, r->row.results, r->kind, r->index, &r->packed, err);
    return status;
}

// Append what should be n bytes.
static bf_status unpack(const bf_buffer *packed, size_t n, bf_buffer *out, bf_error *err)
{
    size_t before = out->n;

    bf_status status = store__unpack(packed, out, err);
    if (status == BF_OK && out->n - before != n) {
        out->n = before;
        status = bf_fail(err, BF_ECORRUPT, "", "a stored snapshot does not have its size");
    }
    return status;
}

// Reads a blob and appends it unpacked; the reader is given back before that.
static bf_status read_blob(store *s, const char *id, reading *r, bf_buffer *out, bf_error *err)
{
    store__connection *reader = NULL;

    bf_status status = store__take_reader(s, &reader, err);
    if (status != BF_OK)
        return status;
    status = read_packed(reader, id, r, err);
    store__give_reader(s, reader);
    if (status == BF_OK)
        status = unpack(&r->packed,
                        r->kind == STORE__BLOB_PARTS
                            ? r->row.parts.n_parts * r->row.parts.n_values * sizeof(double)
                            : grid_cells(&r->row.grid) * sizeof(float),
                        out, err);
    buffer_fini(&r->packed);
    return status;
}

bf_status store_read_snapshot(store *s, const char *id, uint64_t index, api_snapshot *ret_snapshot,
                              bf_grid *ret_grid, bf_buffer *out, bf_error *err)
{
    reading r = { .kind = STORE__BLOB_SNAPSHOT, .index = index };

    bf_status status = read_blob(s, id, &r, out, err);
    if (status == BF_OK) {
        *ret_snapshot = r.snapshot;
        *ret_grid = r.row.grid;
    }
    return status;
}

bf_status store_read_parts(store *s, const char *id, uint64_t index, api_snapshot *ret_snapshot,
                           api_parts *ret_parts, bf_buffer *out, bf_error *err)
{
    reading r = { .kind = STORE__BLOB_PARTS, .index = index };

    bf_status status = read_blob(s, id, &r, out, err);
    if (status == BF_OK) {
        *ret_snapshot = r.snapshot;
        *ret_parts = r.row.parts;
    }
    return status;
}
