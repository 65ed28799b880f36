/// The lengths of answers that were sent, by path, query and entity tag. A 304 may only name the length that its 200
/// has (RFC 9110, 8.6), and MHD closes the connection behind an answer whose length it does not know; the
/// length of what the client has is remembered from when it was sent.
///
/// Threads  everything may be called from any thread.

#pragma once

#include "server/base/lock.h"

#include <stdbool.h>
#include <stdint.h>

enum { HTTP_CONTENT_LENGTHS_MAX = 4096 }; ///< lengths that are kept

/// One length.
typedef struct http_content_length {
    uint64_t digest; ///< of path, query and tag; 0: none
    uint64_t n;      ///< bytes of the content
} http_content_length;

/// The table: each digest has one place, and the latest has it. http_content_lengths_init().
typedef struct http_content_lengths {
    lock lock;                                            ///< guards what follows
    http_content_length places[HTTP_CONTENT_LENGTHS_MAX]; ///< by digest
} http_content_lengths;

/// Set up an empty table.
void http_content_lengths_init(http_content_lengths *lengths);
/// Release what http_content_lengths_init() took.
void http_content_lengths_fini(http_content_lengths *lengths);

/// Remember the length of an answer.
void http_content_lengths_remember(http_content_lengths *lengths, const char *path,
                                   const char *query, const char *tag, uint64_t n);

/// The length of an answer, if it is known.
bool http_content_lengths_find(http_content_lengths *lengths, const char *path, const char *query,
                               const char *tag, uint64_t *ret_n);
