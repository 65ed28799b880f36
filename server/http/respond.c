#include "server/http/http_priv.h"

#include <microhttpd.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { READER_BLOCK = 4096 }; // MHD's room for what a reader gives, where it does not use chunks

void http__respond_refuse(http_request *r, int status, const bf_error *err)
{
    if (r->file.fd >= 0)
        (void)close(r->file.fd);
    r->file.fd = -1;
    api_problem(&r->response, status, r->path, err);
}

// Bodies that are read piece by piece: event streams, and what is made while it is sent.
static bool has_reader(const http_request *r)
{
    return r->response.source.next_chunk != NULL;
}

static bool is_read(const http_request *r)
{
    return has_reader(r) && strcmp(r->method, "HEAD") != 0;
}

static struct MHD_Response *make_reader(http_request *r)
{
    return MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, READER_BLOCK,
        r->response.source.is_stream ? http__stream_read : http__download_read, r, NULL);
}

// An answer without a body whose length, if it had one, is not known: HEAD of such a body, and a 304,
// whose length would be that of the 200 (RFC 9110, 8.6). MHD ends such an answer with an empty chunk,
// unless it may not use chunks; then the connection closes.
static struct MHD_Response *make_without_length(http_request *r)
{
    struct MHD_Response *response = make_reader(r);

    if (response != NULL)
        (void)MHD_set_response_options(response, MHD_RF_HTTP_1_0_COMPATIBLE_STRICT, MHD_RO_END);
    return response;
}

static struct MHD_Response *make_response(http_request *r)
{
    bf_buffer *body = &r->response.body;

    if (has_reader(r))
        return is_read(r) ? make_reader(r) : make_without_length(r);
    if (r->response.status == 304 && r->file.fd < 0 && body->n == 0)
        return make_without_length(r);
    if (r->file.fd >= 0)
        return MHD_create_response_from_fd_at_offset64(r->is_cut ? r->n_sent : r->file.n,
                                                       r->file.fd, r->is_cut ? r->first : 0);
    if (r->is_cut)
        return MHD_create_response_from_buffer((size_t)r->n_sent, body->bytes + r->first,
                                               MHD_RESPMEM_PERSISTENT);
    return MHD_create_response_from_buffer(body->n, body->bytes, MHD_RESPMEM_PERSISTENT);
}

static void refuse_full(http_request *r, const char *what, unsigned limit)
{
    bf_error err = { 0 };

    (void)bf_fail(&err, BF_EBUSY, "", "there are %u %s, which is the limit", limit, what);
    http__respond_refuse(r, 503, &err);
    r->is_finished = false;
}

// Streams and downloads are limited in number.
static void admit(http_request *r)
{
    if (!is_read(r))
        return;
    if (r->response.source.is_stream && !http__stream_begin(r))
        refuse_full(r, "event streams", r->server->options.stream_limit);
    else if (!r->response.source.is_stream && r->response.source.next_chunk != NULL &&
             !http__download_begin(r))
        refuse_full(r, "downloads", r->server->options.download_limit);
}

bool http__respond(http_request *r)
{
    admit(r);
    http__finish(r);
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

    http__finish(r);
    r->stage = HTTP_STAGE_SENT;
    // What does not fit into the socket's buffer is lost: nothing was sent before, so it fits.
    if (write_head(&r->response, &bytes) == BF_OK &&
        buffer_append(&bytes, r->response.body.bytes, r->response.body.n) == BF_OK)
        (void)send(r->connection->fd, bytes.bytes, bytes.n, MSG_DONTWAIT | MSG_NOSIGNAL);
    buffer_fini(&bytes);
}
