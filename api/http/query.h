/// The query part of a request: `name=value&name=value`, percent-decoded, within limits.

#pragma once

#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

enum {
    QUERY_PARAMS_MAX = 16, ///< parameters in one query
    QUERY_SIZE = 2048,     ///< bytes of a query with its terminator
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

/// Parse text, the part after the '?'. A '+' is a space; empty pairs ("a=1&&b=2") are passed over.
/// BF_EINPUT: a broken %XX, a control byte, an empty name or one given twice; BF_ELIMIT: too long or
/// too many. The text names the parameter.
BF_MUST_CHECK bf_status query_parse(const char *text, query *ret_query, bf_error *err);

/// The value of a parameter, or NULL if it was not given.
const char *query_value(const query *q, const char *name);

/// BF_EINPUT if a parameter is not one of the words in known ("status label limit").
BF_MUST_CHECK bf_status query_allow(const query *q, const char *known, bf_error *err);

/// Read the parameter name as a decimal number of least .. most into *ret_value; *ret_value stays as
/// it was if the parameter was not given. BF_EINPUT: not a number, or out of range.
BF_MUST_CHECK bf_status query_number(const query *q, const char *name, uint64_t least,
                                     uint64_t most, uint64_t *ret_value, bf_error *err);

/// Same for a decimal number ("1.25", "0.5e-3") of least .. most.
BF_MUST_CHECK bf_status query_real(const query *q, const char *name, double least, double most,
                                   double *ret_value, bf_error *err);

/// Read text that is nothing but decimal digits, at least one. Returns 0, or -1 if it is anything
/// else or beyond 2^64 - 1 (*ret_value untouched).
int query_read_number(const char *text, uint64_t *ret_value);
