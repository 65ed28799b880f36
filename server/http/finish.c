// The last step before a response is sent: what the transport adds to every answer. It is done by the
// thread that made the answer, since encoding a large one takes a while.

#include "server/http/http_priv.h"

#include "server/http/cors.h"
#include "server/http/encoding.h"
#include "server/http/range.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// Headers that every response carries, unless the API set them otherwise.
static const api_header standard[] = {
    { "X-Content-Type-Options", "nosniff" },
    { "Cache-Control", "no-store" },
};

enum { N_STANDARD = sizeof standard / sizeof *standard };

static void add_standard(api_response *response)
{
    for (size_t i = 0; i < N_STANDARD; i++) {
        if (api_response_find(response, standard[i].name) == NULL)
            api_response_header(response, standard[i].name, "%s", standard[i].value);
    }
}

static void identify(http_request *r)
{
    if (r->trace.id[0] == '\0')
        return;
    api_problem_identify(&r->response, r->trace.id);
    api_response_set(&r->response, "X-Request-Id", r->trace.id);
    if (r->trace.parent[0] != '\0')
        api_response_set(&r->response, "traceparent", r->trace.parent);
}

static bool is_get(const http_request *r)
{
    return strcmp(r->method, "GET") == 0;
}

// The coding of a body of this kind and size for this client; CODING_COUNT: it accepts none. A file is
// plain by now.
static coding choose_coding(http_request *r, bool is_text)
{
    static const coding any[] = { CODING_ZSTD, CODING_GZIP, CODING_IDENTITY };
    static const coding plain_first[] = { CODING_IDENTITY, CODING_ZSTD, CODING_GZIP };
    const char *accepted = http__request_header(r, "Accept-Encoding");
    bool pays = is_text && r->response.body.n >= HTTP_ENCODING_MIN;

    if (r->file.fd >= 0)
        return coding_quality(accepted, CODING_IDENTITY) > 0 ? CODING_IDENTITY : CODING_COUNT;
    if (!pays && coding_quality(accepted, CODING_IDENTITY) > 0)
        return CODING_IDENTITY;
    const coding *offers = pays ? any : plain_first;
    int chosen = coding_choose(accepted, offers, CODING_COUNT);
    return chosen < 0 ? CODING_COUNT : offers[chosen];
}

void http__finish_encoded(api_response *response, coding c)
{
    const char *etag = api_response_find(response, "ETag");
    char tag[CODING_TAG_SIZE + 8];

    api_response_header(response, "Content-Encoding", "%s", coding_word(c));
    if (etag == NULL)
        return;
    (void)snprintf(tag, sizeof tag, "%.*s-%s\"", (int)strlen(etag) - 1, etag, coding_word(c));
    api_response_set(response, "ETag", tag);
}

// Replaces the body by its encoded form; without memory it stays as it is.
static void encode(api_response *response, coding c)
{
    bf_buffer packed = { 0 };

    if (http_encoding_pack(c, response->body.bytes, response->body.n, &packed) != BF_OK)
        return;
    buffer_fini(&response->body);
    response->body = packed;
    http__finish_encoded(response, c);
}

static void refuse_coding(http_request *r)
{
    const bf_error err = { .code = BF_EINPUT,
                           .text = "none of the codings that Accept-Encoding allows is known here; "
                                   "there is: zstd gzip identity" };
    http__respond_refuse(r, 406, &err);
    api_response_vary(&r->response, "Accept-Encoding");
    identify(r);
}

static void refuse_range(http_request *r, uint64_t n)
{
    bf_error err = { 0 };

    (void)bf_fail(&err, BF_EINPUT, "",
                  "the range begins behind the end: there are %" PRIu64 " bytes", n);
    http__respond_refuse(r, 416, &err);
    identify(r);
    api_response_header(&r->response, "Content-Range", "bytes */%" PRIu64, n);
}

// Cuts the answer to the range that was asked for.
static void cut(http_request *r)
{
    const char *etag = api_response_find(&r->response, "ETag");
    const char *asked = is_get(r) ? http__request_header(r, "Range") : NULL;
    uint64_t n_all = r->file.fd >= 0 ? r->file.n : r->response.body.n;
    uint64_t first = 0, n = n_all;

    api_response_header(&r->response, "Accept-Ranges", "bytes");
    if (asked == NULL || etag == NULL ||
        !http_range_is_current(http__request_header(r, "If-Range"), etag))
        return;
    http_range what = http_range_read(asked, n_all, &first, &n);
    if (what == HTTP_RANGE_BEYOND)
        refuse_range(r, n_all);
    if (what != HTTP_RANGE_PART)
        return;
    r->response.status = 206;
    r->is_cut = true;
    r->first = first;
    r->n_sent = n;
    api_response_header(&r->response, "Content-Range", "bytes %" PRIu64 "-%" PRIu64 "/%" PRIu64,
                        first, first + n - 1, n_all);
}

// Chooses which form of the body is sent: encoded, a range of it, or as it is. A file comes in the
// form that it was opened in.
static void choose_form(http_request *r)
{
    const char *type = api_response_find(&r->response, "Content-Type");
    bool is_done = api_response_find(&r->response, "Content-Encoding") != NULL;
    bool has_content = type != NULL && (r->file.fd >= 0 || r->response.body.n > 0);

    if (r->response.status == 204)
        return;
    api_response_vary(&r->response, "Accept-Encoding");
    if (is_done || !has_content)
        return;
    bool is_text = http_encoding_is_text(type);
    coding chosen = choose_coding(r, is_text);
    if (chosen == CODING_COUNT && r->response.status < 300)
        refuse_coding(r);
    else if (chosen < CODING_IDENTITY)
        encode(&r->response, chosen);
    else if (r->response.status == 200 && (!is_text || r->file.fd >= 0))
        cut(r);
}

void http__finish(http_request *r)
{
    api_response *response = &r->response;

    if (r->is_finished)
        return;
    r->is_finished = true;
    identify(r);
    if (!response->source.is_stream)
        choose_form(r);
    if (response->status == 304) {
        api_response_drop(response, "Content-Type");
        api_response_drop(response, "Content-Encoding");
    }
    http_cors_answer(r->server->cors_origins, r->method, http__request_header(r, "Origin"),
                     http__request_header(r, "Access-Control-Request-Method"), response);
    http_limit_tell(&r->verdict, response);
    add_standard(response);
    if (r->refusal != 0)
        api_response_header(response, "Connection", "close");
}
