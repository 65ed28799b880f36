// Conditions of a request (RFC 9110, 13): the entity tag of a resource's state, and what If-Match and
// If-None-Match say of it. The dates of states are not told, so conditions by date are ignored.

#include "api/http/exchange.h"

#include "api/http/http_priv.h"
#include "api/http/negotiation.h"
#include "core/base/check.h"
#include "core/base/digest.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

bf_status exchange__check_change(exchange *x, const char *const *tags, bf_error *err)
{
    const char *wanted = exchange__header(x, "If-Match");
    const char *unwanted = exchange__header(x, "If-None-Match");
    const char *accepted = exchange__header(x, "Accept-Encoding");
    char form[CODING_TAG_SIZE];
    bool is_wanted = wanted == NULL, is_unwanted = false;

    for (size_t i = 0; tags[i] != NULL; i++) {
        is_wanted = is_wanted || negotiation_allows_change(wanted, tags[i]);
        is_unwanted = is_unwanted || (unwanted != NULL &&
                                      negotiation_match_etag(unwanted, tags[i], accepted, form));
    }
    if (is_wanted && !is_unwanted)
        return BF_OK;
    return exchange__refuse(
        x, 412, "", err, "the state is %s: it is \"%s\"",
        is_wanted ? "one that If-None-Match excludes" : "not the one that If-Match names", tags[0]);
}

bf_status exchange__check_match(exchange *x, uint64_t revision, uint64_t *ret_revision,
                                bf_error *err)
{
    char tag[EXCHANGE_ETAG_SIZE], predicted[EXCHANGE_ETAG_SIZE];
    const char *const tags[] = { tag, predicted, NULL };

    snprintf(tag, sizeof tag, "r%" PRIu64, revision);
    snprintf(predicted, sizeof predicted, "r%" PRIu64 "p", revision); // see handlers_runs_show()
    BF_TRY(exchange__check_change(x, tags, err));
    *ret_revision = exchange__header(x, "If-Match") == NULL ? API_ANY_REVISION : revision;
    return BF_OK;
}

// Sets ETag, and the status if the client has this state. ret_form is the tag that it knows it by.
static bool tag_state(exchange *x, const char *tag, char *ret_form)
{
    const char *wanted = exchange__header(x, "If-Match");
    const char *known = exchange__header(x, "If-None-Match");

    api_response_header(x->response, "ETag", "\"%s\"", tag);
    x->is_unmatched = wanted != NULL && !negotiation_allows_change(wanted, tag);
    if (x->is_unmatched || known == NULL ||
        !negotiation_match_etag(known, tag, exchange__header(x, "Accept-Encoding"), ret_form))
        return false;
    x->response->status = 304;
    return true;
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
        return x->is_unmatched;
    snprintf(quoted, sizeof quoted, "\"%s\"", form);
    api_response_set(x->response, "ETag", quoted);
    return true;
}

bf_status exchange__check_state(exchange *x, bf_error *err)
{
    const api_response *response = x->response;

    // A cacheable answer without an entity tag gets a digest of its bytes as one.
    if (response->status == 200 && !response->source.is_stream && x->route->method[0] == 'G' &&
        api_response_find(response, "Cache-Control") != NULL &&
        api_response_find(response, "ETag") == NULL)
        (void)exchange__match_etag(
            x, "%016" PRIx64, digest_add(DIGEST_START, response->body.bytes, response->body.n));
    if (!x->is_unmatched)
        return BF_OK;
    return exchange__refuse(x, 412, "", err,
                            "the state is not the one that If-Match names: it is %s",
                            api_response_find(x->response, "ETag"));
}

void exchange__cache_immutable(exchange *x)
{
    api_response_header(x->response, "Cache-Control", "private, max-age=31536000, immutable");
}

void exchange__cache_revalidate(exchange *x)
{
    api_response_header(x->response, "Cache-Control", "private, no-cache");
}
