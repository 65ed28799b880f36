#include "core/run/frame.h"
#include "server/store/store_priv.h"

#include <sqlite3.h>
#include <zstd.h>
#include <zstd_errors.h>

enum { LEVEL = 1 };

static bf_status fail_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "out of memory");
}

static bf_status fail_zstd(size_t code, bf_status otherwise, bf_error *err)
{
    if (ZSTD_getErrorCode(code) == ZSTD_error_memory_allocation)
        return fail_memory(err);
    return bf_fail(err, otherwise, "", "compressed bytes of the store: %s",
                   ZSTD_getErrorName(code));
}

static size_t compress(ZSTD_CCtx *context, char *to, size_t room, const void *bytes, size_t n)
{
    size_t code = ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, LEVEL);
    // The checksum tells damage in the file from what the solver wrote.
    if (!ZSTD_isError(code))
        code = ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    return ZSTD_isError(code) ? code : ZSTD_compress2(context, to, room, bytes, n);
}

bf_status store__pack(const void *bytes, size_t n, bf_buffer *out, bf_error *err)
{
    size_t room = ZSTD_compressBound(n);
    char *to = buffer_reserve(out, room);
    ZSTD_CCtx *context = to == NULL ? NULL : ZSTD_createCCtx();

    if (context == NULL)
        return fail_memory(err);
    size_t packed = compress(context, to, room, bytes, n);
    ZSTD_freeCCtx(context);
    if (ZSTD_isError(packed))
        return fail_zstd(packed, BF_ESYSTEM, err);
    out->n += packed;
    out->bytes[out->n] = '\0';
    return BF_OK;
}

bf_status store__unpack(const bf_buffer *packed, bf_buffer *out, bf_error *err)
{
    unsigned long long n = ZSTD_getFrameContentSize(packed->bytes, packed->n);

    // Nothing larger comes from a run; the two marks of an unknown size are larger, too.
    if (n > FRAME_PAYLOAD_MAX)
        return bf_fail(err, BF_ECORRUPT, "", "compressed bytes of the store are damaged");
    char *to = buffer_reserve(out, n);
    if (to == NULL)
        return fail_memory(err);
    size_t got = ZSTD_decompress(to, n, packed->bytes, packed->n);
    if (ZSTD_isError(got))
        return fail_zstd(got, BF_ECORRUPT, err);
    out->n += got;
    out->bytes[out->n] = '\0';
    return BF_OK;
}

static bf_status insert_chunk(store__connection *writer, const int64_t key[4], const char *bytes,
                              size_t n, bf_error *err)
{
    store__query q = store__begin(writer, STORE__SQL_INSERT_CHUNK);
    for (int i = 0; i < 4; i++)
        store__bind_integer(&q, key[i]);
    store__bind_blob(&q, bytes, n);
    return store__run(&q, err);
}

bf_status store__insert_chunks(store__connection *writer, int64_t results, store__blob kind,
                               uint64_t item, const bf_buffer *packed, bf_error *err)
{
    int64_t key[4] = { results, kind, (int64_t)item, 0 };
    bf_status status = BF_OK;

    for (size_t at = 0; at < packed->n && status == BF_OK; at += STORE__CHUNK_BYTES, key[3]++) {
        size_t left = packed->n - at;
        status = insert_chunk(writer, key, packed->bytes + at,
                              left < STORE__CHUNK_BYTES ? left : STORE__CHUNK_BYTES, err);
    }
    return status;
}

static store__query begin_blob(store__connection *c, store__sql sql, int64_t results,
                               store__blob kind, uint64_t item)
{
    store__query q = store__begin(c, sql);
    store__bind_integer(&q, results);
    store__bind_integer(&q, kind);
    store__bind_integer(&q, (int64_t)item);
    return q;
}

bf_status store__get_chunks(store__connection *c, int64_t results, store__blob kind, uint64_t item,
                            bf_buffer *out, bf_error *err)
{
    bool has_row = true;
    bf_status status = BF_OK;

    store__query q = begin_blob(c, STORE__SQL_LIST_CHUNKS, results, kind, item);
    while (status == BF_OK && has_row) {
        status = store__next(&q, &has_row, err);
        if (status == BF_OK && has_row)
            status = store__column_bytes(&q, 0, out, err);
    }
    store__end(&q);
    return status;
}

bf_status store__delete_chunks(store__connection *writer, int64_t results, store__blob kind,
                               uint64_t item, bf_error *err)
{
    store__query q = begin_blob(writer, STORE__SQL_DELETE_CHUNKS, results, kind, item);
    return store__run(&q, err);
}
