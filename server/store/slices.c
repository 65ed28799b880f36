// Blobs of snapshots that are read piece by piece. What is stored since blobs have slices (STORE__SLICE_BYTES) is
// one frame of zstd a row: between two slices nothing is kept but their number. An older blob is one frame, whose
// decoder is kept from piece to piece. Every piece is read in a short transaction of its own, so a slow reader
// does not hold up the log.

#include "server/store/store_priv.h"

#include "core/base/memory.h"
#include "core/observe/frame.h"

#include <string.h>
#include <zstd.h>

enum {
    DECODER_BYTES = 1024 * 1024
}; // of an older blob: its window of 512 KiB, and what goes with it

// An array that is being read.
typedef struct slices {
    char id[API_ID_SIZE]; // of the run
    int64_t results;
    store__blob kind;
    uint64_t item;
    uint64_t n;            // bytes
    uint64_t slice;        // bytes of each row but the last; 0: all rows are one frame
    ZSTD_DStream *decoder; // of the frame under way; NULL: the row begins one
    uint64_t part;         // the row that comes next,
    size_t n_consumed;     // but for so many bytes
    uint64_t at;           // the byte that comes next
} slices;

static void destroy(void *state)
{
    slices *r = state;

    (void)ZSTD_freeDStream(r->decoder);
    memory_free(r);
}

// What a blob looks like before it is read: its first and its last row.
typedef struct ends {
    store__row row;
    api_snapshot snapshot;
    bf_buffer first;
    bf_buffer last;
    uint64_t n_chunks; // 0: of no rows of parts, there is no blob
} ends;

static bf_status read_ends(store__connection *reader, slices *r, const char *id, ends *e,
                           bf_error *err)
{
    BF_TRY(store__find_array(reader, id, r->kind, r->item, &e->row, &e->snapshot, err));
    r->results = e->row.results;
    BF_TRY(store__count_chunks(reader, r->results, r->kind, r->item, &e->n_chunks, err));
    if (e->n_chunks > 0)
        BF_TRY(store__get_chunk(reader, r->results, r->kind, r->item, 0, &e->first, err));
    if (e->n_chunks > 0)
        BF_TRY(
            store__get_chunk(reader, r->results, r->kind, r->item, e->n_chunks - 1, &e->last, err));
    return BF_OK;
}

static bf_status fail_damaged(bf_error *err)
{
    return bf_fail(err, BF_ECORRUPT, "", "a stored snapshot is damaged");
}

// The size of what is in a frame; more than FRAME_PAYLOAD_MAX: it is damaged, or does not say.
static uint64_t content_size(const bf_buffer *chunk)
{
    return ZSTD_getFrameContentSize(chunk->bytes, chunk->n);
}

// Finds how the blob is stored and its size.
static bf_status measure(slices *r, const ends *e, bf_error *err)
{
    if (e->n_chunks == 0)
        return BF_OK;
    const uint64_t n_first = content_size(&e->first), n_last = content_size(&e->last),
                   n_before = e->n_chunks - 1;
    r->n = n_first;
    if (ZSTD_findFrameCompressedSize(e->first.bytes, e->first.n) == e->first.n) {
        if (n_last > FRAME_PAYLOAD_MAX ||
            (n_before > 0 && (n_first == 0 || n_before > FRAME_PAYLOAD_MAX / n_first)))
            return fail_damaged(err);
        r->slice = n_first;
        r->n = n_first * n_before + n_last;
    }
    return r->n > FRAME_PAYLOAD_MAX ? fail_damaged(err) : BF_OK;
}

// Compares the size with that of the run; of parts in scenarios with feeds it tells their number.
static bf_status check_size(const slices *r, ends *e, bf_error *err)
{
    api_run *of = &e->row.run;

    if (r->kind == STORE__BLOB_PARTS && frame_has_ids(of->parts.n_values))
        of->parts.n_parts = r->n / (of->parts.n_values * sizeof(double));
    if (r->n == store__array_bytes(of, r->kind))
        return BF_OK;
    return bf_fail(err, BF_ECORRUPT, "", "a stored snapshot does not have its size");
}

static bf_status open_blob(store *s, slices *r, const char *id, ends *e, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);

    bf_status status = read_ends(reader, r, id, e, err);
    store__release_reader(&s->pool, reader);
    if (status != BF_OK)
        return status;
    status = measure(r, e, err);
    return status == BF_OK ? check_size(r, e, err) : status;
}

bf_status store_open_array(store *s, const char *id, uint64_t index, api_array_kind kind,
                           api_array *ret_array, api_slices *ret_slices, bf_error *err)
{
    slices *r = memory_alloc(1, sizeof *r);
    ends e = { .n_chunks = 0 };

    if (r == NULL)
        return bf_fail_memory(err);
    *r = (slices){ .kind = store__blob_of(kind), .item = index };
    bf_status status = open_blob(s, r, id, &e, err);
    buffer_fini(&e.first);
    buffer_fini(&e.last);
    if (status != BF_OK) {
        destroy(r);
        return status;
    }
    memcpy(r->id, e.row.run.id, sizeof r->id);
    *ret_array = (api_array){ e.snapshot, e.row.run.grid, e.row.run.parts };
    *ret_slices = (api_slices){ .n = r->n,
                                .n_held = sizeof *r + (r->slice == 0 ? DECODER_BYTES : 0),
                                .state = r,
                                .destroy = destroy };
    return BF_OK;
}

