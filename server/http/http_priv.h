/// Private parts of the HTTP transport. README.md describes its files.
///
/// Life of a request (one http_request, made when its request line is parsed, freed when MHD says
/// that it is completed):
///
///     HEADER --guard--> BODY --> COMPLETE --> WORKING --handled--> READY --> SENT
///                         |                      |                   ^        |
///                         |                      '--> LONG_POLL -----|        '--> its body is pulled
///                         '---------- does not block ----------------'
///
/// In WORKING and LONG_POLL the connection is suspended. Everything that more than one thread touches
/// is under http.lock; the order of locks is http.lock, http_pool's lock, MHD's own. No callback of
/// MHD holds MHD's lock when it calls us.

#pragma once

#include "api/http/exchange.h"
#include "api/http/negotiation.h"
#include "server/base/liveness.h"
#include "server/base/lock.h"
#include "server/base/metrics.h"
#include "server/http/client.h"
#include "server/http/http.h"
#include "server/http/limit.h"
#include "server/http/listen.h"
#include "server/http/mhd/content_lengths.h"
#include "server/http/mhd/recv.h"
#include "server/http/page.h"
#include "server/http/pull.h"
#include "server/http/trace.h"

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/queue.h>

struct MHD_Connection;
struct MHD_Daemon;

enum {
    HTTP_METHOD_SIZE = 32, ///< bytes of a method with its terminator
    HTTP_IDLE_S = 15,      ///< an inactive connection is closed after it
    HTTP_LINGER_MAX = 64,  ///< sockets that are drained after a refusal
    HTTP_PROBES_MAX = 64,  ///< epoll threads that are probed
};

/// A connection's socket, from accept to close.
typedef struct http_connection {
    TAILQ_ENTRY(http_connection) entry; ///< in http.connections
    http *server;                       ///< whose
    int fd;                             ///< MHD's socket; valid while in the list
    bool has_key;                       ///< it counts among those of a client:
    uint8_t key[HTTP_CLIENT_KEY_SIZE];  ///< of this one
    http_recv received;                 ///< what it receives
    http_request *request;   ///< its header is complete, and it has not ended; by that thread
    unsigned n_begun;        ///< headers that MHD read; by that thread
    int64_t deadline_ms;     ///< shut down then (clock_monotonic_ms()); -1: never
    int64_t idle_since_ms;   ///< it came, or its last request ended, clock_monotonic_ms()
    bool has_request;        ///< a header is complete, and its answer is not
    bool lingers;            ///< was refused while its client may still be sending
    bool seems_disconnected; ///< its client had hung up at the last look
} http_connection;

/// Where a request is in its life.
typedef enum http_stage {
    HTTP_STAGE_HEADER,    ///< the header is not checked yet
    HTTP_STAGE_BODY,      ///< the body is being received
    HTTP_STAGE_COMPLETE,  ///< the request is complete, and needs a request thread
    HTTP_STAGE_WORKING,   ///< suspended, a request thread has it
    HTTP_STAGE_LONG_POLL, ///< suspended, its answer waits for a run
    HTTP_STAGE_READY,     ///< the response is complete
    HTTP_STAGE_SENT,      ///< the response was given to MHD; its body may still be pulled
} http_stage;

/// One request.
struct http_request {
    http *server;                     ///< whose
    http_connection *connection;      ///< its socket
    struct MHD_Connection *mhd;       ///< its connection
    STAILQ_ENTRY(http_request) entry; ///< in the pool's queue
    http_stage stage;                 ///< handed from thread to thread with the request
    const char *target;               ///< in MHD's buffer, where the target stands
    const char *target_end;           ///< and where its terminating zero stands
    int refusal;                      ///< HTTP status of a fault found so far; 0: none
    bf_error fault;                   ///< what it is
    char method[HTTP_METHOD_SIZE];    ///< as sent
    char path[API_PATH_MAX];          ///< decoded
    char query[API_PATH_MAX];         ///< as sent
    api_cost cost;                    ///< what handling it takes
    bool needs_body;                  ///< the route has one
    uint64_t n_body;                  ///< bytes of it that were received
    bf_buffer body;                   ///< as received, if it is of use
    api_response response;            ///< what to answer
    http_file file;                   ///< or a file instead of its body
    bool is_finished;                 ///< the transport has added what it adds
    bool is_cut;                      ///< only a range of body or file is sent:
    uint64_t first;                   ///< from this byte on
    uint64_t n_sent;                  ///< so many
    http_trace trace;                 ///< what identifies it
    http_client client;               ///< who sent it
    bool is_of_network;               ///< by IPv4 or IPv6
    http_limit_verdict verdict;       ///< what the limits say of it
    int64_t cpu_ns;                   ///< CPU time of request threads for it
    bool is_counted;                  ///< in http.n_requests
    bool has_waited;                  ///< its answer was a long poll's
    http_pull pull;                   ///< of its long poll, then of its response's body
    uint64_t n_answer_bytes;          ///< counted in http.n_answer_bytes; under http.lock
    int64_t begun_ns;                 ///< when its header was complete, clock_monotonic_ns()
};

/// The request threads; opaque.
typedef struct http_pool http_pool;

