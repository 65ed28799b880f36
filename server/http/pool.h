/// Private to server/http: the threads that handle requests; pool.c has their lanes.

#pragma once

#include "server/http/http_priv.h"

/// Start the threads that handle n requests at a time.
BF_MUST_CHECK bf_status http__pool_start(unsigned n, http_pool **ret_pool, bf_error *err);

/// Suspend the request's connection and queue it to be handled. False: the queue is full or the pool
/// has ended; nothing was done.
bool http__pool_suspend(http_pool *p, http_request *r);

/// Queue a suspended request to continue its pull. Under http.lock, and before http__pool_end().
void http__pool_enqueue(http_pool *p, http_request *r);

/// Handle all queued requests, but refuse those with a scenario to check, and end the threads. NULL is fine.
void http__pool_end(http_pool *p);

/// Free a pool that has ended. NULL is fine. Always returns NULL.
http_pool *http__pool_free(http_pool *p);

/// Probe a group of threads; true if one of them has answered the previous probe.
bool http__pool_is_alive(http_pool *p);
