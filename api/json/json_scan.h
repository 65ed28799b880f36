/// A first look at JSON text before it is parsed: how deep it nests, and where a byte of it stands.
///
/// The parser proper recurses and builds a tree; this look needs neither stack nor memory, so it
/// may come before any limit. It does not judge whether the text is JSON.

#pragma once

#include <stddef.h>

enum { JSON_NESTING_MAX = 32 }; ///< levels of nested arrays and objects of a document

/// Why a scan ended.
typedef enum json_scan_end {
    JSON_SCAN_ALL,      ///< it saw all of the text
    JSON_SCAN_TOO_DEEP, ///< a level beyond JSON_NESTING_MAX begins here
    JSON_SCAN_NO_NUMBER ///< NaN or Infinity, which are no JSON numbers
} json_scan_end;

/// Where a scan ended.
typedef struct json_scan_place {
    size_t at;     ///< bytes before the place
    size_t line;   ///< from 1
    size_t column; ///< in bytes, from 1
} json_scan_place;

/// Look through n bytes. The JSON pointer of the value (or of the key just read) at the end is
/// written to ret_pointer, cut to size bytes with its terminator; escapes in keys are left as they
/// stand.
json_scan_end json_scan(const char *json, size_t n, json_scan_place *ret_place, char *ret_pointer,
                        size_t size);
