/// A response body that is pulled: it is made chunk by chunk while it is sent, so that only a chunk of
/// it is in memory however long it is. Large arrays, archives and event streams are such bodies.
///
/// A handler that answers with one first makes all checks that can fail, then gives the
/// response a body_source and returns. The transport asks for the next chunk when the client has taken
/// the one before, always on a request thread, one at a time. Between two chunks no resource of the
/// store is held, so a slow client costs only the memory of one chunk and of state. When a client
/// disconnects, only destroy is called.

#pragma once

#include "api/services.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// What follows a chunk.
typedef enum body_state {
    BODY_MORE, ///< there is more now: ask again when the client has taken this chunk
    BODY_WAIT, ///< this was all there is now: ask again when one of the source's runs has changed
    BODY_DONE, ///< this was the last chunk
} body_state;

/// Append the next chunk to *out, about limit_bytes or fewer. An empty one with BODY_MORE yields to
/// other bodies. A change of a run that was committed before the call is in the chunk, or the
/// state is BODY_MORE. On failure *out is as before or longer, the response is cut off, so that the
/// client detects the truncation, and next_chunk is not called again.
typedef bf_status body_next_chunk_fn(void *state, const api_services *services, size_t limit_bytes,
                                     bf_buffer *out, body_state *ret_state, bf_error *err);

/// A body. Zero-initialised: none.
typedef struct body_source {
    void *state;                    ///< of the body, owned
    body_next_chunk_fn *next_chunk; ///< makes the next chunk; NULL: there is no such body
    void (*destroy)(void *state);   ///< frees state, at the end or before it
    /// Continue with byte `at`; before the first chunk. NULL: the body's length is not known before its end.
    void (*seek)(void *state, uint64_t at);
    uint64_t n;            ///< of a body with seek: bytes in all
    size_t n_held;         ///< bytes of memory that its state takes between two chunks, if many
    bool is_stream;        ///< it lasts as long as its runs: an event stream
    const char *heartbeat; ///< of a stream: bytes that keep an idle connection open; static
    size_t n_runs;         ///< runs whose changes BODY_WAIT waits for
    const char (*runs)[API_ID_SIZE]; ///< their ids, n_runs of them; in state
} body_source;
