/// Private part of the HTTP transport: bodies that are made while they are sent.

#pragma once

#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum { HTTP_DOWNLOAD_PIECE = 256 * 1024 }; ///< bytes of a body that are made at once

struct http_request;

/// The body of a response that is made in pieces.
typedef struct http_download {
    bf_buffer piece; ///< the one under way
    size_t n_taken;  ///< bytes of it given to MHD
    bool is_over;    ///< it is the last one
    bool has_failed; ///< the next one could not be made
} http_download;

/// Begin the body of r->response that is made in pieces. False: there are too many.
bool http__download_begin(struct http_request *r);

/// End it, if there is one.
void http__download_end(struct http_request *r);

/// On a request thread: make its next piece.
void http__download_make(struct http_request *r);

/// MHD's content reader of such a body; context is the http_request.
ssize_t http__download_read(void *context, uint64_t position, char *bytes, size_t n);
