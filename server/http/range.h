/// Byte ranges (RFC 9110, 14): one range of a representation. Several at once are answered by the
/// whole, as the standard allows.

#pragma once

#include <stdbool.h>
#include <stdint.h>

/// What a Range header asks for.
typedef enum http_range {
    HTTP_RANGE_WHOLE,  ///< the whole: no range, several, another unit, or not to be read
    HTTP_RANGE_PART,   ///< one range
    HTTP_RANGE_BEYOND, ///< one that begins behind the end: 416
} http_range;

/// Read a Range header (NULL: none) for a representation of n bytes. For HTTP_RANGE_PART the first
/// byte, and how many.
http_range http_range_read(const char *header, uint64_t n, uint64_t *ret_first, uint64_t *ret_n);

/// True if a Range header counts: there is no If-Range (NULL), or it names exactly this strong entity
/// tag (with quotes). A date never does, since nothing here has one.
bool http_range_is_current(const char *if_range, const char *etag);
