/// The guard in front of every request: pure functions over its bytes.
///
/// MHD lets through what proxies in front of it may read differently (request smuggling): repeated or
/// contradicting lengths, repeated hosts, control bytes, names that are none, lines that are folded
/// or end incomplete. Such requests are refused before any part of them is used.

#pragma once

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/// What the guard saw in the headers of a request. Zero-initialise.
typedef struct http_guard {
    const char *next;     ///< where in the request the next name must stand; NULL: not looked at
    unsigned n_hosts;     ///< Host headers
    unsigned n_lengths;   ///< Content-Length headers
    unsigned n_encodings; ///< Transfer-Encoding headers
    bool is_chunked;      ///< the encoding is exactly `chunked`
    const char *fault;    ///< first bad name or value; NULL: none
} http_guard;

/// Look at one header. With g->next set by the caller behind the request line, also at the place of
/// its bytes: MHD gives texts up to the first zero byte, puts lines together that were folded, and
/// takes a lone CR or LF for the end of a line; in all these cases the next name is elsewhere.
void http_guard_header(http_guard *g, const char *name, size_t n_name, const char *value,
                       size_t n_value);

/// The header ends at end: is all of it accounted for?
void http_guard_end(http_guard *g, const char *end);

/// Judge the request line and the headers: 0, or the HTTP status of the refusal with its text in
/// *err.
int http_guard_verdict(const http_guard *g, const char *method, const char *version, bf_error *err);

/// The authority of a target in absolute form ("http://HOST/path"), which counts instead of Host
/// (RFC 9112, 3.2.2): its first byte, and *ret_n bytes. NULL: the target has none.
const char *http_guard_authority(const char *target, size_t *ret_n);

/// Split and decode a request target into path and query (API_PATH_MAX bytes each). 0, or the HTTP
/// status of the refusal with its text in *err.
int http_guard_target(const char *target, char *ret_path, char *ret_query, bf_error *err);
