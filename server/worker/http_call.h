/// One HTTP exchange at a time with one service, by libcurl, without blocking.
///
/// Redirects are not followed, so that the token goes nowhere else. https is checked against the CA certificates.
/// Threads: one.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/// The service. The texts are copied.
typedef struct http_call_options {
    const char *url;     ///< http:// or https://, without the path of a route
    const char *token;   ///< access token; "": none
    const char *ca_file; ///< CA certificates, PEM; NULL: those of the system
} http_call_options;

/// A request. method and path are borrowed for the call of http_call_begin(), the body until the exchange has ended.
typedef struct http_call_request {
    const char *method; ///< GET, POST, PUT, DELETE
    const char *path;   ///< from the slash on
    const char *type;   ///< media type of the body; NULL: there is no body
    const void *body;   ///< n_body bytes
    size_t n_body;      ///< bytes
    size_t n_most;      ///< bytes of the answer's body that are accepted
} http_call_request;

/// What came of a request.
typedef struct http_call_answer {
    bool has_ended;        ///< else the exchange goes on, and nothing else is set
    long status;           ///< of HTTP; 0: there was no complete answer
    const bf_buffer *body; ///< of the answer, until the next request
    const char *error;     ///< why there was none
} http_call_answer;

typedef struct http_call http_call;

/// BF_EINPUT: url is none that can be used; BF_ENOMEM.
BF_MUST_CHECK bf_status http_call_create(const http_call_options *options, http_call **ret_call,
                                         bf_error *err);

/// Free it and what goes on. NULL is fine. Always returns NULL.
http_call *http_call_destroy(http_call *c);

/// Begin an exchange; none is going on. BF_ENOMEM.
BF_MUST_CHECK bf_status http_call_begin(http_call *c, const http_call_request *request,
                                        bf_error *err);

/// Wait until the exchange makes progress, one of the descriptors is readable, or the time has passed, and go on with
/// the exchange, if there is one.
http_call_answer http_call_wait(http_call *c, const int *fds, size_t n_fds, int timeout_ms);