/// The server.
struct http {
    http_options options;         ///< as given; its texts are NULL after the start
    api_services services;        ///< as given
    int listen_fd;                ///< listening socket; -1: none
    _Atomic int web_fd;           ///< directory of the page; -1: none
    unsigned port;                ///< listened on
    _Atomic bool is_ending;       ///< checks that are under way are cancelled
    struct MHD_Daemon *daemon;    ///< NULL until it runs
    http_pool *pool;              ///< request threads
    char *cors_origins;           ///< as given; "": none
    char *host_names;             ///< as given; "": none
    char *listened;               ///< host part of the address that is listened on
    http_hosts hosts;             ///< which Host is answered
    _Atomic int64_t warned_ms;    ///< when a proxy was last warned of, clock_monotonic_ms()
    http_proxies proxies;         ///< whose X-Forwarded-For is trusted
    http_limit *limit;            ///< rates of clients
    http_content_lengths lengths; ///< of what clients may have
    lock lock;                    ///< guards all that follows
    lock_condition changed;       ///< a connection came, a request went, or is_stopping
    /// Open ones; one that becomes idle moves to the head, one that gets a request stays where it is
    TAILQ_HEAD(http_connections, http_connection) connections;
    unsigned n_connections;                ///< how many
    LIST_HEAD(, http_request) pulls;       ///< requests with a pull under way
    unsigned n_pulls[HTTP_PULL_KINDS];     ///< how many of each kind
    unsigned n_requests;                   ///< requests past their header
    uint64_t n_answer_bytes;               ///< of memory that answers take, or will
    bool is_stopping;                      ///< pulls end, nothing suspends any more
    bool has_watch;                        ///< watch runs
    bool watch_ends;                       ///< it shall not
    int64_t polled_ms;                     ///< when it last looked for disconnected clients
    pthread_t watch;                       ///< deadlines, heartbeats, disconnected clients
    liveness watch_liveness;               ///< of that thread
    int probes[HTTP_PROBES_MAX];           ///< main's: connections to epoll threads; 0: none
    unsigned n_lingering;                  ///< sockets in linger
    int linger_fds[HTTP_LINGER_MAX];       ///< sockets to be drained
    int64_t linger_until[HTTP_LINGER_MAX]; ///< closed then
};

// connection.c

/// A new connection (NULL: no memory, or too many descriptors), in the list, with the deadline for its first header;
/// shut down if it is one too many of its client's.
http_connection *http__connection_open(http *h, int fd, const struct sockaddr *peer);

/// Take a connection out of the list and free it; its socket is still open. NULL is fine.
void http__connection_close(http_connection *c);
/// The connection has a request with a complete header from now on, or is idle again.
void http__connection_occupy(http_connection *c, bool has_request);

/// Shut the connection down in ms from now, unless called again; -1: never.
void http__connection_deadline(http_connection *c, int64_t ms);

/// True if only requests about the daemon's health are still answered.
bool http__connection_is_reserved(const http_connection *c);

/// True if the client sends no more, or the connection is broken.
bool http__connection_has_hung_up(int fd);
/// True if the connection is broken: nothing can be sent either.
bool http__connection_is_broken(int fd);

/// Start and stop the thread that watches deadlines and pulls.
BF_MUST_CHECK bf_status http__watch_start(http *h, bf_error *err);
void http__watch_stop(http *h);

// probe.c

/// Wait for the answers to the last probes, and close them: MHD, when stopped, closes what no thread has taken yet without a lock.
void http__probe_end(http *h);

// request.c: what MHD's callbacks for requests call

/// A new request, from the target of its request line, which is followed by the version in the same
/// buffer. NULL: no memory.
http_request *http__request_open(http *h, struct MHD_Connection *mhd, const char *target);

/// Continue a request; *n bytes of its body were received, and all are consumed. False: close the connection.
bool http__request_advance(http_request *r, const char *method, const char *version,
                           const char *bytes, size_t *n);

/// MHD refuses a Content-Length that is no number before it asks us, with two heads; but it logs that before.
/// To be called then, on its thread: answers the request, and ends what is sent on its connection.
void http__request_refuse_length(void);

/// The framing of what the http_connection receives is at fault. True if that is the request
/// whose body is being received: then it is answered, and the connection must not be read any more. Else
/// the refusal waits for its header.
bool http__request_refuse_framing(void *connection);

/// Charge the client of a request for the CPU time of this thread since begun_ns (clock_thread_cpu_ns()).
void http__request_charge(http_request *r, int64_t begun_ns);

/// On a request thread: handle the request. False: it is parked, and this thread must not access it any more.
bool http__request_work(http_request *r);

/// The request is over, answered or not: log and free it. NULL is fine.
void http__request_close(http_request *r);

/// A request header's value by its name, or NULL; context is the http_request.
const char *http__request_header(void *context, const char *name);

// request_check.c

/// Set the refusal of a request.
void http__request_refuse(http_request *r, int status, bf_status code, const char *text);

/// Find out what identifies the request, and who sent it.
void http__request_identify(http_request *r);
/// Check the complete header; sets r->refusal if the request must not be used.
void http__request_check(http_request *r, const char *method, const char *version);

// response.c

/// Make the request's response a problem.
void http__respond_refuse(http_request *r, int status, bf_status code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Add the transport's part of an answer: encoding, range, headers of limits, origins, traces; but once.
void http__finalize_response(http_request *r);

/// Mark the body as encoded; the entity tag becomes that of the encoded form.
void http__set_coding(api_response *response, coding c);

/// Give the response to MHD. False: it cannot be sent, close the connection.
bool http__respond(http_request *r);

/// Send the response past MHD, which takes none while a body is coming in. The connection must then be closed.
void http__respond_past_body(http_request *r);
