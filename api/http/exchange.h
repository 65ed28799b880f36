/// One HTTP exchange as the API sees it: a request in, a response out, no sockets.
///
/// api_handle() is the whole API: it finds the route (routes.h), reads the request, calls the services
/// and writes the response; errors become application/problem+json (RFC 9457, problem.h).
///
/// Threads  api_handle() may be called from any thread at the same time; it blocks while a service
///          reads or writes the disk, which api_request_cost() predicts.

#pragma once

#include "api/body.h"
#include "api/services.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    API_HEADERS_MAX = 24,   ///< headers of a response
    API_HEADER_SIZE = 1600, ///< bytes of a header's value with its terminator
    API_PATH_MAX = 2048,    ///< bytes of a path or a query with its terminator
    API_WAIT_MAX_S = 60,    ///< longest time that an answer waits for a run
    API_COMPARE_MAX = 8,    ///< runs and measurements that are compared at once
};

/// What an answer waits for before it is sent: a long poll.
typedef struct api_long_poll {
    unsigned seconds;      ///< at most so long; 0: it does not wait
    char run[API_ID_SIZE]; ///< for the end of this run,
    bool is_for_change;    ///< or for another revision of it:
    uint64_t revision;     ///< than this one
} api_long_poll;

/// How much handling a request takes.
typedef enum api_cost {
    API_COST_NONE,   ///< nothing that an event loop could not do
    API_COST_HEALTH, ///< at most one short write of the store; it must not wait behind other requests
    API_COST_STORE, ///< waits for the disk
    API_COST_WORK,  ///< and computes for long, or makes the daemon do so: limited by the work quota
    API_COST_CHECK, ///< and before that checks a scenario, up to a second: limited by the work quota, too
} api_cost;

/// A request. Everything is borrowed.
typedef struct api_request {
    const char *method; ///< "GET", ...
    const char *path;   ///< percent-decoded, without the query
    const char *query;  ///< after the '?', still encoded; "" if none
    /// Value of a header by its case-insensitive name, or NULL. It lives as long as the request.
    const char *(*header)(void *header_context, const char *name);
    /// Take n bytes of the memory for answers, until the answer is sent. False: too much is taken. NULL: no limit.
    bool (*reserve)(void *header_context, uint64_t n);
    void *header_context; ///< given to both
    const _Atomic bool
        *is_cancelled;   ///< set when nobody waits for the answer any more; NULL: never
    const char *body;    ///< n_body bytes; may be NULL when 0
    size_t n_body;       ///< bytes
    uint64_t body_limit; ///< bytes that a body may have; 0: not known
    const char *client;  ///< address that limits hold for, shorter than API_CLIENT_SIZE; NULL: none
    const api_long_poll *polled; ///< what the first answer waited for; NULL: this is the first
    uint64_t token;              ///< number of the token that the first answer was for; 0: none
} api_request;

/// A response header.
typedef struct api_header {
    const char *name;            ///< static text
    char value[API_HEADER_SIZE]; ///< text
} api_header;

/// A response. Zero-initialise; api_response_fini().
typedef struct api_response {
    int status;        ///< HTTP status code
    const char *route; ///< template of the route that it is of; NULL: none; static
    api_identity who;  ///< who asked for it
    size_t n_headers;  ///< headers in use
    api_header headers[API_HEADERS_MAX]; ///< Content-Type among them where there is a body
    bf_buffer body;     ///< the body, unless there is a source; of a 304 perhaps what a 200 had
    body_source source; ///< the body is made while it is sent; next_chunk NULL: it is not
    api_long_poll long_poll; ///< seconds > 0: worth waiting before it is sent
} api_response;

/// How much handling a request takes: API_COST_NONE where no route has its path and method. Reads the
/// method, the path, the query's format and the Accept header; not the body.
api_cost api_request_cost(const api_request *request);

/// True if this request would not wait for the disk now, although requests like it do: its run is in memory.
bool api_request_is_cached(const api_services *services, const api_request *request);

/// What becomes of a request's body.
typedef enum api_body {
    API_BODY_NEEDED,  ///< it is to be there when the request is handled
    API_BODY_UNUSED,  ///< nothing looks at it: the route has none, or there is no such route
    API_BODY_REFUSED, ///< its sender may not use the route
} api_body;

/// Decide by the header alone what becomes of a body that is not there yet. API_BODY_REFUSED: *response is the 401 or
/// 403; else it is zero, and the request is handled when its body is complete. Does not wait for the disk beyond a
/// short read.
api_body api_admit_body(const api_services *services, const api_request *request,
                        api_response *response);

/// Handle a request. Always fills *response; HEAD is handled as GET with body or stream left in (the
/// transport leaves them out). BF_ENOMEM becomes a 503.
void api_handle(const api_services *services, const api_request *request, api_response *response);

/// True if the wait is over: the run has ended, changed, or cannot be found.
bool api_long_poll_is_over(const api_services *services, const api_long_poll *poll);

/// Answer a request again when the long poll of its first answer, *response, is over; the new answer
/// does not wait. An answer 201 is kept if the run cannot be read any more.
void api_handle_again(const api_services *services, const api_request *request,
                      api_response *response);

/// True if a route has this path.
bool api_route_exists(const char *path);

/// Make *response a problem document, replacing what was there: status, and the error's text as
/// detail. For the transport's own refusals. A status that problem.h does
/// not list is a bug.
void api_problem(api_response *response, int status, const char *instance, const bf_error *error);

/// Add a header; one beyond API_HEADERS_MAX or too long a value is a bug.
void api_response_header(api_response *response, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Give a problem document the member `request_id`. Anything else, or without memory, stays as it is.
void api_problem_identify(api_response *response, const char *request_id);

/// The value of a header by its case-insensitive name, or NULL.
const char *api_response_find(const api_response *response, const char *name);

/// Replace a header's value, or add it. The rules of api_response_header().
void api_response_set(api_response *response, const char *name, const char *value);

/// Remove a header, if it is there.
void api_response_drop(api_response *response, const char *name);

/// Add a field name to Vary, unless it is there.
void api_response_vary(api_response *response, const char *name);

/// Free the body, made or not, and zero *response. NULL is fine.
void api_response_fini(api_response *response);
