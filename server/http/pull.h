/// What is pulled chunk by chunk on the request threads, and suspended in between: bodies that are made
/// while they are sent, and long polls. pull.c explains how no wake-up is lost.

#pragma once

#include "api/body.h"
#include "core/base/buffer.h"
#include "server/http/http.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/queue.h>
#include <sys/types.h>

/// http_priv.h
typedef struct http_request http_request;

/// What is pulled (pull.c). Each kind has its own limit.
typedef enum http_pull_kind {
    HTTP_PULL_STREAM,    ///< an event stream
    HTTP_PULL_ARRAY,     ///< a body of a known length: it takes little memory
    HTTP_PULL_DOWNLOAD,  ///< another body that is made while it is sent
    HTTP_PULL_LONG_POLL, ///< the end of a wait, before the answer
    HTTP_PULL_KINDS      ///< how many kinds
} http_pull_kind;

/// A pull of a request. A request has one at a time.
typedef struct http_pull {
    http_pull_kind kind;            ///< constant
    body_source source;             ///< constant; the response's, or that of a long poll
    int64_t interval_ms;            ///< constant: least time between looks without a chunk
    int64_t deadline_ms;            ///< constant: it ends then; INT64_MAX: never
    bool is_under_way;              ///< owner: it is in http.pulls
    uint64_t n_seen;                ///< owner: n_notified at the last look
    body_state state;               ///< owner: what follows the chunk
    bool has_failed;                ///< owner: the next chunk cannot be made
    bf_buffer chunk;                ///< owner: the one under way; empty while the pull waits
    size_t n_taken;                 ///< owner: bytes of it given to MHD
    int64_t sent_ms;                ///< owner: when something was last given to MHD
    LIST_ENTRY(http_request) entry; ///< http.lock: in http.pulls
    uint64_t n_notified;            ///< http.lock: wake-ups so far
    bool is_parked;                 ///< http.lock: it has no owner, and waits
    bool is_half_closed;            ///< http.lock: the client has shut down its sending side
    bool is_disconnected;           ///< http.lock: the client is taken for gone
    /// Under http.lock: nothing was sent for heartbeat_ms, or the client is in doubt
    bool is_heartbeat_due;
    int64_t polled_ms; ///< http.lock: when it was parked
    int64_t due_ms;    ///< http.lock: when it is looked at again, without a wake-up
} http_pull;

/// Bytes that a pull of the body takes in a chunk.
size_t http__pull_chunk(const body_source *source);

/// Begin to pull the body of the response. False: there are too many of its kind.
bool http__pull_begin_body(http_request *r);

/// Begin the long poll that the response asks for. False: there are too many.
bool http__pull_begin_long_poll(http_request *r);

/// On a request thread: make the next chunk. False: there is none yet, and this thread must not
/// access the request any more.
bool http__pull_work(http_request *r);

/// End the pull, if there is one.
void http__pull_end(http_request *r);

/// MHD's content reader of a body that is pulled; context is the http_request.
ssize_t http__pull_read(void *context, uint64_t position, char *bytes, size_t n);

/// Under http.lock: queue each pull that is due, needs a heartbeat, or whose client disconnected. Returns the time
/// of the next call.
int64_t http__pull_watch(http *h, int64_t now_ms, bool looks_for_disconnected);

/// Set is_stopping, and queue all that are parked to be ended. Before http__pool_end().
void http__pull_stop_all(http *h);
