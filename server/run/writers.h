/// Writes of tasks into the store, none of which the supervisor's thread waits for: threads that do. A task has one at a
/// time, so they come into the store in order; those of different tasks go side by side and share commits.

#pragma once

#include "core/base/status.h"
#include "server/base/lock.h"
#include "server/run/supervisor.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum { SUPERVISOR_WRITERS = 2 }; ///< threads that wait for the store

typedef struct supervisor__task supervisor__task;

/// What a task has the store do. Batches are taken by store_begin_append(); for the others one of the
/// supervisor's writing threads waits.
typedef enum supervisor__write_kind {
    SUPERVISOR_WRITE_CLAIM, ///< store_claim() into claimed
    SUPERVISOR_WRITE_ID,    ///< the job's external id
    SUPERVISOR_WRITE_BATCH, ///< batch
    SUPERVISOR_WRITE_END,   ///< ending, and the claim of the task `follower`
} supervisor__write_kind;

/// A write on its way into the store. From its begin until is_done the supervisor's thread leaves the members
/// of the task alone that it is about.
typedef struct supervisor__write {
    supervisor__write_kind kind; ///< what is written
    bool is_pending;             ///< begun, and its result not taken yet
    int64_t begin_ms;            ///< when, clock_monotonic_ms()
    atomic_bool is_done;         ///< status and error are set
    bf_status status;            ///< of the store
    bf_error error;              ///< of the store
    supervisor__task *follower;  ///< whose claim is part of this write; NULL: none
    supervisor__task *next;      ///< in the queue of the writing threads
} supervisor__write;

/// The writing threads, so that neither a commit nor the making of a summary holds up the supervisor.
typedef struct supervisor__writers {
    lock lock;                             ///< guards what follows
    lock_condition queued;                 ///< first, or is_stopping
    supervisor__task *first;               ///< queue of tasks
    supervisor__task *last;                ///< its end
    bool is_stopping;                      ///< the threads end when the queue is empty
    unsigned n_threads;                    ///< that were started
    pthread_t threads[SUPERVISOR_WRITERS]; ///< n_threads
} supervisor__writers;

/// Start the writing threads. BF_ESYSTEM: none could be started.
BF_MUST_CHECK bf_status supervisor__start_writers(supervisor *s, bf_error *err);

/// Wait until the writing threads have finished all queued writes, and join them.
void supervisor__stop_writers(supervisor *s);

/// Begin a write of a task that has none pending.
void supervisor__begin_write(supervisor__task *task, supervisor__write_kind kind);

/// The same for how a task's run ends, and in the same commit the claim of `follower`, a task without a run. NULL: none.
void supervisor__begin_end(supervisor__task *task, supervisor__task *follower);
