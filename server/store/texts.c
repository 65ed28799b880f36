// Texts of runs. Scenarios and summaries of a study's trials differ in little, so each is stored as what it differs in from
// the scenario of the first trial, which stands with the study: a frame of zstd that has this scenario as its prefix.

#include "server/store/texts.h"

#include "server/store/studies_priv.h"

#include <zstd.h>

// Of compression: level 1 finds long matches as fast as others. What a decoder takes without being asked to (zstd's manual).
enum { LEVEL = 1, WINDOW_LOG_LEAST = 10, WINDOW_LOG_MOST = 27, HASH_LOG_MOST = 20 };

bf_status store__put_text(store__connection *writer, int64_t number, store__text kind,
                          const char *text, size_t n, bf_error *err)
{
    return store__exec(writer, STORE__SQL_PUT_TEXT, err, INTEGER(number), INTEGER(kind),
                       TEXT_OF(text, n));
}

bf_status store__get_text(store__connection *c, int64_t number, store__text kind, bf_buffer *out,
                          bf_error *err)
{
    bool has_row = false;

    BF_TRY(store__find_bytes(c, STORE__SQL_GET_TEXT, out, &has_row, err, INTEGER(number),
                             INTEGER(kind)));
    if (!has_row)
        return bf_fail(err, BF_ENOTFOUND, "", "the run has no such text");
    return BF_OK;
}

// The scenario of the first trial of a study; n = 0: there is none yet.
static bf_status get_base(store__connection *c, const store_study *of, bf_buffer *out,
                          bf_error *err)
{
    bool has_row = false;

    return store__find_bytes(c, STORE__SQL_GET_STUDY_TEXT, out, &has_row, err, INTEGER(of->rowid),
                             INTEGER(API_STUDY_BASE));
}

// A window that holds base and text, and a place of the table for each of their positions.
static size_t set_up(ZSTD_CCtx *context, const bf_buffer *base, size_t n)
{
    int window = WINDOW_LOG_LEAST;

    while (window < WINDOW_LOG_MOST && base->n + n > (size_t)1 << window)
        window++;
    const int parameters[][2] = {
        { ZSTD_c_compressionLevel, LEVEL },
        { ZSTD_c_checksumFlag, 1 },
        { ZSTD_c_windowLog, window },
        { ZSTD_c_hashLog, window < HASH_LOG_MOST ? window : HASH_LOG_MOST },
    };
    size_t code = 0;
    for (size_t k = 0; k < sizeof parameters / sizeof *parameters && !ZSTD_isError(code); k++)
        code = ZSTD_CCtx_setParameter(context, (ZSTD_cParameter)parameters[k][0], parameters[k][1]);
    return ZSTD_isError(code) ? code : ZSTD_CCtx_refPrefix(context, base->bytes, base->n);
}

static bf_status compress(const bf_buffer *base, const char *text, size_t n, bf_buffer *out,
                          bf_error *err)
{
    const size_t room = ZSTD_compressBound(n);
    ZSTD_CCtx *context = ZSTD_createCCtx();
    char *to = buffer_reserve(out, room);

    if (context == NULL || to == NULL) {
        ZSTD_freeCCtx(context);
        return bf_fail_memory(err);
    }
    size_t code = set_up(context, base, n);
    if (!ZSTD_isError(code))
        code = ZSTD_compress2(context, to, room, text, n);
    ZSTD_freeCCtx(context);
    if (ZSTD_isError(code))
        return store__fail_zstd(code, BF_ESYSTEM, err);
    out->n += code;
    return BF_OK;
}

static bf_status decompress(const bf_buffer *base, const bf_buffer *delta, bf_buffer *out,
                            bf_error *err)
{
    const unsigned long long n = ZSTD_getFrameContentSize(delta->bytes, delta->n);

    if (n > FRAME_PAYLOAD_MAX) // so are the two marks of an unknown size
        return bf_fail(err, BF_ECORRUPT, "", "a text of the store is damaged");
    ZSTD_DCtx *context = ZSTD_createDCtx();
    char *to = buffer_reserve(out, (size_t)n);
    if (context == NULL || to == NULL) {
        ZSTD_freeDCtx(context);
        return bf_fail_memory(err);
    }
    size_t code = ZSTD_DCtx_refPrefix(context, base->bytes, base->n);
    if (!ZSTD_isError(code))
        code = ZSTD_decompressDCtx(context, to, (size_t)n, delta->bytes, delta->n);
    ZSTD_freeDCtx(context);
    if (ZSTD_isError(code))
        return store__fail_zstd(code, BF_ECORRUPT, err);
    out->n += code;
    out->bytes[out->n] = '\0';
    return BF_OK;
}

// The first scenario of a study is what others are stored against.
static bf_status need_base(store__connection *writer, const store_study *of, store__text kind,
                           const char *text, size_t n, bf_buffer *base, uint64_t *n_bytes,
                           bf_error *err)
{
    bf_status status = get_base(writer, of, base, err);

    if (status != BF_OK || base->n > 0 || kind != STORE__TEXT_SCENARIO)
        return status;
    if (buffer_append(base, text, n) != BF_OK)
        return bf_fail_memory(err);
    *n_bytes += n;
    return store__put_study_text(writer, of, API_STUDY_BASE, base, err);
}

bf_status store__put_run_text(store__connection *writer, const store__row *row, store__text kind,
                              const char *text, size_t n, uint64_t *n_bytes, bf_error *err)
{
    bf_buffer base = { 0 }, delta = { 0 };
    store_study of;

    if (row->run.study[0] == '\0') {
        *n_bytes += n;
        return store__put_text(writer, row->rowid, kind, text, n, err);
    }
    bf_status status = store__find_study(writer, row->run.study, &of, err);
    if (status == BF_OK)
        status = need_base(writer, &of, kind, text, n, &base, n_bytes, err);
    if (status == BF_OK)
        status = compress(&base, text, n, &delta, err);
    if (status == BF_OK)
        status = store__exec(writer, STORE__SQL_PUT_TEXT_DELTA, err, INTEGER(row->rowid),
                             INTEGER(kind), BLOB(delta.bytes, delta.n));
    *n_bytes += delta.n;
    buffer_fini(&delta);
    buffer_fini(&base);
    return status;
}

bf_status store__get_run_text(store__connection *c, const store__row *row, store__text kind,
                              bf_buffer *out, bf_error *err)
{
    bf_buffer base = { 0 }, delta = { 0 };
    bf_status status = BF_OK;
    bool is_delta = false;
    store_study of;

    if (row->run.study[0] != '\0')
        status = store__find_bytes(c, STORE__SQL_GET_TEXT_DELTA, &delta, &is_delta, err,
                                   INTEGER(row->rowid), INTEGER(kind));
    if (status == BF_OK && !is_delta)
        return store__get_text(c, row->rowid, kind, out, err);
    if (status == BF_OK)
        status = store__find_study(c, row->run.study, &of, err);
    if (status == BF_OK)
        status = get_base(c, &of, &base, err);
    if (status == BF_OK)
        status = decompress(&base, &delta, out, err);
    buffer_fini(&delta);
    buffer_fini(&base);
    return status;
}
