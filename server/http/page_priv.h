/// Private to the HTTP transport: the page's files (http_file.c) and their encoded forms (http_cache.c).

#pragma once

#include "api/http/coding.h"
#include "core/base/buffer.h"
#include "server/http/http.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct http_request http_request;

/// A file of the page that is to be sent.
typedef struct http_file {
    int fd;           ///< open for reading; -1: none
    uint64_t n;       ///< its bytes
    const char *type; ///< Content-Type
    char etag[64];    ///< entity tag of the plain file, without quotes
} http_file;

/// True if the path may be a file of the page, so that a request thread looks for it.
bool http__file_may_be(const http *h, const char *path);

/// Open the file of the page for a path, if there is one, in its plain form or in an encoded one that
/// lies beside it (`app.js.gz`) and is not older.
bool http__file_open(int web_fd, const char *path, coding form, http_file *ret_file);

/// Make the response that of r->path in the page, if it has one: a file, a 304, a 405, or without a
/// page a word about it for "/".
void http__file_answer(http_request *r);

/// Encoded files of the page; opaque.
typedef struct http_cache http_cache;

/// An empty cache. NULL: no memory.
http_cache *http__cache_create(void);

/// Free it. NULL is fine. Always returns NULL.
http_cache *http__cache_destroy(http_cache *cache);

/// Append the encoded form of what has this entity tag and path to *out. False: it is not there, or no
/// memory; *out is as before.
bool http__cache_find(http_cache *cache, const char *path, const char *etag, coding c,
                      bf_buffer *out);

/// Keep an encoded form; others that were not asked for lately may go. Without memory it is not kept.
void http__cache_put(http_cache *cache, const char *path, const char *etag, coding c,
                     const bf_buffer *bytes);
