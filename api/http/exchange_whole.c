// Answers that are made as a whole, up to a limit, and arrays that are sent piece by piece.

#include "api/http/http_priv.h"

#include "api/http/negotiation.h"
#include "api/results/array_file.h"

#include <inttypes.h>
#include <math.h>

bool exchange__accepts_plain(const exchange *x)
{
    return negotiation_coding_quality(exchange__header(x, "Accept-Encoding"), CODING_IDENTITY) > 0;
}

size_t exchange__whole_bytes(const exchange *x)
{
    static const coding encoded[] = { CODING_ZSTD, CODING_GZIP };
    const char *accepted = exchange__header(x, "Accept-Encoding");
    const bool is_encoded = accepted != NULL && exchange__header(x, "Range") == NULL &&
                            negotiation_choose_coding(accepted, encoded, 2) >= 0;

    return is_encoded ? EXCHANGE_ENCODED_BYTES : EXCHANGE_PIECE_BYTES;
}

bf_status exchange__reserve_whole(exchange *x, uint64_t n, size_t item_size, const char *other,
                                  bf_error *err)
{
    const bool is_text = x->media->format == MEDIA_CSV || x->media->format == MEDIA_JSON;

    if (n > EXCHANGE_WHOLE_MAX)
        return exchange__refuse(x, 406, "", err,
                                "%" PRIu64 " numbers are too many for %s (limit %d); use %s", n,
                                is_text ? "text" : "an answer with a content coding",
                                EXCHANGE_WHOLE_MAX, is_text ? other : "Accept-Encoding: identity");
    return exchange__reserve(x, (double)n * (double)item_size * (is_text ? 6.0 : 2.0), err);
}

bf_status exchange__send_array(exchange *x, array_file *file, bf_error *err)
{
    bf_status status = BF_OK;

    if (array_file_size(file) > EXCHANGE_PIECE_BYTES)
        return array_file_send(file, &x->response->source, err);
    while (status == BF_OK && x->response->body.n < array_file_size(file))
        status = array_file_read(file, x->services, x->response->body.n, EXCHANGE_PIECE_BYTES,
                                 &x->response->body, err);
    array_file_fini(file);
    return status;
}

bool exchange__wants_several(const exchange *x)
{
    return exchange__whole(x, "count") > 1;
}

// Appends the file of a snapshot, if it fits. *ret_is_over: it does not.
static bf_status append_file(exchange *x, const char *id, uint64_t index, array_file_form form,
                             bool *ret_is_over, bf_error *err)
{
    bf_buffer *body = &x->response->body;
    array_file file = { .item_size = 0 };
    const size_t n = body->n;

    BF_TRY(array_file_open(x->services, id, index, form, &file, err));
    bf_status status = BF_OK;
    const uint64_t size = array_file_size(&file);
    *ret_is_over = n > 0 && n + size > EXCHANGE_SEVERAL_BYTES;
    if (n == 0)
        status = exchange__reserve(x, 2.0 * fmax((double)size, EXCHANGE_SEVERAL_BYTES), err);
    while (status == BF_OK && !*ret_is_over && body->n < n + size)
        status = array_file_read(&file, x->services, body->n - n, EXCHANGE_PIECE_BYTES, body, err);
    array_file_fini(&file);
    return status;
}

// What comes later to a run that goes on is missing here, so that the tag has the number of those that there are.
bf_status exchange__send_several(exchange *x, uint64_t index, bool is_parts, bf_error *err)
{
    const api_run *of = &x->named->run;
    const array_file_form form = is_parts ? ARRAY_FILE_PARTS_NPY : ARRAY_FILE_NPY;
    const uint64_t count = exchange__whole(x, "count"), left = of->n_snapshots - index;
    const uint64_t end = index + (count < left ? count : left);
    bool is_over = false;

    if (count <= left)
        exchange__cache_immutable(x);
    else
        exchange__cache_revalidate(x);
    if (exchange__is_unchanged(x, "%s-%s-%" PRIu64 "-%" PRIu64 "-npy", of->id,
                               is_parts ? "parts" : "densities", index, end))
        return BF_OK;
    for (uint64_t i = index; !is_over && i < end; i++)
        BF_TRY(append_file(x, of->id, i, form, &is_over, err));
    return BF_OK;
}
