/// Private to the HTTP transport: event streams (http_stream.c).

#pragma once

#include "api/services.h"
#include "core/base/buffer.h"
#include "server/http/http.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct MHD_Connection;
typedef struct http_request http_request;

/// The stream of a request whose response is one.
typedef struct http_stream {
    struct http_stream *previous;                ///< in http.streams
    struct http_stream *next;                    ///< in http.streams
    struct MHD_Connection *mhd;                  ///< to be suspended and resumed
    int fd;                                      ///< of its connection
    size_t n_runs;                               ///< runs that it follows
    char runs[API_STREAM_RUNS_MAX][API_ID_SIZE]; ///< their ids
    uint64_t n_notified;                         ///< wake-ups so far
    bool is_suspended;                           ///< MHD was told to suspend, and not to resume
    bool has_left;                               ///< the client hung up
    bool owes_heartbeat;                         ///< nothing was sent for heartbeat_ms
    int64_t sent_ms;                             ///< when something was last given to MHD
    bool is_over;                                ///< epoll thread: no further event will come
    bf_buffer batch;                             ///< epoll thread: what was read from the store
    size_t n_taken;                              ///< epoll thread: bytes of it given to MHD
} http_stream;

/// Begin the stream of r->response. False: there are too many.
bool http__stream_begin(http_request *r);

/// End it, if there is one.
void http__stream_end(http_request *r);

/// MHD's content reader of a stream; context is the http_request.
ssize_t http__stream_read(void *context, uint64_t position, char *bytes, size_t n);

/// Under http.lock: wake what owes a heartbeat or has left.
void http__stream_watch(http *h, int64_t now_ms);

/// Mark all streams as ending and resume them.
void http__stream_end_all(http *h);
