#include "server/http/cors.h"

#include <string.h>
#include <strings.h>

// The headers that a page may send beyond those that are always allowed, and those that it may read.
static const char request_headers[] =
    "Authorization, Content-Type, Idempotency-Key, If-Match, If-None-Match, "
    "If-Range, Last-Event-ID, Prefer, Range, "
    "X-Request-Id, traceparent";
static const char response_headers[] =
    "Allow, Accept-Ranges, Content-Disposition, Content-Encoding, Content-Range, ETag, "
    "Idempotent-Replayed, Link, Location, Preference-Applied, RateLimit, RateLimit-Policy, "
    "Retry-After, X-Request-Id, traceparent";
static const char max_age_s[] = "7200"; // more is cut by browsers

static const char separators[] = ", \t";

// scheme "://" host [":" port], nothing behind it.
static bool is_origin(const char *text, size_t n)
{
    static const char *const schemes[] = { "http://", "https://" };

    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++) {
        size_t n_scheme = strlen(schemes[i]);
        if (n <= n_scheme || strncmp(text, schemes[i], n_scheme) != 0)
            continue;
        return strspn(text + n_scheme, "abcdefghijklmnopqrstuvwxyz0123456789.-_:[]") ==
               n - n_scheme;
    }
    return false;
}

// The next origin of a list from *text on, of *n bytes; moves *text behind it. False: no more.
static bool next_origin(const char **text, const char **ret_origin, size_t *ret_n)
{
    const char *p = *text + strspn(*text, separators);

    *ret_origin = p;
    *ret_n = strcspn(p, separators);
    *text = p + *ret_n;
    return *ret_n > 0;
}

bf_status http_cors_check(const char *origins, bf_error *err)
{
    const char *origin, *rest = origins;
    size_t n = 0;

    if (strcmp(origins, "*") == 0)
        return BF_OK;
    while (next_origin(&rest, &origin, &n)) {
        if (!is_origin(origin, n))
            return bf_fail(
                err, BF_EINPUT, "",
                "'%.*s' is no origin; one is https://plan.example:8443, in small letters "
                "and without a path, and * alone is any",
                (int)(n < 100 ? n : 100), origin);
    }
    return BF_OK;
}

static bool is_listed(const char *origins, const char *origin)
{
    const char *item;
    size_t n = 0;

    while (next_origin(&origins, &item, &n)) {
        if (strlen(origin) == n && memcmp(item, origin, n) == 0)
            return true;
    }
    return false;
}

static bool is_any(const char *origins)
{
    return strcmp(origins, "*") == 0;
}

static bool is_allowed(const char *origins, const char *origin)
{
    return origin != NULL && (is_any(origins) || is_listed(origins, origin));
}

// The bytes of an authority without the port that its scheme has anyway.
static size_t skip_port(const char *authority, bool is_https)
{
    const char *port = is_https ? ":443" : ":80";
    size_t n = strlen(authority), n_port = strlen(port);

    return n > n_port && strcmp(authority + n - n_port, port) == 0 ? n - n_port : n;
}

// True if origin is that of a page of this host and port. The scheme of our own page is not known behind a proxy.
static bool is_own(const char *origin, const char *host)
{
    const char *authority = strstr(origin, "://");

    if (authority == NULL || host == NULL)
        return false;
    authority += strlen("://");
    bool is_https = strncmp(origin, "https:", strlen("https:")) == 0;
    size_t n = skip_port(authority, is_https);
    return n == skip_port(host, is_https) && strncasecmp(authority, host, n) == 0;
}

bool http_cors_is_forged(const char *origins, const http_cors_sender *sender)
{
    const char *method = sender->method, *site = sender->fetch_site;
    const bool is_safe =
        strcmp(method, "GET") == 0 || strcmp(method, "HEAD") == 0 || strcmp(method, "OPTIONS") == 0;
    bool is_of_own_page = sender->origin == NULL || is_own(sender->origin, sender->host);

    // "none" is what a person does in the browser itself.
    if (site != NULL)
        is_of_own_page = strcmp(site, "same-origin") == 0 || strcmp(site, "none") == 0;
    return !is_safe && !is_of_own_page && !is_allowed(origins, sender->origin);
}

const char *http_cors_resource_policy(const char *origins)
{
    return is_any(origins) ? "cross-origin" : "same-origin";
}

static void answer_preflight(api_response *response)
{
    const char *allow = api_response_find(response, "Allow");

    if (allow == NULL)
        return;
    api_response_set(response, "Access-Control-Allow-Methods", allow);
    api_response_set(response, "Access-Control-Allow-Headers", request_headers);
    api_response_set(response, "Access-Control-Max-Age", max_age_s);
}

void http_cors_answer(const char *origins, const char *method, const char *origin,
                      const char *asked_method, api_response *response)
{
    if (*origins == '\0')
        return;
    if (!is_any(origins))
        api_response_vary(response, "Origin"); // also for those that get nothing
    if (!is_allowed(origins, origin))
        return;
    api_response_set(response, "Access-Control-Allow-Origin", is_any(origins) ? "*" : origin);
    if (strcmp(method, "OPTIONS") == 0 && asked_method != NULL)
        answer_preflight(response);
    else
        api_response_set(response, "Access-Control-Expose-Headers", response_headers);
}