// Reads the row that comes next. The number of a set of results may be given to another set once it is removed, so
// the run has to be there still.
static bf_status read_row(store *s, const slices *r, bf_buffer *out, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    store__row row;

    bf_status status = store__find_row(reader, r->id, &row, err);
    if (status == BF_OK)
        status = store__get_chunk(reader, r->results, r->kind, r->item, r->part, out, err);
    store__release_reader(&s->pool, reader);
    return status;
}

static void forget_decoder(slices *r)
{
    (void)ZSTD_freeDStream(r->decoder);
    r->decoder = NULL;
}

// True if a row of one slice says that it has as many bytes as belong there, to which its decoder then keeps.
static bool is_slice(const slices *r, const bf_buffer *row)
{
    const uint64_t left = r->n - r->at;

    return content_size(row) == (left < r->slice ? left : r->slice);
}

// Decodes what is left of a row, or as much as *to takes. Moves on behind it.
static bf_status decode_row(slices *r, const bf_buffer *row, ZSTD_outBuffer *to, bf_error *err)
{
    ZSTD_inBuffer from = { row->bytes, row->n, r->n_consumed };
    const size_t n_before = to->pos;
    bool has_moved = true;

    if (r->decoder == NULL && r->slice > 0 && !is_slice(r, row))
        return fail_damaged(err);
    if (r->decoder == NULL && (r->decoder = ZSTD_createDStream()) == NULL)
        return bf_fail_memory(err);
    while (has_moved && r->decoder != NULL && from.pos < from.size) {
        const size_t before = from.pos + to->pos;
        const size_t code = ZSTD_decompressStream(r->decoder, to, &from);
        if (ZSTD_isError(code))
            return store__fail_zstd(code, BF_ECORRUPT, err);
        if (code == 0)
            forget_decoder(r);
        has_moved = from.pos + to->pos > before;
    }
    // A frame ends with its row or goes on in the next one; only a full buffer leaves a row before its end.
    if (from.pos < from.size && (r->decoder == NULL || to->pos < to->size))
        return fail_damaged(err);
    r->n_consumed = from.pos < from.size ? from.pos : 0;
    r->part += from.pos < from.size ? 0 : 1;
    r->at += to->pos - n_before;
    return BF_OK;
}

// True if all bytes of a frame are decoded, but its checksum, which comes last, is not.
static bool lacks_checksum(const slices *r)
{
    const bool is_end = r->at == r->n || (r->slice > 0 && r->at % r->slice == 0);

    return r->decoder != NULL && is_end;
}

// Decodes until *to is full, and what it holds is checked.
static bf_status decode(store *s, slices *r, ZSTD_outBuffer *to, bf_error *err)
{
    bf_buffer row = { 0 };
    bf_status status = BF_OK;

    while (status == BF_OK && (to->pos < to->size || lacks_checksum(r))) {
        row.n = 0;
        status = read_row(s, r, &row, err);
        if (status == BF_OK)
            status = decode_row(r, &row, to, err);
    }
    buffer_fini(&row);
    return status;
}

// Moves to byte `at`, or to one before it from where it can be reached.
static void approach(slices *r, uint64_t at)
{
    const bool is_ahead = at >= r->at && (r->slice == 0 || at - r->at < r->slice);

    if (is_ahead)
        return;
    forget_decoder(r);
    r->n_consumed = 0;
    r->part = r->slice == 0 ? 0 : at / r->slice;
    r->at = r->part * r->slice;
}

static bf_status skip(store *s, slices *r, uint64_t at, bf_error *err)
{
    bf_status status = BF_OK;

    if (r->at == at)
        return BF_OK;
    char *to = memory_alloc(STORE__SLICE_BYTES, 1);
    if (to == NULL)
        return bf_fail_memory(err);
    while (status == BF_OK && r->at < at) {
        const uint64_t left = at - r->at;
        ZSTD_outBuffer skipped = { to,
                                   left < STORE__SLICE_BYTES ? (size_t)left : STORE__SLICE_BYTES,
                                   0 };
        status = decode(s, r, &skipped, err);
    }
    memory_free(to);
    return status;
}

// Where reading fails, the next one begins at the start of a row.
static bf_status read_at(store *s, slices *r, uint64_t at, char *to, size_t n, bf_error *err)
{
    ZSTD_outBuffer wanted = { to, n, 0 };

    approach(r, at);
    bf_status status = skip(s, r, at, err);
    if (status == BF_OK)
        status = decode(s, r, &wanted, err);
    if (status != BF_OK)
        r->at = UINT64_MAX;
    return status;
}

bf_status store_read_slice(store *s, api_slices *array, uint64_t at, size_t limit_bytes,
                           bf_buffer *out, bf_error *err)
{
    slices *r = array->state;
    const uint64_t left = at < r->n ? r->n - at : 0;
    const size_t n = left < limit_bytes ? (size_t)left : limit_bytes;

    if (n == 0)
        return BF_OK;
    char *to = buffer_reserve(out, n);
    if (to == NULL)
        return bf_fail_memory(err);
    bf_status status = read_at(s, r, at, to, n, err);
    if (status == BF_OK)
        out->n += n;
    out->bytes[out->n] = '\0';
    return status;
}
