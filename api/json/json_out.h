/// A writer of JSON text: it writes commas, escapes and numbers; the caller is responsible for the structure.
///
/// After a failed allocation further calls do nothing, and json_out_status() returns the error.
/// Numbers that are not finite are written as null. The output is valid JSON for any input bytes:
/// invalid UTF-8 becomes U+FFFD.

#pragma once

#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Text that is being written. Begin with json_out_to().
typedef struct json_out {
    bf_buffer *buffer; ///< where the text goes; the caller's
    bool needs_comma;  ///< a value stands before the next one in this object or array
    bool has_failed;   ///< out of memory
    /// Struct of the whole document, for members that name another part of it by
    /// its id; NULL: there are none
    const void *whole;
} json_out;

/// A writer that appends to *buffer.
json_out json_out_to(bf_buffer *buffer);

/// BF_OK, or BF_ENOMEM if any call before failed.
BF_MUST_CHECK bf_status json_out_status(const json_out *w, bf_error *err);

/// Structure: { } [ ] and the key of the next value. Keys are escaped like strings.
void json_out_object(json_out *w);
void json_out_object_end(json_out *w);
void json_out_array(json_out *w);
void json_out_array_end(json_out *w);
void json_out_key(json_out *w, const char *key);

/// Values. json_out_string() escapes text; NULL is null. json_out_raw() copies JSON text.
void json_out_string(json_out *w, const char *text);
void json_out_number(json_out *w, double value);
void json_out_measure(json_out *w, double value); ///< what was computed: number_round()
void json_out_integer(json_out *w, int64_t value);
void json_out_bool(json_out *w, bool value);
void json_out_null(json_out *w);
void json_out_raw(json_out *w, const char *json, size_t n);

/// A point in time (Unix ms): "2026-01-31T12:00:00.000Z"; 0 is null.
void json_out_time(json_out *w, int64_t unix_ms);

/// An array of n numbers, each stride doubles after the one before.
void json_out_numbers(json_out *w, const double *values, size_t n, size_t stride);

/// A key and its value in one call.
void json_out_key_string(json_out *w, const char *key, const char *text);
void json_out_key_number(json_out *w, const char *key, double value);
void json_out_key_measure(json_out *w, const char *key, double value);
void json_out_key_integer(json_out *w, const char *key, int64_t value);
void json_out_key_bool(json_out *w, const char *key, bool value);
