/// The supervisor: takes queued runs from the store and lets each be solved by a child process.
///
/// A child is the `beltflow` program started as `beltflow worker`: job (and checkpoint) frames go to
/// its standard input, frames come back on its standard output, diagnostics on stderr go to the log.
/// It limits itself (address space, CPU time) before it reads anything, and dies with the daemon.
///
/// Threads  one thread of its own (epoll over pipes, pidfds, a timer and an eventfd) owns children
///          and queue. The functions below may be called from any thread.

#pragma once

#include "server/store/work.h"

#include <stdbool.h>

enum { SUPERVISOR_WORKERS_MAX = 64 }; ///< runs at once at most

/// How to run children.
typedef struct supervisor_options {
    store *store;          ///< where runs come from and results go
    const char *program;   ///< path of the beltflow program
    unsigned n_workers;    ///< runs at once, 1 to SUPERVISOR_WORKERS_MAX
    unsigned n_threads;    ///< threads of each run, >= 1
    uint64_t memory_bytes; ///< address space of a child; 0: unlimited
    uint64_t cpu_s;        ///< CPU seconds of a child; 0: unlimited
    int64_t checkpoint_ms; ///< between checkpoints of a run
} supervisor_options;

/// A running supervisor; opaque.
typedef struct supervisor supervisor;

/// Start the thread and with it the runs that are queued.
BF_MUST_CHECK bf_status supervisor_start(const supervisor_options *options,
                                         supervisor **ret_supervisor, bf_error *err);

/// From now on start runs with these options; store and program stay as they were. Runs that are being
/// solved go on as they began, also where there are more of them than n_workers now.
void supervisor_reconfigure(supervisor *s, const supervisor_options *options);

/// Ask the thread for a sign of life, and true if it has given all that it was asked for before.
bool supervisor_is_alive(supervisor *s);

/// Something was queued or its priority matters: look at the queue.
void supervisor_wake(supervisor *s);

/// Ask a running run to stop and keep what it has. BF_ECONFLICT: it is not running here.
BF_MUST_CHECK bf_status supervisor_cancel(supervisor *s, const char *run_id, bf_error *err);

/// Kill a running run and wait until it is not running any more (then cancelled). BF_OK also if it
/// was not running.
BF_MUST_CHECK bf_status supervisor_kill(supervisor *s, const char *run_id, bf_error *err);

/// Hand back: children write a checkpoint and stop within grace_ms (then they are killed); their runs
/// are queued again. Stops the thread and frees. NULL is fine. Always returns NULL.
supervisor *supervisor_stop(supervisor *s, int64_t grace_ms);
