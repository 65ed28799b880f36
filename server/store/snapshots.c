// Snapshots are written in items (work.h): chunks of their arrays as they come, and with the last item the row and the
// event that make them visible. Chunks of snapshots that have no row exist in running runs only.

#include "server/store/store_priv.h"

uint64_t store__array_bytes(const api_run *record, store__blob kind)
{
    const bool is_parts = kind == STORE__BLOB_PARTS;
    const size_t size = is_parts ? sizeof(double) : sizeof(float);
    uint64_t n = 0;

    const bool is_vast =
        is_parts ? __builtin_mul_overflow(record->parts.n_parts, record->parts.n_values, &n)
                 : __builtin_mul_overflow(record->grid.n1, record->grid.n2, &n);
    return is_vast || n > FRAME_PAYLOAD_MAX / size ? UINT64_MAX : n * size;
}

static bf_status check_parts(const api_run *record, uint64_t n, bf_error *err)
{
    const api_parts *parts = &record->parts;
    const bool fits = frame_has_ids(parts->n_values)
                          ? n % (parts->n_values * sizeof(double)) == 0
                          : n == store__array_bytes(record, STORE__BLOB_PARTS);

    if (fits)
        return BF_OK;
    return bf_fail(err, BF_ECORRUPT, "", "%llu parts of %u values came as %llu bytes",
                   (unsigned long long)parts->n_parts, parts->n_values, (unsigned long long)n);
}

// Whether all of an array of n bytes is stored.
static bf_status check_stored(store__connection *writer, const store__row *row, store__blob kind,
                              uint64_t index, uint64_t n, bf_error *err)
{
    uint64_t n_chunks = 0;

    BF_TRY(store__count_chunks(writer, row->results, kind, index, &n_chunks, err));
    if (n_chunks != (n + STORE__SLICE_BYTES - 1) / STORE__SLICE_BYTES)
        return bf_fail(err, BF_ECORRUPT, "", "an array of %llu bytes came in %llu slices",
                       (unsigned long long)n, (unsigned long long)n_chunks);
    return BF_OK;
}

static bf_status complete(store__connection *writer, store__row *row, const store_item *item,
                          bf_error *err)
{
    const api_snapshot *snapshot = &item->snapshot;
    const uint64_t index = snapshot->index, n_density = item->rho_at + item->rho.n,
                   n_parts = item->parts_at + item->parts.n;

    if (n_density != store__array_bytes(&row->run, STORE__BLOB_SNAPSHOT))
        return bf_fail(err, BF_ECORRUPT, "", "a snapshot of %zu x %zu cells came as %llu bytes",
                       row->run.grid.n1, row->run.grid.n2, (unsigned long long)n_density);
    BF_TRY(check_parts(&row->run, n_parts, err));
    // What came with this item is there.
    if (item->rho_at > 0)
        BF_TRY(check_stored(writer, row, STORE__BLOB_SNAPSHOT, index, n_density, err));
    if (item->parts_at > 0)
        BF_TRY(check_stored(writer, row, STORE__BLOB_PARTS, index, n_parts, err));
    BF_TRY(store__exec(writer, STORE__SQL_INSERT_SNAPSHOT, err, INTEGER(row->results),
                       INTEGER(index), REAL(snapshot->t), REAL(snapshot->peak),
                       REAL(snapshot->mass)));
    // Of a snapshot that came in pieces the bytes are counted when it is whole.
    if (item->rho_at + item->parts_at > 0)
        BF_TRY(store__exec(writer, STORE__SQL_COUNT_SNAPSHOT, err, INTEGER(row->results),
                           INTEGER(index), INTEGER(STORE__BLOB_SNAPSHOT),
                           INTEGER(STORE__BLOB_PARTS)));
    BF_TRY(store__insert_event(writer, row, API_EVENT_SNAPSHOT, index, &item->event, err));
    row->run.n_snapshots++;
    return BF_OK;
}

bf_status store__append_snapshot(store__connection *writer, store__row *row, const store_item *item,
                                 const bf_buffer *grid, const bf_buffer *parts, size_t *n_bytes,
                                 bf_error *err)
{
    const uint64_t index = item->snapshot.index, n_stored = row->run.n_snapshots;

    if (index < n_stored)
        return BF_OK;
    if (index > n_stored)
        return bf_fail(err, BF_ECORRUPT, "",
                       "the snapshots have a gap: number %llu came after %llu snapshots",
                       (unsigned long long)index, (unsigned long long)n_stored);
    BF_TRY(store__insert_chunks(writer, row->results, STORE__BLOB_SNAPSHOT, index, item->rho_at,
                                grid, err));
    BF_TRY(store__insert_chunks(writer, row->results, STORE__BLOB_PARTS, index, item->parts_at,
                                parts, err));
    if (item->is_open)
        return BF_OK;
    if (item->rho_at + item->parts_at == 0)
        *n_bytes += grid->n + parts->n;
    return complete(writer, row, item, err);
}
