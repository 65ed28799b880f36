#include "server/http_priv.h"

#include <microhttpd.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>

// Headers that every response carries, unless the API set them otherwise.
static const api_header standard[] = {
    { "X-Content-Type-Options", "nosniff" },
    { "Cache-Control", "no-store" },
};

enum { N_STANDARD = sizeof standard / sizeof *standard };

static bool has_header(const api_response *response, const char *name)
{
    for (size_t i = 0; i < response->n_headers; i++) {
        if (strcasecmp(response->headers[i].name, name) == 0)
            return true;
    }
    return false;
}

static void add_missing(api_response *response)
{
    for (size_t i = 0; i < N_STANDARD; i++) {
        if (!has_header(response, standard[i].name))
            api_response_header(response, standard[i].name, "%s", standard[i].value);
    }
}

static void complete_headers(http_request *r)
{
    add_missing(&r->response);
    if (r->refusal != 0)
        api_response_header(&r->response, "Connection", "close");
}

void http__respond_refuse(http_request *r, int status, const bf_error *err)
{
    api_problem(&r->response, status, r->path, err);
}

static bool is_streamed(const http_request *r)
{
    return r->response.is_stream && strcmp(r->method, "HEAD") != 0;
}

// HEAD of a stream reads nothing. MHD would still end its answer with an empty chunk, unless it may
// not use chunks; then the connection closes.
static struct MHD_Response *make_stream(http_request *r)
{
    struct MHD_Response *response =
        MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, 4096, http__stream_read, r, NULL);

    if (response != NULL && !is_streamed(r))
        (void)MHD_set_response_options(response, MHD_RF_HTTP_1_0_COMPATIBLE_STRICT, MHD_RO_END);
    return response;
}

static struct MHD_Response *make_response(http_request *r)
{
    bf_buffer *body = &r->response.body;

    if (r->response.is_stream)
        return make_stream(r);
    if (r->file.fd >= 0)
        return MHD_create_response_from_fd64(r->file.n, r->file.fd);
    return MHD_create_response_from_buffer(body->n, body->bytes, MHD_RESPMEM_PERSISTENT);
}

static void admit_stream(http_request *r)
{
    if (!is_streamed(r) || http__stream_begin(r))
        return;
    bf_error err = { 0 };
    (void)bf_fail(&err, BF_EBUSY, "", "there are %u event streams, which is the limit",
                  r->server->options.stream_limit);
    http__respond_refuse(r, 503, &err);
}

bool http__respond(http_request *r)
{
    admit_stream(r);
    complete_headers(r);
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
    bf_status status = buffer_printf(out, "HTTP/1.1 %d \r\n", response->status);

    for (size_t i = 0; status == BF_OK && i < response->n_headers; i++)
        status =
            buffer_printf(out, "%s: %s\r\n", response->headers[i].name, response->headers[i].value);
    if (status == BF_OK)
        status = buffer_printf(out, "Content-Length: %zu\r\n\r\n", response->body.n);
    return status;
}

void http__respond_past_body(http_request *r)
{
    bf_buffer bytes = { 0 };

    complete_headers(r);
    r->stage = HTTP_STAGE_SENT;
    // What does not fit into the socket's buffer is lost: nothing was sent before, so it fits.
    if (write_head(&r->response, &bytes) == BF_OK &&
        buffer_append(&bytes, r->response.body.bytes, r->response.body.n) == BF_OK)
        (void)send(r->connection->fd, bytes.bytes, bytes.n, MSG_DONTWAIT | MSG_NOSIGNAL);
    buffer_fini(&bytes);
}
