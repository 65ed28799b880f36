/// The routes of the API: one table from which requests are dispatched, Allow headers are made and
/// documents are written.

#pragma once

#include "api/http/exchange.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    ROUTES_PARAMS_MAX = 2,  ///< parameters in a path template
    ROUTES_PARAM_SIZE = 65, ///< bytes of a parameter's value with its terminator
    ROUTES_ALLOW_SIZE = 64, ///< bytes of an Allow header's value with its terminator
};

/// One exchange that is being handled; exchange_priv.h.
typedef struct exchange exchange;

/// Handle an exchange: fill its response. On failure the response becomes a problem document.
typedef bf_status route_handler(exchange *x, bf_error *err);

/// One route. HEAD goes where GET goes; OPTIONS is answered for every path.
typedef struct route {
    const char *method;    ///< "GET", ...
    const char *path;      ///< template: "/v1/runs/{id}"
    route_handler *handle; ///< what answers
    api_cost cost;         ///< what an answer takes,
    api_cost text_cost;    ///< or of one as JSON or CSV, if that is more
    const char *query;     ///< query parameters that it knows, words; "" none
    const char *formats;   ///< formats that it answers in, words of media.h, the default first
    const char *summary;   ///< what it does, one line, for documents
} route;

/// Values of the parameters of a path, in the order of the template.
typedef struct route_params {
    size_t n;                                          ///< parameters
    char values[ROUTES_PARAMS_MAX][ROUTES_PARAM_SIZE]; ///< their text
} route_params;

/// The table. Static; *ret_n is how many.
const route *routes_list(size_t *ret_n);

/// The route of a request, or NULL (*ret_params untouched). ret_params NULL: not wanted. A parameter
/// is one segment, not empty, shorter than ROUTES_PARAM_SIZE.
const route *routes_find(const char *method, const char *path, route_params *ret_params);

/// True if a route has this path; then *ret_allow (ROUTES_ALLOW_SIZE bytes) lists its methods as an
/// Allow header does, HEAD and OPTIONS included.
bool routes_allow(const char *path, char *ret_allow);
