/// The HTTP transport: libmicrohttpd in front of api_handle(). Only files of this folder include
/// <microhttpd.h>.
///
/// Threads  libmicrohttpd runs a small pool of epoll threads, which serve connections and never wait.
///          Requests that may wait for the disk (api_request_cost) suspend their connection and are
///          handled by request threads; all others are answered on the epoll thread. Whatever is
///          pulled (a body_source, or the wait for a run: `Prefer: wait`, `?wait=`) is worked on by
///          request threads too, and is suspended and without a thread while there is nothing to do;
///          http_notify() wakes what waits for the run.
/// Order of stopping  http_stop(): take nobody in, mark all that is pulled as ending, resume it, stop.

#pragma once

#include "api/services.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>

/// The clocks of what clients may use.
typedef struct http_clocks {
    int64_t (*monotonic_ms)(void);  ///< as clock_monotonic_ms()
    int64_t (*thread_cpu_ns)(void); ///< as clock_thread_cpu_ns()
} http_clocks;

/// How to serve.
typedef struct http_options {
    const char *listen;           ///< "127.0.0.1:8080", "[::1]:0"; port 0 picks a free one
    const char *plaintext;        ///< what may be listened on, see listen.h; NULL: "loopback"
    bool has_tokens;              ///< requests need an access token
    const api_services *services; ///< services of the API
    const char *web_directory;    ///< files of the page; NULL: none
    unsigned n_threads;           ///< epoll threads, >= 1
    unsigned n_request_threads;   ///< requests that may block, at once, >= 1
    unsigned connection_limit;    ///< connections at once
    unsigned per_address_limit;   ///< of them of one client that is not local; 0: no limit
    const char *cors_origins;     ///< pages that may read answers, see http_cors.h; NULL: none
    const char *hosts; ///< names that requests may be sent to, see listen.h; NULL: none more
    const char *trusted_proxies;  ///< addresses whose X-Forwarded-For is trusted; NULL: none
    uint64_t requests_per_minute; ///< of one client that is not local; 0: no limit
    uint64_t work_per_minute;     ///< of them such that create work; 0: no limit
    http_clocks clocks;           ///< of these limits; NULL members: the machine's
    /// What http_reconfigure() changes while threads read it:
    _Atomic unsigned stream_limit;      ///< event streams at once
    _Atomic unsigned download_limit;    ///< bodies that are made while they are sent, at once
    _Atomic unsigned wait_limit;        ///< requests whose answers wait for a run at once
    _Atomic uint64_t body_limit;        ///< bytes of a request's body
    _Atomic uint64_t answer_limit;      ///< bytes of memory that all answers together may take
    _Atomic int64_t header_deadline_ms; ///< for a complete request header
    _Atomic int64_t body_deadline_ms;   ///< for a complete body, after the header
    _Atomic bool logs_all;              ///< each request is logged, with its client
    _Atomic int64_t heartbeat_ms;       ///< between comments on idle streams
} http_options;

/// A running server; opaque.
typedef struct http http;

/// Listen and serve. BF_ESYSTEM: the address cannot be used; the text says why in plain words
/// ("port 8080 of 127.0.0.1 is taken by another program"). BF_EINPUT: plaintext does not allow it.
BF_MUST_CHECK bf_status http_start(const http_options *options, http **ret_http, bf_error *err);

/// BF_EINPUT: text is not an address to listen on, such as "127.0.0.1:8080".
BF_MUST_CHECK bf_status http_check_address(const char *text, bf_error *err);

/// From now on serve with the options that can change (http_options), and open the page's directory
/// again, which may be another one of that name now. BF_ESYSTEM: the directory cannot be used; all
/// else is done, and the page stays as it was.
BF_MUST_CHECK bf_status http_reconfigure(http *h, const http_options *options, bf_error *err);

/// Probe the epoll threads, the request threads and the watching thread; true if all have answered the
/// previous probe. Epoll threads are probed by requests (GET /livez) on internal connections; while all
/// connections are in use they are not probed.
bool http_is_alive(http *h);

/// The port that is listened on.
unsigned http_port(const http *h);

/// A run has changed: wake the streams that follow it and the answers that wait for it. Any thread; never
/// waits for the disk or a client.
void http_notify(http *h, const char *run_id);

/// Stop and free. NULL is fine. Always returns NULL.
http *http_stop(http *h);
