#include "server/http/representation.h"

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

bool http_encoding_is_array(const char *content_type)
{
    static const char *const types[] = { "application/octet-stream", "application/x-npy" };
    size_t n = strcspn(content_type, "; ");

    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (n == strlen(types[i]) && strncasecmp(content_type, types[i], n) == 0)
            return true;
    }
    return false;
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
    size_t n_encoded = ZSTD_compress(to, room, bytes, n, ZSTD_LEVEL);
    if (ZSTD_isError(n_encoded)) // with room enough only for want of memory
        return BF_ENOMEM;
    out->n += n_encoded;
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

// Reads digits and moves *text behind them; beyond 2^64 - 1 it is that. False: there are none.
static bool read_number(const char **text, uint64_t *ret_number)
{
    const char *p = *text;
    uint64_t number = 0;

    for (; *p >= '0' && *p <= '9'; p++) {
        uint64_t digit = (uint64_t)(*p - '0');
        number = number > (UINT64_MAX - digit) / 10 ? UINT64_MAX : number * 10 + digit;
    }
    if (p == *text)
        return false;
    *text = p;
    *ret_number = number;
    return true;
}

static bool is_end(const char *text)
{
    return text[strspn(text, " \t")] == '\0';
}

// "-500": the last bytes.
static http_range read_suffix(const char *text, uint64_t n, uint64_t *ret_first, uint64_t *ret_n)
{
    uint64_t length = 0;

    if (!read_number(&text, &length) || !is_end(text))
        return HTTP_RANGE_WHOLE;
    if (length == 0 || n == 0)
        return HTTP_RANGE_BEYOND;
    *ret_n = length < n ? length : n;
    *ret_first = n - *ret_n;
    return HTTP_RANGE_PART;
}

http_range http_range_read(const char *header, uint64_t n, uint64_t *ret_first, uint64_t *ret_n)
{
    static const char unit[] = "bytes=";
    uint64_t first = 0, last = UINT64_MAX;

    if (header == NULL || strncasecmp(header, unit, sizeof unit - 1) != 0)
        return HTTP_RANGE_WHOLE;
    const char *text = header + sizeof unit - 1;
    text += strspn(text, " \t");
    if (*text == '-')
        return read_suffix(text + 1, n, ret_first, ret_n);
    if (!read_number(&text, &first) || *text++ != '-')
        return HTTP_RANGE_WHOLE;
    bool has_last = read_number(&text, &last);
    if (!is_end(text) || (has_last && last < first))
        return HTTP_RANGE_WHOLE;
    if (first >= n)
        return HTTP_RANGE_BEYOND;
    *ret_first = first;
    *ret_n = (last < n - 1 ? last : n - 1) - first + 1;
    return HTTP_RANGE_PART;
}

bool http_range_is_current(const char *if_range, const char *etag)
{
    return if_range == NULL || (*etag == '"' && strcmp(if_range, etag) == 0);
}
