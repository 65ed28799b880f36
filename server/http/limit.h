/// Rate limits: a bucket of tokens per client and kind of request, in a table of bounded size.
///
/// A bucket holds the quota of a minute and fills evenly; each request takes one token. Requests that
/// create work take one of both kinds. A token is good for so much CPU time of the thread that answers; what a request
/// takes beyond it is charged afterwards, so that expensive requests count for many. The bucket may then be in debt, of
/// at most the quota of a minute. When the table is full, the client whose last request is oldest is evicted.
/// The figures go to clients in the fields RateLimit-Policy and RateLimit
/// (draft-ietf-httpapi-ratelimit-headers-11).
///
/// Threads  everything may be called from any thread.

#pragma once

#include "api/http/exchange.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    HTTP_LIMIT_WINDOW_S = 60,  ///< in which a quota comes back
    HTTP_LIMIT_CLIENTS = 4096, ///< clients in the table
    HTTP_LIMIT_KEY_SIZE = 16,  ///< bytes that identify a client
};

/// The kinds of quota, X(kind, name for clients, ms of CPU time that a token is good for). By default each of them lets
/// a client have the time of one core.
#define HTTP_LIMIT_LIST(X)                                                                         \
    X(HTTP_LIMIT_REQUESTS, "requests", 10) /* every request */                                     \
    X(HTTP_LIMIT_WORK, "work", 100)        /* requests that create work */

/// The kinds.
typedef enum http_limit_kind {
#define X(kind, name, token_ms) kind,
    HTTP_LIMIT_LIST(X)
#undef X
        HTTP_LIMIT_COUNT
} http_limit_kind;

/// The table; opaque.
typedef struct http_limit http_limit;

/// What became of a request. Zero-initialise: no limit holds for it.
typedef struct http_limit_verdict {
    bool is_refused;                    ///< a bucket is empty
    unsigned retry_after_s;             ///< then: when it has a token again
    uint64_t quotas[HTTP_LIMIT_COUNT];  ///< a minute; 0: the kind has no limit or no say here
    uint64_t left[HTTP_LIMIT_COUNT];    ///< whole tokens
    unsigned reset_s[HTTP_LIMIT_COUNT]; ///< until the bucket is full
} http_limit_verdict;

/// A table for n_clients with quotas a minute (0: no limit).
BF_MUST_CHECK bf_status http_limit_create(const uint64_t quotas[HTTP_LIMIT_COUNT], size_t n_clients,
                                          http_limit **ret_limit, bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
http_limit *http_limit_destroy(http_limit *limit);

/// Change the quotas and fill all buckets. Unchanged quotas change nothing.
void http_limit_change(http_limit *limit, const uint64_t quotas[HTTP_LIMIT_COUNT]);

/// A request of the client at now_ms (a clock that never goes back) takes its tokens; one that is
/// refused takes none.
http_limit_verdict http_limit_take(http_limit *limit, const uint8_t key[HTTP_LIMIT_KEY_SIZE],
                                   bool creates_work, int64_t now_ms);

/// The CPU time of a request that took tokens has grown from before_ns to after_ns: charge what they are not good for.
void http_limit_charge(http_limit *limit, const uint8_t key[HTTP_LIMIT_KEY_SIZE], bool creates_work,
                       int64_t before_ns, int64_t after_ns, int64_t now_ms);

/// Add the fields for clients to a response.
void http_limit_write_headers(const http_limit_verdict *verdict, api_response *response);
