// Responses: what the transport adds to every answer, and how MHD is given the result. An answer is finalized
// by the thread that made it, since encoding a large one takes a while.

#include "server/http/http_priv.h"

#include "server/http/cors.h"
#include "server/http/representation.h"

#include <inttypes.h>
#include <microhttpd.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

// MHD's room for what a reader gives, where it does not use chunks.
enum { READER_BLOCK = 4096, LONG_READER_BLOCK = 32768 };

void http__respond_refuse(http_request *r, int status, bf_status code, const char *format, ...)
{
    bf_error err = { .code = code };
    va_list args;

    va_start(args, format);
    vsnprintf(err.text, sizeof err.text, format, args);
    va_end(args);
    if (r->file.fd >= 0)
        (void)close(r->file.fd);
    r->file.fd = -1;
    api_problem(&r->response, status, r->path, &err);
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

// The coding of a body of this kind and size for this client; CODING_COUNT: it accepts none. A file
// was chosen in its form before.
static coding choose_coding(http_request *r, const char *type)
{
    static const coding any[] = { CODING_ZSTD, CODING_GZIP, CODING_IDENTITY };
    static const coding plain_first[] = { CODING_IDENTITY, CODING_ZSTD, CODING_GZIP };
    const char *accepted = http__request_header(r, "Accept-Encoding");
    // A body of this kind has fewer bytes in an encoded form, and no range of it is asked for.
    const bool pays = r->response.body.n >= HTTP_ENCODING_MIN &&
                      (http_encoding_is_text(type) ||
                       (http_encoding_is_array(type) && http__request_header(r, "Range") == NULL));

    if (r->file.fd >= 0)
        return negotiation_coding_quality(accepted, CODING_IDENTITY) > 0 ? CODING_IDENTITY
                                                                         : CODING_COUNT;
    if (!pays && negotiation_coding_quality(accepted, CODING_IDENTITY) > 0)
        return CODING_IDENTITY;
    const coding *offers = pays ? any : plain_first;
    int chosen = negotiation_choose_coding(accepted, offers, CODING_COUNT);
    return chosen < 0 ? CODING_COUNT : offers[chosen];
}

void http__set_coding(api_response *response, coding c)
{
    const char *etag = api_response_find(response, "ETag");
    char tag[CODING_TAG_SIZE + 8];

    api_response_header(response, "Content-Encoding", "%s", negotiation_coding_word(c));
    if (etag == NULL)
        return;
    (void)snprintf(tag, sizeof tag, "%.*s-%s\"", (int)strlen(etag) - 1, etag,
                   negotiation_coding_word(c));
    api_response_set(response, "ETag", tag);
}

// Replaces the body by its encoded form; without memory it stays as it is.
static void encode(api_response *response, coding c)
{
    bf_buffer encoded = { 0 };

    if (http_encoding_pack(c, response->body.bytes, response->body.n, &encoded) != BF_OK)
        return;
    buffer_fini(&response->body);
    response->body = encoded;
    http__set_coding(response, c);
}

static bool has_source(const http_request *r)
{
    return r->response.source.next_chunk != NULL;
}

// True if the body is made while it is sent, and its length is known before.
static bool has_long_body(const http_request *r)
{
    return r->response.source.seek != NULL;
}

static uint64_t length_of(const http_request *r)
{
    if (has_long_body(r))
        return r->response.source.n;
    return r->file.fd >= 0 ? r->file.n : r->response.body.n;
}

// Cuts the answer to the range that was asked for.
static void cut(http_request *r)
{
    const char *etag = api_response_find(&r->response, "ETag");
    const char *asked = strcmp(r->method, "GET") == 0 ? http__request_header(r, "Range") : NULL;
    uint64_t n_all = length_of(r);
    uint64_t first = 0, n = n_all;

    api_response_header(&r->response, "Accept-Ranges", "bytes");
    if (asked == NULL || etag == NULL ||
        !http_range_is_current(http__request_header(r, "If-Range"), etag))
        return;
    http_range what = http_range_read(asked, n_all, &first, &n);
    if (what == HTTP_RANGE_BEYOND) {
        http__respond_refuse(r, 416, BF_EINPUT,
                             "the range begins behind the end: there are %" PRIu64 " bytes", n_all);
        identify(r);
        api_response_header(&r->response, "Content-Range", "bytes */%" PRIu64, n_all);
    }
    if (what != HTTP_RANGE_PART)
        return;
    r->response.status = 206;
    r->is_cut = true;
    r->first = first;
    r->n_sent = n;
    if (has_long_body(r))
        r->response.source.seek(r->response.source.state, first);
    api_response_header(&r->response, "Content-Range", "bytes %" PRIu64 "-%" PRIu64 "/%" PRIu64,
                        first, first + n - 1, n_all);
}

// Chooses which form of the body is sent: encoded, a range of it, or as it is. A file comes in the
// form that it was opened in.
static void choose_form(http_request *r)
{
    const char *type = api_response_find(&r->response, "Content-Type");
    bool is_done = api_response_find(&r->response, "Content-Encoding") != NULL;
    bool has_content = type != NULL && (r->file.fd >= 0 || length_of(r) > 0);

    if (r->response.status == 204)
        return;
    api_response_vary(&r->response, "Accept-Encoding");
    if (is_done || !has_content)
        return;
    bool is_text = http_encoding_is_text(type);
    coding chosen = choose_coding(r, type);
    if (chosen == CODING_COUNT && r->response.status < 300) {
        http__respond_refuse(r, 406, BF_EINPUT,
                             "none of the codings that Accept-Encoding allows is known here; "
                             "there is: zstd gzip identity");
        api_response_vary(&r->response, "Accept-Encoding");
        identify(r);
    } else if (chosen < CODING_IDENTITY) {
        encode(&r->response, chosen);
    } else if (r->response.status == 200 && (!is_text || r->file.fd >= 0)) {
        cut(r);
    }
}

void http__finalize_response(http_request *r)
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
    http_limit_write_headers(&r->verdict, response);
    // Every response has these, unless the API set them otherwise.
    if (api_response_find(response, "X-Content-Type-Options") == NULL)
        api_response_header(response, "X-Content-Type-Options", "nosniff");
    if (api_response_find(response, "Cache-Control") == NULL)
        api_response_header(response, "Cache-Control", "no-store");
    api_response_set(response, "Cross-Origin-Resource-Policy",
                     http_cors_resource_policy(r->server->cors_origins));
    if (r->refusal != 0)
        api_response_header(response, "Connection", "close");
    const char *tag = api_response_find(&r->response, "ETag");
    const bool has_length = has_long_body(r) || !has_source(r);
    if (r->response.status == 200 && tag != NULL && has_length && r->file.fd < 0)
        http_content_lengths_remember(&r->server->lengths, r->path, r->query, tag, length_of(r));
}

