/// Studies at work: what /v1/studies has accepted is carried out. Trials are put into the queue a few at a time; what
/// their runs found is told to core/study, which says what to try next, and is written down. A study goes on from what the
/// store has of it, so that one that is interrupted makes the same trials.
///
/// Threads  one thread of its own, which calls the store and nothing that waits for a run. The functions below may be
///          called from any thread.

#pragma once

#include "core/base/status.h"
#include "server/store/studies.h"

#include <stdbool.h>

/// Where studies are, and who solves their trials.
typedef struct studies_options {
    store *store;                  ///< open
    unsigned n_workers;            ///< trials that are solved at once
    int64_t age_ms;                ///< since a study ended, until it is removed; 0: it stays
    void (*queued)(void *context); ///< trials wait: to be taken from the queue
    void *context;                 ///< given to it
} studies_options;

/// The studies at work; opaque.
typedef struct studies studies;

/// Start the thread. BF_ESYSTEM, BF_ENOMEM.
BF_MUST_CHECK bf_status studies_start(const studies_options *options, studies **ret_studies,
                                      bf_error *err);

/// From now on so many trials are solved at once, and studies are removed at this age.
void studies_reconfigure(studies *s, unsigned n_workers, int64_t age_ms);

/// Something is asked of a study, or there is a new one. Does not wait.
void studies_wake(studies *s);

/// A commit has changed this run, or another one. Does not call the store, so a store_listener may call it.
void studies_notify(studies *s, const char *run_id);

/// Ask the thread for a sign of life; true if it has answered all earlier questions.
bool studies_is_alive(studies *s);

/// Stop the thread and free; trials that run go on. NULL is fine. Always returns NULL.
studies *studies_stop(studies *s);
