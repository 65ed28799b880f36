/// The query part of a request: `name=value&name=value`, percent-decoded, within limits.

#pragma once

#include "api/http/param.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    QUERY_PARAMS_MAX = 16,  ///< parameters in one query
    QUERY_SIZE = 2048,      ///< bytes of a query with its terminator
    QUERY_KNOWN_SIZE = 120, ///< bytes of the names that a route knows, with spaces and a terminator
};

/// One parameter.
typedef struct query_param {
    uint16_t name;  ///< where its name starts in text
    uint16_t value; ///< where its value starts in text; "" where there was no '='
} query_param;

/// A parsed query. Zero-initialise: no parameters. Owns nothing.
typedef struct query {
    size_t n;                             ///< parameters
    query_param params[QUERY_PARAMS_MAX]; ///< in the order of the request
    char text[QUERY_SIZE];                ///< decoded names and values, each with a terminator
} query;

/// Parse text, the part after the '?'. A '+' is a space; empty pairs ("a=1&&b=2") are ignored.
/// BF_EINPUT: a broken %XX, a control byte, an empty name or one given twice; BF_ELIMIT: too long or
/// too many. The text names the parameter.
BF_MUST_CHECK bf_status query_parse(const char *text, query *ret_query, bf_error *err);

/// The byte that the two hexadecimal digits behind a '%' say; -1: they are none.
int query_read_escape(const char *text);

/// Percent-encode a text but for its letters, digits, "-._~" and the bytes of `kept`, up to where fewer than four bytes of
/// ret_text are left, as an escape and the terminator need. Returns how many bytes there are before the terminator.
size_t query_write_escaped(const char *text, const char *kept, char *ret_text, size_t size);

/// The value of a parameter, or NULL if it was not given.
const char *query_value(const query *q, const char *name);

/// The same, and the query does not have it any more. The text stays as long as *q.
const char *query_take(query *q, const char *name);

/// Check a query against the parameters that a route has (ended by NULL): it has no other
/// one, each value is one of its kind, and what is required is there. Errors as of param_kind.
BF_MUST_CHECK bf_status query_check(const query *q, const param *const *params, bf_error *err);

/// Read the parameter name of a query that was checked: its value, else its default. False: there is
/// neither (*ret_value untouched).
bool query_read(const query *q, const param *const *params, const char *name,
                param_value *ret_value);