static bool is_pulled(const http_request *r)
{
    return has_source(r) && strcmp(r->method, "HEAD") != 0;
}

static struct MHD_Response *make_reader(http_request *r, uint64_t n)
{
    return MHD_create_response_from_callback(n, has_long_body(r) ? LONG_READER_BLOCK : READER_BLOCK,
                                             http__pull_read, r, NULL);
}

// An answer without a body whose length, if it had one, is not known: HEAD of such a body, and a 304,
// whose length would be that of the 200 (RFC 9110, 8.6). MHD ends such an answer with an empty chunk,
// unless it may not use chunks; then the connection closes.
static struct MHD_Response *make_without_length(http_request *r)
{
    struct MHD_Response *response = make_reader(r, MHD_SIZE_UNKNOWN);

    if (response != NULL)
        (void)MHD_set_response_options(response, MHD_RF_HTTP_1_0_COMPATIBLE_STRICT, MHD_RO_END);
    return response;
}

static struct MHD_Response *make_response(http_request *r)
{
    bf_buffer *body = &r->response.body;

    if (has_long_body(r))
        return make_reader(r, r->is_cut ? r->n_sent : r->response.source.n);
    if (has_source(r))
        return is_pulled(r) ? make_reader(r, MHD_SIZE_UNKNOWN) : make_without_length(r);
    if (r->response.status == 304 && r->file.fd < 0 && body->n == 0) {
        // A 304 without the body that its 200 has: nothing is read of it.
        const char *tag = api_response_find(&r->response, "ETag");
        uint64_t n;
        if (tag == NULL ||
            !http_content_lengths_find(&r->server->lengths, r->path, r->query, tag, &n))
            return make_without_length(r);
        return make_reader(r, n);
    }
    if (r->file.fd >= 0)
        return MHD_create_response_from_fd_at_offset64(r->is_cut ? r->n_sent : r->file.n,
                                                       r->file.fd, r->is_cut ? r->first : 0);
    if (r->is_cut)
        return MHD_create_response_from_buffer((size_t)r->n_sent, body->bytes + r->first,
                                               MHD_RESPMEM_PERSISTENT);
    return MHD_create_response_from_buffer(body->n, body->bytes, MHD_RESPMEM_PERSISTENT);
}

// Bodies that are pulled are limited in number.
static void admit(http_request *r)
{
    bool is_stream = r->response.source.is_stream;

    if (!is_pulled(r) || http__pull_begin_body(r))
        return;
    http__respond_refuse(
        r, 503, BF_EBUSY, "there are %u %s, which is the limit, or a client has its share of them",
        is_stream ? r->server->options.stream_limit : r->server->options.download_limit,
        is_stream ? "event streams" : "downloads");
    r->is_finished = false;
}

bool http__respond(http_request *r)
{
    admit(r);
    http__finalize_response(r);
    struct MHD_Response *response = make_response(r);
    if (response == NULL)
        return false;
    r->file.fd = -1;
    r->stage = HTTP_STAGE_SENT;
    bool is_good = true;
    for (size_t i = 0; i < r->response.n_headers; i++)
        is_good = is_good && MHD_add_response_header(response, r->response.headers[i].name,
                                                     r->response.headers[i].value) == MHD_YES;
    is_good =
        is_good && MHD_queue_response(r->mhd, (unsigned)r->response.status, response) == MHD_YES;
    MHD_destroy_response(response);
    return is_good;
}

static bf_status write_head(const api_response *response, bf_buffer *out)
{
    BF_TRY(buffer_printf(out, "HTTP/1.1 %d \r\n", response->status));
    for (size_t i = 0; i < response->n_headers; i++)
        BF_TRY(buffer_printf(out, "%s: %s\r\n", response->headers[i].name,
                             response->headers[i].value));
    return buffer_printf(out, "Content-Length: %zu\r\n\r\n", response->body.n);
}

void http__respond_past_body(http_request *r)
{
    bf_buffer bytes = { 0 };

    http__finalize_response(r);
    r->stage = HTTP_STAGE_SENT;
    // Nothing was sent on this connection's request before, so it fits into the socket's buffer.
    if (write_head(&r->response, &bytes) == BF_OK &&
        buffer_append(&bytes, r->response.body.bytes, r->response.body.n) == BF_OK)
        (void)send(r->connection->fd, bytes.bytes, bytes.n, MSG_DONTWAIT | MSG_NOSIGNAL);
    buffer_fini(&bytes);
}
