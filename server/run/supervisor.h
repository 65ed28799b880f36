/// The supervisor: takes queued runs from the store, has an executor solve each, and stores what comes
/// back until the run has ended.
///
/// Stopping a run has one owner: to cancel or remove a run, other threads write a stop request into the
/// store (store_cancel(), store_remove()). The supervisor reads the outstanding requests when a commit has
/// changed one of its runs, and enforces them: a graceful stop first, by force when its time is over.
///
/// Threads  one thread of its own owns tasks and executor. It waits for nothing but events: batches
///          are stored asynchronously, one of each run at a time. The functions below may be called from any
///          thread.

#pragma once

#include "server/run/executor.h"
#include "server/store/work.h"

#include <stdbool.h>

enum { SUPERVISOR_WORKERS_MAX = 64 }; ///< n_workers at most

/// How to solve runs.
typedef struct supervisor_options {
    store *store;          ///< where runs come from and results go
    executor *executor;    ///< where they are solved; the supervisor's thread's while that runs
    unsigned n_workers;    ///< runs by themselves at once, and where they are fewer trials beside
                           ///< them, 1 to SUPERVISOR_WORKERS_MAX
    unsigned n_threads;    ///< threads of each run, >= 1
    uint64_t memory_bytes; ///< address space of a job; 0: unlimited
    uint64_t cpu_s;        ///< CPU seconds of a job; 0: unlimited
    uint64_t
        output_bytes; ///< of samples, snapshots, parts and changes that a job may send; 0: unlimited
    uint64_t stall_s;      ///< seconds without a further step until a run fails; 0: unlimited
    uint64_t wall_s;       ///< seconds of solving, all attempts together; 0: unlimited
    int64_t checkpoint_ms; ///< between checkpoints of a run
    int64_t stop_grace_ms; ///< from a graceful stop, or the last frame, to a stop by force; 0: 5 s
    int64_t lost_ms;       ///< from that until a job that does not end counts as lost; 0: 30 s
} supervisor_options;

/// A running supervisor; opaque.
typedef struct supervisor supervisor;

/// A store_still_runs whose context is the executor.
bool supervisor_still_runs(void *executor, const store_running *running);

/// Start the thread. Runs that are running in the store are taken over from the executor by their external
/// id, or else queued again; then the queued ones are started.
BF_MUST_CHECK bf_status supervisor_start(const supervisor_options *options,
                                         supervisor **ret_supervisor, bf_error *err);

/// From now on start runs with these options; store and executor stay as they were. Runs that are being
/// solved go on as they began, also where there are more of them than n_workers now.
void supervisor_reconfigure(supervisor *s, const supervisor_options *options);

/// Ask the thread for a sign of life; true if it has answered all earlier questions.
bool supervisor_is_alive(supervisor *s);

/// BF_OK if runs can be started; else why not, as the executor says or the last attempt has shown.
BF_MUST_CHECK bf_status supervisor_ready(supervisor *s, bf_error *err);

/// Something was queued or its priority matters: look at the queue.
void supervisor_wake(supervisor *s);

/// A commit has changed a run: look for stop requests, if there are new ones. Does not wait for the store, so a
/// store_listener may call it.
void supervisor_notify(supervisor *s);

/// Stop all: jobs write a checkpoint and end within grace_ms (then by force); their runs are queued
/// again. Stops the thread and frees. NULL is fine. Always returns NULL.
supervisor *supervisor_stop(supervisor *s, int64_t grace_ms);
