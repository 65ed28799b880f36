// What handlers say in a response beside its body: refusals, caching, names, links.

#include "api/http/http_priv.h"
#include "api/http/precondition.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *exchange__header(const exchange *x, const char *name)
{
    return x->request->header(x->request->header_context, name);
}

bf_status exchange__refuse(exchange *x, int http_status, const char *pointer, bf_error *err,
                           const char *format, ...)
{
    char text[BF_TEXT_SIZE];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    x->refusal = http_status;
    return bf_fail(err, BF_EINPUT, pointer, "%s", text);
}

void exchange__cache_immutable(exchange *x)
{
    api_response_header(x->response, "Cache-Control", "private, max-age=31536000, immutable");
}

void exchange__name_snapshot(exchange *x, uint64_t index)
{
    api_response_header(x->response, "Content-Disposition", "inline; filename=\"%06" PRIu64 ".%s\"",
                        index, x->media->word);
}

// Sets ETag, and the status if the client has this state. ret_form is the tag that it knows it by.
static bool tag_state(exchange *x, const char *tag, char *ret_form)
{
    const char *known = exchange__header(x, "If-None-Match");
    bool is_known =
        known != NULL &&
        precondition_match_etag(known, tag, exchange__header(x, "Accept-Encoding"), ret_form);

    api_response_header(x->response, "ETag", "\"%s\"", tag);
    if (is_known)
        x->response->status = 304;
    return is_known;
}

static void write_tag(char *tag, const char *format, va_list args)
{
    int n = vsnprintf(tag, EXCHANGE_ETAG_SIZE, format, args);

    BF_CHECK(n >= 0 && n < EXCHANGE_ETAG_SIZE);
}

bool exchange__match_etag(exchange *x, const char *format, ...)
{
    char tag[EXCHANGE_ETAG_SIZE], form[CODING_TAG_SIZE];
    va_list args;

    va_start(args, format);
    write_tag(tag, format, args);
    va_end(args);
    return tag_state(x, tag, form);
}

bool exchange__is_unchanged(exchange *x, const char *format, ...)
{
    char tag[EXCHANGE_ETAG_SIZE], form[CODING_TAG_SIZE], quoted[CODING_TAG_SIZE + 2];
    va_list args;

    va_start(args, format);
    write_tag(tag, format, args);
    va_end(args);
    if (!tag_state(x, tag, form))
        return false;
    snprintf(quoted, sizeof quoted, "\"%s\"", form);
    api_response_set(x->response, "ETag", quoted);
    return true;
}

void exchange__cache_revalidate(exchange *x)
{
    api_response_header(x->response, "Cache-Control", "private, no-cache");
}

// Writes a value for a query; text has room for three bytes per byte of value.
static void encode_value(const char *value, char *text)
{
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";

    for (; *value != '\0'; value++) {
        if (strchr(plain, *value) != NULL)
            *text++ = *value;
        else
            text += sprintf(text, "%%%02X", (unsigned char)*value);
    }
    *text = '\0';
}

void exchange__link_next(exchange *x, const exchange_page *page, const char *filters,
                         const char *last_id)
{
    char label[API_LABEL_SIZE * 3];

    encode_value(page->label, label);
    api_response_header(x->response, "Link", "<%s?limit=%zu%s%s%s&cursor=%s>; rel=\"next\"",
                        x->route->path, page->limit, filters,
                        label[0] == '\0' ? "" : "&label=", label, last_id);
}
