/// An event stream towards one client: server-sent events or NDJSON, of one or several runs.
///
/// A stream is a cursor over the stored events: it keeps no queue, so a slow client costs the bytes
/// of one batch and nothing else. It ends after the `end` event of every run it follows. An event is
/// streamed only after it was stored, so what a client saw survives the daemon.
///
///     SSE      retry: 3000, then for each event  id: N / event: WORD / data: {...}
///     NDJSON   {"id":N,"run":"...","event":"WORD","data":{...}}
///
/// Inline snapshots carry the float32 grid, rows of x1, little-endian, in base64 as the last member
/// `data` of their data; it is null where the grid is larger than STREAM_INLINE_MAX.

#pragma once

#include "api/body.h"
#include "api/services.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stdint.h>

/// Largest grid that an inline snapshot carries, bytes.
#define STREAM_INLINE_MAX (4 * 1024 * 1024)

/// The two forms of a stream.
typedef enum stream_format { STREAM_SSE, STREAM_NDJSON } stream_format;

/// A client's cursor.
typedef struct stream_cursor {
    stream_format format;                        ///< form of the bytes
    bool is_inline;                              ///< snapshots carry their data, base64
    size_t n_runs;                               ///< runs it follows
    size_t n_open;                               ///< of them, how many have not sent `end` yet
    char runs[API_STREAM_RUNS_MAX][API_ID_SIZE]; ///< their ids
    uint64_t after;                              ///< id of the last event written
    bool has_begun;                              ///< the preamble (`retry:`) was written
} stream_cursor;

/// Begin a stream of 1 .. API_STREAM_RUNS_MAX runs behind the event `after` (0: from the first one
/// on). n_open is 0 where the client has seen the end of all of them. An id that is newer than all
/// events of the runs, as after a loss of the store, counts as the newest. BF_ENOTFOUND: no such run.
BF_MUST_CHECK bf_status stream_begin(const api_services *services, stream_format format,
                                     bool is_inline, const char (*runs)[API_ID_SIZE], size_t n_runs,
                                     uint64_t after, stream_cursor *ret_cursor, bf_error *err);

/// Append the next batch, at most about limit_bytes (and one inline snapshot), to *out: the
/// body_next_chunk_fn of a stream. Runs that were removed count as ended. On failure *cursor and *out
/// are as before.
BF_MUST_CHECK bf_status stream_next(void *cursor, const api_services *services, size_t limit_bytes,
                                    bf_buffer *out, body_state *ret_state, bf_error *err);

/// Make the stream of a cursor, which is copied, the body of a response. *ret_source is the caller's;
/// its destroy() frees it. BF_ENOMEM.
BF_MUST_CHECK bf_status stream_open(const stream_cursor *cursor, body_source *ret_source,
                                    bf_error *err);

/// The bytes that keep an idle stream open: an SSE comment, an empty line of NDJSON.
const char *stream_heartbeat(stream_format format);
