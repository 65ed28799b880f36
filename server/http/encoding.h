/// Content codings of response bodies: which are worth it, and the encoding.
///
/// Text is encoded when the client takes it (Accept-Encoding) and it has HTTP_ENCODING_MIN bytes.
/// Pictures and arrays are not: they are compressed already, or hardly can be. Event streams are
/// not either: an encoder holds back what it has not yet filled a block with, so events would come
/// late, and each stream would cost its window of memory for as long as it is open.

#pragma once

#include "api/http/coding.h"
#include "core/base/buffer.h"

#include <stdbool.h>

enum { HTTP_ENCODING_MIN = 1024 }; ///< bytes from which on encoding pays

/// True if bodies of this Content-Type are encoded.
bool http_encoding_is_text(const char *content_type);

/// Append the encoded form of n bytes to *out. BF_ENOMEM: *out is as before.
BF_MUST_CHECK bf_status http_encoding_pack(coding c, const void *bytes, size_t n, bf_buffer *out);
