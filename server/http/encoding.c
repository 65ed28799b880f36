#include "server/http/encoding.h"

#include "core/base/check.h"

#include <stdint.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>
#include <zstd.h>

enum {
    GZIP_LEVEL = 5,
    GZIP_WINDOW = 15 + 16, // the largest window, with gzip's frame
    GZIP_MEMORY = 8,       // zlib's default
    ZSTD_LEVEL = 3,
    INPUT_MAX = 1 << 30, // bytes that zlib takes at once, and more than any body has
};

static const char *const text_types[] = {
    "application/json",     "application/manifest", "application/wasm",
    "application/x-ndjson", "application/xml",
};

bool http_encoding_is_text(const char *content_type)
{
    size_t n = strcspn(content_type, "; ");

    if (strncasecmp(content_type, "text/", 5) == 0)
        return strncasecmp(content_type, "text/event-stream", n) != 0;
    for (size_t i = 0; i < sizeof text_types / sizeof *text_types; i++) {
        if (n == strlen(text_types[i]) && strncasecmp(content_type, text_types[i], n) == 0)
            return true;
    }
    return (n > 5 && strncasecmp(content_type + n - 5, "+json", 5) == 0) ||
           (n > 4 && strncasecmp(content_type + n - 4, "+xml", 4) == 0);
}

static bf_status pack_gzip(const void *bytes, size_t n, bf_buffer *out)
{
    z_stream z = { .next_in = (Bytef *)(uintptr_t)bytes, .avail_in = (uInt)n };

    if (deflateInit2(&z, GZIP_LEVEL, Z_DEFLATED, GZIP_WINDOW, GZIP_MEMORY, Z_DEFAULT_STRATEGY) !=
        Z_OK)
        return BF_ENOMEM;
    size_t room = deflateBound(&z, (uLong)n);
    char *to = buffer_reserve(out, room);
    bf_status status = BF_ENOMEM;
    if (to != NULL) {
        z.next_out = (Bytef *)to;
        z.avail_out = (uInt)room;
        BF_CHECK(deflate(&z, Z_FINISH) == Z_STREAM_END);
        out->n += room - z.avail_out;
        status = BF_OK;
    }
    (void)deflateEnd(&z);
    return status;
}

static bf_status pack_zstd(const void *bytes, size_t n, bf_buffer *out)
{
    size_t room = ZSTD_compressBound(n);
    char *to = buffer_reserve(out, room);

    if (to == NULL)
        return BF_ENOMEM;
    size_t packed = ZSTD_compress(to, room, bytes, n, ZSTD_LEVEL);
    if (ZSTD_isError(packed)) // with room enough only for want of memory
        return BF_ENOMEM;
    out->n += packed;
    return BF_OK;
}

bf_status http_encoding_pack(coding c, const void *bytes, size_t n, bf_buffer *out)
{
    if (n > INPUT_MAX)
        return BF_ENOMEM;
    if (c == CODING_GZIP)
        return pack_gzip(bytes, n, out);
    BF_CHECK(c == CODING_ZSTD);
    return pack_zstd(bytes, n, out);
}
