/// A task is a run under supervision. Shared by supervisor.c (thread and commands),
/// supervisor_queue.c (claiming), supervisor_task.c (how a task starts and ends) and
/// supervisor_frames.c (what its child tells); all but `asked` belongs to the supervisor's thread.

#pragma once

#include "core/run/frame.h"
#include "server/base/liveness.h"
#include "server/base/lock.h"
#include "server/base/metrics.h"
#include "server/run/child.h"
#include "server/run/supervisor.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

enum { SUPERVISOR_PAUSE_FIRST_MS = 1000 }; ///< of claiming after trouble; doubles each time

/// What somebody wants of a running run; the greater wins.
typedef enum supervisor__wish {
    SUPERVISOR_GO_ON,     ///< nothing
    SUPERVISOR_HAND_BACK, ///< write a checkpoint, end, and be queued again
    SUPERVISOR_CANCEL,    ///< end and keep what there is
    SUPERVISOR_KILL,      ///< end at once
} supervisor__wish;

/// What the loop waits for.
typedef enum supervisor__source {
    SUPERVISOR_WAKE, ///< the eventfd
    SUPERVISOR_IN,   ///< the child's stdin takes bytes
    SUPERVISOR_OUT,  ///< frames
    SUPERVISOR_ERR,  ///< words
    SUPERVISOR_END,  ///< the child has ended
    SUPERVISOR_SOURCE_COUNT
} supervisor__source;

typedef struct supervisor__task supervisor__task;

/// What an epoll event points at.
typedef struct supervisor__watch {
    supervisor__source source; ///< what
    supervisor__task *task;    ///< whose; NULL: of the supervisor itself
} supervisor__watch;

/// One run that is being solved.
struct supervisor__task {
    store_job job;           ///< as it was claimed
    child child;             ///< the process that solves it
    size_t n_columns;        ///< of job.columns
    unsigned ready;          ///< 1 << supervisor__source of what came in this turn
    supervisor__wish asked;  ///< guarded by the supervisor's lock
    supervisor__wish served; ///< what the child was told of it
    int64_t kill_at_ms;      ///< when SIGKILL follows; -1: not planned
    double start_s;          ///< when the child was started, clock_monotonic_s()
    bool has_begun;          ///< FRAME_BEGIN came
    bool has_ended;          ///< FRAME_END came
    bool is_doomed;          ///< it fails with error, whatever else comes
    bool is_late;            ///< it was killed because it did not end in time
    frame_begin begin;       ///< valid if has_begun
    frame_end end;           ///< valid if has_ended
    bf_error error;          ///< why it fails: told by the child, or found here
    bool has_progress;       ///< progress is not stored yet
    frame_progress progress; ///< the newest
    double told_s;           ///< when progress was last told, clock_monotonic_s(); 0: never
    double rate;             ///< steps/s, smoothed; 0: not known yet
    double rate_s;           ///< when rate was last brought up to date
    uint64_t rate_step;      ///< the step then
    store_item *items;       ///< what is not stored yet
    size_t n_items;          ///< of them
    size_t items_capacity;   ///< room
    bool has_snapshot;       ///< a snapshot came whose parts have not come yet:
    store_item snapshot;     ///< that one
    unsigned n_logged;       ///< lines of stderr that went to the log
    supervisor__watch watches[SUPERVISOR_SOURCE_COUNT]; ///< what epoll events point at
};

/// A run that has ended here and that the store could not be told of.
typedef struct supervisor__debt {
    char run_id[API_ID_SIZE]; ///< still `running` in the store
    run_state state;          ///< what it shall be
} supervisor__debt;

/// The supervisor.
///
/// Threads  the thread owns tasks and epoll. Under the lock: the list of tasks (which the thread alone
///          changes), their `asked`, and the flags below. Others only set flags, read the list, and
///          ring the eventfd.
struct supervisor {
    supervisor_options options;   ///< the thread's: what counts at the moment
    pthread_t thread;             ///< runs the loop
    int epoll;                    ///< what the loop waits on
    int bell;                     ///< eventfd that others ring
    supervisor__watch bell_watch; ///< of it
    lock lock;                    ///< see above
    lock_condition changed;       ///< the list of tasks, or is_claiming
    size_t n_tasks;               ///< tasks
    supervisor__task **tasks;     ///< room for SUPERVISOR_WORKERS_MAX
    bool is_claiming;             ///< a run may be running in the store and not yet be in the list
    bool may_claim;               ///< something may be queued
    bool is_stopping;             ///< supervisor_stop() was called
    int64_t grace_ms;             ///< with this
    int64_t claim_at_ms;          ///< the thread's: no claiming before; 0: at once
    int64_t pause_ms;             ///< the thread's: how long the next pause is
    size_t n_debts;               ///< the thread's: debts; nothing is claimed while there are any
    supervisor__debt *debts;      ///< the thread's: room for SUPERVISOR_WORKERS_MAX
    bool has_wanted;              ///< the thread shall take over:
    supervisor_options wanted;    ///< these options
    pulse pulse;                  ///< of the thread
};

/// Start the child of a claimed job, which is taken over: *job is then empty. On failure *job is as
/// before: BF_EBUSY and BF_ENOMEM pass, others do not.
BF_MUST_CHECK bf_status supervisor__task_start(const supervisor_options *options, store_job *job,
                                               supervisor__task **ret_task, bf_error *err);

/// Read about limit_bytes of what the child says and store it in one batch. False: that was all for
/// now. A failure dooms the run and kills the child.
bool supervisor__listen(supervisor__task *task, store *s, size_t limit_bytes);

/// Note the child's words in the log.
void supervisor__log_words(supervisor__task *task);

/// How a run whose child ended with this wait status ends, given what was asked.
store_ending supervisor__judge(supervisor__task *task, int status, supervisor__wish asked,
                               const supervisor_options *options);

/// Why the process ended, for the metrics.
metrics_reason supervisor__exit_reason(const supervisor__task *task, int status);

/// Tell the store how the run ends, with its summary; what the store refuses is tried once more as
/// a failure, then as going back to the queue. False: even that was refused.
bool supervisor__finish(supervisor__task *task, store *s, store_ending *ending, unsigned n_threads);

/// Solving time so far, all attempts together, s.
double supervisor__wall_s(const supervisor__task *task);

/// Forget what is not stored yet.
void supervisor__free_items(supervisor__task *task);

/// Free; the child must have been reaped. NULL is fine.
void supervisor__task_free(supervisor__task *task);

/// Take one run from the queue and start it. False: there is none, no room, or this is not the time.
bool supervisor__claim(supervisor *s);

/// Tell the store later that the run is in this state, and claim nothing before that.
void supervisor__owe(supervisor *s, const char *run_id, run_state state);

/// Claim nothing for a while: something is wrong that the next run would meet too.
void supervisor__pause(supervisor *s);

/// Let the loop wait for events of fd. False: errno tells why not.
bool supervisor__watch_fd(supervisor *s, int fd, uint32_t events, supervisor__watch *w);
