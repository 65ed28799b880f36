#include "server/store/chunks.h"

#include "core/base/check.h"

#include <sqlite3.h>
#include <zstd.h>
#include <zstd_errors.h>

// Of compression: densities and parts take 6 % more room than at level 1, and a third of the time.
enum { LEVEL = -5 };

bf_status store__fail_zstd(size_t code, bf_status otherwise, bf_error *err)
{
    if (ZSTD_getErrorCode(code) == ZSTD_error_memory_allocation)
        return bf_fail_memory(err);
    return bf_fail(err, otherwise, "", "compressed bytes of the store: %s",
                   ZSTD_getErrorName(code));
}

static bf_status compress(ZSTD_CCtx *context, const char *bytes, size_t n, bf_buffer *out,
                          bf_error *err)
{
    size_t room = ZSTD_compressBound(n);
    char *to = buffer_reserve(out, room);

    if (to == NULL)
        return bf_fail_memory(err);
    size_t compressed = ZSTD_compress2(context, to, room, bytes, n);
    if (ZSTD_isError(compressed))
        return store__fail_zstd(compressed, BF_ESYSTEM, err);
    out->n += compressed;
    out->bytes[out->n] = '\0';
    return BF_OK;
}

store__packer *store__packer_create(void)
{
    ZSTD_CCtx *context = ZSTD_createCCtx();

    if (context == NULL)
        return NULL;
    // Both are valid. The checksum detects damage of the file after the solver wrote it.
    BF_CHECK(!ZSTD_isError(ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, LEVEL)));
    BF_CHECK(!ZSTD_isError(ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1)));
    return context;
}

void store__packer_destroy(store__packer *packer)
{
    ZSTD_freeCCtx(packer);
}

bf_status store__pack(store__packer *packer, const void *bytes, size_t n, bf_buffer *out,
                      bf_error *err)
{
    // For all slices at once, so that they are not moved; what is not needed of it is never touched.
    const size_t room = n / STORE__SLICE_BYTES * ZSTD_compressBound(STORE__SLICE_BYTES) +
                        ZSTD_compressBound(n % STORE__SLICE_BYTES);
    bf_status status = buffer_reserve(out, room) != NULL ? BF_OK : bf_fail_memory(err);
    size_t at = 0;

    do {
        size_t n_slice = n - at < STORE__SLICE_BYTES ? n - at : STORE__SLICE_BYTES;
        if (status == BF_OK)
            status = compress(packer, (const char *)bytes + at, n_slice, out, err);
        at += n_slice;
    } while (status == BF_OK && at < n);
    return status;
}

// The size of what is in the frames; UINT64_MAX: they are damaged.
static uint64_t unpacked_size(const bf_buffer *compressed)
{
    uint64_t n = 0;
    size_t at = 0;

    if (compressed->n == 0)
        return UINT64_MAX; // no chunk was found
    do {
        const char *from = compressed->bytes + at;
        size_t left = compressed->n - at;
        unsigned long long size = ZSTD_getFrameContentSize(from, left);
        size_t used = ZSTD_findFrameCompressedSize(from, left);
        // Nothing larger comes from a run; the two marks of an unknown size are larger, too.
        if (size > FRAME_PAYLOAD_MAX - n || ZSTD_isError(used))
            return UINT64_MAX;
        n += size;
        at += used;
    } while (at < compressed->n);
    return n;
}

bf_status store__unpack(const bf_buffer *compressed, bf_buffer *out, bf_error *err)
{
    const uint64_t n = unpacked_size(compressed);

    if (n == UINT64_MAX)
        return bf_fail(err, BF_ECORRUPT, "", "compressed bytes of the store are damaged");
    char *to = buffer_reserve(out, n);
    if (to == NULL)
        return bf_fail_memory(err);
    size_t got = ZSTD_decompress(to, n, compressed->bytes, compressed->n);
    if (ZSTD_isError(got))
        return store__fail_zstd(got, BF_ECORRUPT, err);
    out->n += got;
    out->bytes[out->n] = '\0';
    return BF_OK;
}

