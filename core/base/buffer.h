/// A growable byte buffer.

#pragma once

#include "core/base/status.h"

#include <stddef.h>

/// Bytes owned by the buffer. Zero-initialise; free with buffer_fini().
typedef struct bf_buffer {
    char *bytes;     ///< n bytes and, after any append, a terminating zero that n does not count
    size_t n;        ///< bytes in use
    size_t capacity; ///< bytes allocated
} bf_buffer;

/// Append n bytes. BF_ENOMEM: the buffer is as before.
BF_MUST_CHECK bf_status buffer_append(bf_buffer *b, const void *bytes, size_t n);

/// Append printf-formatted text. BF_ENOMEM: the buffer is as before.
BF_MUST_CHECK bf_status buffer_printf(bf_buffer *b, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// Reserve memory for n more bytes and return where they start; add to b->n what was written.
/// NULL: no memory.
char *buffer_reserve(bf_buffer *b, size_t n);

/// Remove the first n bytes.
void buffer_drop(bf_buffer *b, size_t n);

/// Truncate to the first n bytes, n <= b->n: undoes appends.
void buffer_truncate(bf_buffer *b, size_t n);

/// Free the bytes and zero the buffer. NULL is fine.
void buffer_fini(bf_buffer *b);
