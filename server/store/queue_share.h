/// How much of the queue one client may fill: who submitted which of the runs that wait.
///
/// It is kept in memory only; a daemon that was restarted has forgotten who queued what, and counts
/// anew. Entries of runs that no longer wait are dropped when room is needed.
///
/// Threads  everything may be called from any thread.

#pragma once

#include "api/services.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/// The book; opaque.
typedef struct queue_share queue_share;

/// True if the run still waits. Must not call the book.
typedef bool queue_share_ask(void *context, const char *run_id);

/// A book that lets each client have so many waiting runs, of a queue of queue_limit.
BF_MUST_CHECK bf_status queue_share_create(size_t per_client, size_t queue_limit,
                                           queue_share **ret_share, bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
queue_share *queue_share_destroy(queue_share *share);

/// Take a place for a run that the client is about to submit; queue_share_settle() must follow.
/// BF_ELIMIT: all of its share waits; BF_ENOMEM.
BF_MUST_CHECK bf_status queue_share_take(queue_share *share, const char *client,
                                         queue_share_ask *ask, void *context, bf_error *err);

/// The run was accepted with this id, or not (NULL).
void queue_share_settle(queue_share *share, const char *client, const char *run_id);
