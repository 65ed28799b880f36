// Answers that are made as a whole, up to a limit, and arrays that are sent piece by piece.

#include "api/http/http_priv.h"

#include "api/http/negotiation.h"
#include "api/results/array_file.h"

#include <inttypes.h>

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