static bf_status fail_missing(bf_error *err)
{
    return bf_fail(err, BF_ECORRUPT, "", "a part of stored bytes is missing");
}

// A blob begins in the place of what is there of it; what follows must follow it.
static bf_status check_place(store__connection *writer, int64_t results, store__blob kind,
                             uint64_t item, uint64_t at, bf_error *err)
{
    uint64_t n = 0;

    if (at == 0)
        return store__delete_chunks(writer, results, kind, item, err);
    BF_TRY(store__count_chunks(writer, results, kind, item, &n, err));
    if (at % STORE__SLICE_BYTES != 0 || n != at / STORE__SLICE_BYTES)
        return bf_fail(err, BF_ECORRUPT, "", "an array has a gap: byte %llu came after %llu slices",
                       (unsigned long long)at, (unsigned long long)n);
    return BF_OK;
}

bf_status store__insert_chunks(store__connection *writer, int64_t results, store__blob kind,
                               uint64_t item, uint64_t at, const bf_buffer *compressed,
                               bf_error *err)
{
    uint64_t slice = at / STORE__SLICE_BYTES;

    if (compressed->n == 0)
        return BF_OK;
    BF_TRY(check_place(writer, results, kind, item, at, err));
    for (size_t from = 0, n = 0; from < compressed->n; from += n, slice++) {
        n = ZSTD_findFrameCompressedSize(compressed->bytes + from, compressed->n - from);
        BF_CHECK(!ZSTD_isError(n)); // it comes from store__pack()
        BF_TRY(store__exec(writer, STORE__SQL_INSERT_CHUNK, err, INTEGER(results), INTEGER(kind),
                           INTEGER(item), INTEGER(slice), BLOB(compressed->bytes + from, n)));
    }
    return BF_OK;
}

bf_status store__get_chunks(store__connection *c, int64_t results, store__blob kind, uint64_t item,
                            bf_buffer *out, bf_error *err)
{
    const size_t before = out->n;
    bf_status status = BF_OK;

    store__query q =
        store__start(c, STORE__SQL_LIST_CHUNKS, INTEGER(results), INTEGER(kind), INTEGER(item));
    for (int64_t part = 0; store__next(&q, &status, err); part++)
        status = sqlite3_column_int64(q.statement, 1) == part ? store__column_bytes(&q, 0, out, err)
                                                              : fail_missing(err);
    store__end(&q);
    if (status != BF_OK)
        buffer_truncate(out, before);
    return status;
}

bf_status store__get_chunk(store__connection *c, int64_t results, store__blob kind, uint64_t item,
                           uint64_t part, bf_buffer *out, bf_error *err)
{
    bool has_row = false;

    const bf_status status =
        store__find_bytes(c, STORE__SQL_GET_CHUNK, out, &has_row, err, INTEGER(results),
                          INTEGER(kind), INTEGER(item), INTEGER(part));
    return status == BF_OK && !has_row ? fail_missing(err) : status;
}

bf_status store__count_chunks(store__connection *c, int64_t results, store__blob kind,
                              uint64_t item, uint64_t *ret_n, bf_error *err)
{
    int64_t n = 0;

    BF_TRY(store__find_number(c, STORE__SQL_COUNT_CHUNKS, &n, err, INTEGER(results), INTEGER(kind),
                              INTEGER(item)));
    *ret_n = (uint64_t)n;
    return BF_OK;
}

bf_status store__delete_chunks(store__connection *writer, int64_t results, store__blob kind,
                               uint64_t item, bf_error *err)
{
    return store__exec(writer, STORE__SQL_DELETE_CHUNKS, err, INTEGER(results), INTEGER(kind),
                       INTEGER(item));
}

bf_status store__delete_open_snapshots(store__connection *writer, int64_t results, uint64_t first,
                                       bf_error *err)
{
    return store__exec(writer, STORE__SQL_DELETE_OPEN_SNAPSHOTS, err, INTEGER(results),
                       INTEGER(STORE__BLOB_SNAPSHOT), INTEGER(STORE__BLOB_PARTS), INTEGER(first));
}
