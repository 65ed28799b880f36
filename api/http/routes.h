/// The routes of the API: one table, routes_table.c, from which requests are dispatched and read, Allow
/// headers are made and documents are written.

#pragma once

#include "api/access.h"
#include "api/http/exchange.h"
#include "api/http/param.h"
#include "api/json/members.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    ROUTES_ANSWERS_MAX = 3,  ///< answers of a route that are not refusals
    ROUTES_PARAMS_MAX = 2,   ///< parameters in a path template
    ROUTES_PARAM_SIZE = 65,  ///< bytes of a parameter's value with its terminator
    ROUTES_FORMAT_SIZE = 12, ///< bytes of the word of a format with its terminator
    ROUTES_ALLOW_SIZE = 64,  ///< bytes of an Allow header's value with its terminator
};

/// One exchange that is being handled; http_priv.h.
typedef struct exchange exchange;

/// Handle an exchange: fill its response. On failure the response becomes a problem document.
typedef bf_status route_handler_fn(exchange *x, bf_error *err);

/// An answer that is not a problem document.
typedef struct route_answer {
    int status;          ///< HTTP status; 0: no answer
    const char *schema;  ///< schema of the body as JSON; NULL: no body, or no JSON
    const char *headers; ///< names of headers, words of api/openapi/headers.c
    const char *help;    ///< when it is given
    const char *formats; ///< words of MEDIA_LIST, where only some of the route's have it; else NULL
} route_answer;

/// One route. HEAD goes where GET goes; OPTIONS is answered for every path.
typedef struct route {
    const char *method;         ///< "GET", ...
    const char *path;           ///< template: "/v1/runs/{id}"
    route_handler_fn *handle;   ///< what answers
    api_cost cost;              ///< what an answer takes,
    api_cost text_cost;         ///< or of one as JSON or CSV, if that is more
    api_scope scope;            ///< what a token must allow; API_SCOPE_NONE: it is for everyone
    const char *formats;        ///< in which it answers, words of MEDIA_LIST, the default first;
                                ///< several have paths of their own, the route's with ".csv" behind
    const param *const *params; ///< of path, query and header, ended by NULL
    const char *id;             ///< operationId, for programs that are made from the document
    const char *tag;            ///< under which the document lists it
    const char *summary;        ///< what it does, one line
    const char *help;           ///< what a client should know beyond that
    const member_table *body;   ///< the request's body as JSON; NULL: it has none
    const char *body_formats;   ///< of the body, the same; NULL: JSON; if several, one of answers
    const char *refusals;       ///< HTTP statuses that nothing else here tells, words; NULL: none
    route_answer answers[ROUTES_ANSWERS_MAX]; ///< the others
} route;

/// HTTP statuses of the refusals that any request can meet, and the headers of every answer: words.
#define ROUTES_COMMON_REFUSALS "400 405 406 414 421 429 500 501 503"
#define ROUTES_COMMON_HEADERS  "Vary X-Request-Id RateLimit-Policy RateLimit"

/// What a path says: the values of its parameters, in the order of the template, and the format.
typedef struct route_params {
    size_t n;                                          ///< parameters
    char values[ROUTES_PARAMS_MAX][ROUTES_PARAM_SIZE]; ///< their text
    char format[ROUTES_FORMAT_SIZE];                   ///< word of MEDIA_LIST; "": it does not say
} route_params;

/// The table. Static; *ret_n is how many.
const route *routes_list(size_t *ret_n);

/// The route of a request, or NULL (*ret_params untouched). ret_params may be NULL. A parameter
/// is one segment, not empty, shorter than ROUTES_PARAM_SIZE and without a dot, which begins the ending of a format.
const route *routes_find(const char *method, const char *path, route_params *ret_params);

/// The formats, words of MEDIA_LIST, that an ending of the route's path says: of the body where it has several, else of answers.
const char *routes_endings(const route *r);

/// The formats of answers among which a path that was found leaves the choice, words of MEDIA_LIST.
const char *routes_formats(const route *found, const route_params *params);

/// True if a route has this path; then *ret_allow (ROUTES_ALLOW_SIZE bytes) lists its methods as an
/// Allow header does, HEAD and OPTIONS included.
bool routes_allow(const char *path, char *ret_allow);
