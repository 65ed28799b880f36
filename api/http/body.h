/// The body of a response that is made piece by piece while it is sent, so that only a piece of it is
/// in memory however long it is.
///
/// A handler that wants one finds out everything that can be refused before, gives the response a
/// body, and returns. The transport then asks for a piece whenever the client has taken the one
/// before; it asks on any of its request threads, one at a time. Between two pieces nothing of the
/// store is held, so that a slow client costs the memory of one piece and of state, and nothing else.
/// A client that leaves is told by nothing but destroy.

#pragma once

#include "api/services.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>

/// Append the next piece to *out, about limit_bytes or fewer; none at all is no end, but lets others
/// have their turn. *ret_is_over: it was the last one. After a failure the response is torn off, so
/// that the client does not take the part for the whole, and nothing more is asked for.
typedef bf_status api_body_make(void *state, const api_services *services, size_t limit_bytes,
                                bf_buffer *out, bool *ret_is_over, bf_error *err);

/// A body. Zero-initialised: none.
typedef struct api_body {
    void *state;                  ///< of its maker, owned
    api_body_make *make;          ///< makes the next piece; NULL: there is no such body
    void (*destroy)(void *state); ///< frees state, at the end or before it
} api_body;
