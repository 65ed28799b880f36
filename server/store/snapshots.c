// Snapshots are written in items (work.h): chunks of their arrays as they come, and with the last item the row and the
// event that make them visible. Chunks of snapshots that have no row exist in running runs only.

#include "server/store/store_priv.h"

static bf_status check_parts(const api_parts *parts, const store_item *item, bf_error *err)
{
    const uint64_t row = parts->n_values * sizeof(double), n = item->parts_at + item->parts.n;
    uint64_t bytes = 0;

    if (frame_has_ids(parts->n_values))
        bytes = n / row * row;
    else if (__builtin_mul_overflow(parts->n_parts, row, &bytes))
        bytes = UINT64_MAX;
    if (bytes != n)
        return bf_fail(err, BF_ECORRUPT, "", "%llu parts of %u values came as %llu bytes",
                       (unsigned long long)parts->n_parts, parts->n_values, (unsigned long long)n);
    return BF_OK;
}

// The sizes of a snapshot that is complete with this item.
static bf_status check_snapshot(const store__row *row, const store_item *item, bf_error *err)
{
    const uint64_t n = item->rho_at + item->rho.n;
    uint64_t bytes = 0;

    if (__builtin_mul_overflow(row->run.grid.n1, row->run.grid.n2, &bytes) ||
        __builtin_mul_overflow(bytes, sizeof(float), &bytes) || bytes != n)
        return bf_fail(err, BF_ECORRUPT, "", "a snapshot of %zu x %zu cells came as %llu bytes",
                       row->run.grid.n1, row->run.grid.n2, (unsigned long long)n);
    return check_parts(&row->run.parts, item, err);
}

static bf_status insert_snapshot(store__connection *writer, int64_t results,
                                 const api_snapshot *snapshot, bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_INSERT_SNAPSHOT);
    store__bind_integer(&q, results);
    store__bind_integer(&q, (int64_t)snapshot->index);
    store__bind_real(&q, snapshot->t);
    store__bind_real(&q, snapshot->peak);
    store__bind_real(&q, snapshot->mass);
    return store__run(&q, err);
}

// Whether all of an array of n bytes is stored.
static bf_status check_stored(store__connection *writer, const store__row *row, store__blob kind,
                              uint64_t index, uint64_t n, bf_error *err)
{
    uint64_t n_chunks = 0;

    bf_status status = store__count_chunks(writer, row->results, kind, index, &n_chunks, err);
    if (status == BF_OK && n_chunks != (n + STORE__SLICE_BYTES - 1) / STORE__SLICE_BYTES)
        return bf_fail(err, BF_ECORRUPT, "", "an array of %llu bytes came in %llu slices",
                       (unsigned long long)n, (unsigned long long)n_chunks);
    return status;
}

// What is not whole is not counted.
static bf_status count_bytes(store__connection *writer, const store__row *row, uint64_t index,
                             bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_COUNT_SNAPSHOT);
    store__bind_integer(&q, row->results);
    store__bind_integer(&q, (int64_t)index);
    store__bind_integer(&q, STORE__BLOB_SNAPSHOT);
    store__bind_integer(&q, STORE__BLOB_PARTS);
    return store__run(&q, err);
}

static bf_status complete(store__connection *writer, store__row *row, const store_item *item,
                          bf_error *err)
{
    const uint64_t index = item->snapshot.index;

    bf_status status = check_snapshot(row, item, err);
    if (status == BF_OK)
        status =
            check_stored(writer, row, STORE__BLOB_SNAPSHOT, index, item->rho_at + item->rho.n, err);
    if (status == BF_OK)
        status = check_stored(writer, row, STORE__BLOB_PARTS, index, item->parts_at + item->parts.n,
                              err);
    if (status == BF_OK)
        status = insert_snapshot(writer, row->results, &item->snapshot, err);
    if (status == BF_OK)
        status = count_bytes(writer, row, index, err);
    if (status == BF_OK)
        status = store__insert_event(writer, row, API_EVENT_SNAPSHOT, index, &item->event, err);
    if (status == BF_OK)
        row->run.n_snapshots++;
    return status;
}

bf_status store__append_snapshot(store__connection *writer, store__row *row, const store_item *item,
                                 const bf_buffer *grid, const bf_buffer *parts, bf_error *err)
{
    const uint64_t index = item->snapshot.index, n_stored = row->run.n_snapshots;

    if (index < n_stored)
        return BF_OK;
    if (index > n_stored)
        return bf_fail(err, BF_ECORRUPT, "",
                       "the snapshots have a gap: number %llu came after %llu snapshots",
                       (unsigned long long)index, (unsigned long long)n_stored);
    bf_status status = store__insert_chunks(writer, row->results, STORE__BLOB_SNAPSHOT, index,
                                            item->rho_at, grid, err);
    if (status == BF_OK)
        status = store__insert_chunks(writer, row->results, STORE__BLOB_PARTS, index,
                                      item->parts_at, parts, err);
    return status != BF_OK || item->is_open ? status : complete(writer, row, item, err);
}
