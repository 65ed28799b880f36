/// What identifies a request across programs: X-Request-Id, and traceparent of W3C Trace Context.

#pragma once

#include "core/base/status.h"

enum {
    HTTP_TRACE_ID_SIZE = 65,     ///< bytes of a request id with its terminator
    HTTP_TRACE_PARENT_SIZE = 56, ///< bytes of a traceparent with its terminator
};

/// The identity of a request.
typedef struct http_trace {
    char id[HTTP_TRACE_ID_SIZE];         ///< the client's, or one of our own
    char parent[HTTP_TRACE_PARENT_SIZE]; ///< trace of the client, span of our own; "": no trace
} http_trace;

/// Identify a request by its headers (NULL: not there). A request id is taken as it is when it has 1
/// to 64 letters, digits or `-_.:~+/=@`, else a new one is made; a traceparent that cannot be read
/// counts as none. Never fails: without random bytes ids are numbers that rise.
http_trace http_trace_read(const char *request_id, const char *traceparent);
