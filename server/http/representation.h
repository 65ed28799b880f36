/// Representations of a body (RFC 9110, 8.4 and 14): content codings and byte ranges.
///
/// Text and arrays are encoded when the client takes it (Accept-Encoding) and they have HTTP_ENCODING_MIN bytes;
/// densities then have half the size. Arrays that a range is asked of are not, nor those that are sent
/// piece by piece, and pictures, which are compressed already. Event streams are not either: an encoder buffers its input until a block is full, so events would be delayed,
/// and each open stream would need memory for the encoder's window.
///
/// A request for one range is answered by that range, one for several by the whole body, as the standard
/// allows.

#pragma once

#include "api/http/negotiation.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stdint.h>

enum { HTTP_ENCODING_MIN = 1024 }; ///< bytes from which on encoding pays

/// True if bodies of this Content-Type are encoded: text, and arrays.
bool http_encoding_is_text(const char *content_type);
bool http_encoding_is_array(const char *content_type);

/// Append the encoded form of n bytes to *out. BF_ENOMEM: *out is as before.
BF_MUST_CHECK bf_status http_encoding_pack(coding c, const void *bytes, size_t n, bf_buffer *out);

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
