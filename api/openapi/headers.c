// The headers of answers that the document describes.

#include "api/openapi/openapi_priv.h"

#include "core/base/check.h"

#include <string.h>

static const openapi_header table[] = {
    { "Accept-Ranges", "string", true, "bytes, if a part can be requested by Range" },
    { "Allow", "string", false, "The methods of the path, with commas" },
    { "Cache-Control", "string", false, "How long the answer may be cached and by whom" },
    { "Content-Disposition", "string", true, "A name for the file" },
    { "Content-Range", "string", false, "Which bytes these are, of how many" },
    { "ETag", "#EntityTag", false, "Identifies the state of the answer; send it as If-None-Match" },
    { "Idempotent-Replayed", "=true", true, "The answer was given before to the same key" },
    { "Link", "string", true,
      "The next page: `</v1/runs?...>; rel=\"next\"`; missing on the last one" },
    { "Location", "string", false, "The path of what was created" },
    { "Preference-Applied", "string", true, "That the answer waited, if Prefer asked for it" },
    { "RateLimit", "string", true,
      "What is left of the client's quotas, and when they are refilled" },
    { "RateLimit-Policy", "string", true,
      "The client's quotas (draft-ietf-httpapi-ratelimit-headers)" },
    { "Retry-After", "#Count", false, "Seconds after which another try can help [s]" },
    { "Vary", "string", true, "The request headers that the answer depends on" },
    { "WWW-Authenticate", "string", false,
      "That a Bearer token is wanted, and what is wrong with the one sent" },
    { "X-Accel-Buffering", "=no", false, "Tells a proxy not to buffer the stream" },
    { "X-Request-Id", "string", false,
      "The id of the request, as it was sent or a new one; logs contain it" },
};

const openapi_header *openapi__headers(size_t *ret_n)
{
    *ret_n = sizeof table / sizeof *table;
    return table;
}

static void write_header_refs(json_out *w, const char *words)
{
    for (size_t n; words != NULL && (n = schema_next_word(&words)) > 0; words += n) {
        size_t k = 0;
        while (k < sizeof table / sizeof *table &&
               (strlen(table[k].name) != n || memcmp(table[k].name, words, n) != 0))
            k++;
        BF_CHECK(k < sizeof table / sizeof *table);
        json_out_key(w, table[k].name);
        json_out_object(w);
        schema_write_ref(w, "headers", table[k].name, n);
        json_out_object_end(w);
    }
}

void openapi__write_headers(json_out *w, const char *words)
{
    json_out_key(w, "headers");
    json_out_object(w);
    write_header_refs(w, words);
    write_header_refs(w, ROUTES_COMMON_HEADERS);
    json_out_object_end(w);
}
