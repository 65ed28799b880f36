/// The page: files below one directory, sent as they are or as the page's build encoded them.

#pragma once

#include "api/http/negotiation.h"
#include "server/http/http.h"

#include <stdbool.h>
#include <stdint.h>

/// http_priv.h
typedef struct http_request http_request;

/// A file of the page that is to be sent.
typedef struct http_file {
    int fd;           ///< open for reading; -1: none
    uint64_t n;       ///< its bytes
    const char *type; ///< Content-Type
    char etag[64];    ///< entity tag of the plain file, without quotes
} http_file;

/// True if the path may be a file of the page, so that a request thread looks for it.
bool http__page_may_have(const http *h, const char *path);

/// Open the file of the page for a path, if there is one, in its plain form or in an encoded one that
/// lies beside it (`app.js.gz`) and is not older.
bool http__page_open(int web_fd, const char *path, coding form, http_file *ret_file);

/// Make the response that of r->path in the page, if it has one: a file, a 304, a 405, or without a
/// page a word about it for "/".
void http__page_answer(http_request *r);
