/// Private to the HTTP transport: answers that wait for a run (http_wait.c).

#pragma once

#include "server/http/http.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct http_request http_request;

/// The waiting of a request whose answer waits for a run. Under http.lock, but for is_waiting.
typedef struct http_wait {
    struct http_request *previous; ///< in http.waits
    struct http_request *next;     ///< in http.waits
    bool is_waiting;               ///< in http.waits; the request's thread alone changes it
    bool is_parked;                ///< no thread has the request
    bool has_left;                 ///< the client hung up
    uint64_t n_notified;           ///< commits of the run so far
    int64_t deadline_ms;           ///< it waits no longer
    int64_t looked_ms;             ///< last look at the run
    int64_t due_ms;                ///< next one, unless a commit comes
} http_wait;

/// By a request thread, with an answer that was just made or waited already: true if it waits (on)
/// and belongs to this thread no more; false if r->response is the last word.
bool http__wait_goes_on(http_request *r);

/// It waits no more. Not waiting is fine.
void http__wait_end(http_request *r);

/// Under http.lock: a run was changed.
void http__wait_notify(http *h, const char *run_id);

/// Under http.lock: have looked at what is due, and at clients that left. Returns when to be called
/// again.
int64_t http__wait_watch(http *h, int64_t now_ms, bool looks_for_the_gone);

/// After is_stopping is set and before http__pool_end(): let all of them be answered.
void http__wait_end_all(http *h);
