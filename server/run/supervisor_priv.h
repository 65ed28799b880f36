/// What the files of the supervisor have in common: supervisor.c (thread and commands), queue.c (claiming and
/// what is written later), task.c (how a task starts and ends), deadlines.c (its times), frames.c (what its job
/// sends).
///
/// A task is a run under supervision; its life is drawn in server/run/README.md.

#pragma once

#include "api/results/key_figures.h"
#include "core/observe/frame.h"
#include "server/base/liveness.h"
#include "server/base/lock.h"
#include "server/base/metrics.h"
#include "server/run/snapshots.h"
#include "server/run/supervisor.h"
#include "server/run/writers.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum {
    SUPERVISOR_BACKOFF_FIRST_MS = 1000,  ///< of claiming after a failure; doubles each time
    SUPERVISOR_READ_BYTES = 1024 * 1024, ///< of one job in one turn, and so about in one batch
    SUPERVISOR_TASKS_MAX = 4096,         ///< waiting for workers, being solved and ending
    /// Being solved, runs by themselves and trials, and ending, where n_workers says how many are solved.
    SUPERVISOR_LOCAL_TASKS_MAX = 3 * SUPERVISOR_WORKERS_MAX,
    SUPERVISOR_TROUBLE_MS = 60000, ///< how long trouble counts, and between its lines in the log
};

/// How a task is to stop; the greater wins.
typedef enum supervisor__stop {
    SUPERVISOR_STOP_NONE,      ///< go on
    SUPERVISOR_STOP_HAND_BACK, ///< write a checkpoint, end, and be queued again
    SUPERVISOR_STOP_CANCEL,    ///< end and keep what there is
    SUPERVISOR_STOP_KILL,      ///< end at once
} supervisor__stop;

/// Where a task is in its life.
typedef enum supervisor__phase {
    SUPERVISOR_CLAIMING, ///< the next queued run is being claimed; the task has none yet
    SUPERVISOR_SOLVING,  ///< its job is running, or has ended and not everything is stored
    SUPERVISOR_ENDING,   ///< its job is over: how the run ends is being stored
} supervisor__phase;

/// One run that is being solved.
struct supervisor__task {
    supervisor *supervisor;             ///< whose
    supervisor__phase phase;            ///< where it is
    supervisor__write write;            ///< at most one is pending
    bool with_trials;                   ///< a trial may be claimed, too
    store_job claimed;                  ///< the run as it was claimed
    executor_job *job;                  ///< what solves it
    char external_id[EXECUTOR_ID_SIZE]; ///< the job's name
    unsigned n_threads;                 ///< of the job's solver
    size_t n_columns;                   ///< of claimed.columns
    supervisor__stop requested;         ///< how it is to stop
    supervisor__stop signalled;         ///< how much of that the job was signalled
    int64_t kill_at_ms;      ///< when it is stopped by force; -1: not planned, INT64_MAX: done
    int64_t lost_at_ms;      ///< when it counts as lost; -1: not planned
    double start_s;          ///< when its solving began, clock_monotonic_s(); 0: nobody has begun
    executor_state state;    ///< as of the last poll
    executor_end exit;       ///< valid if state is EXECUTOR_ENDED
    bool has_more;           ///< the job may have more bytes than one turn takes
    bool has_begun;          ///< FRAME_BEGIN came
    bool has_ended;          ///< FRAME_END came
    bool failed;             ///< it fails with error, regardless of later frames
    bool is_store_error;     ///< the error is the store's, not the run's: it is queued again
    bool is_fault_of_worker; ///< who solved it is at fault, not the run: it is queued again
    bool is_beyond_output;   ///< it sent more than output_bytes
    bool is_solved;    ///< it has succeeded: while its end is stored the next run may be solved
    bool timed_out;    ///< it was stopped by force because a time was over
    int64_t moved_ms;  ///< when it was last seen to go on, clock_monotonic_ms()
    frame_begin begin; ///< valid if has_begun
    frame_end end;     ///< valid if has_ended
    bf_error error;    ///< why it fails: sent by the job, or found here
    bool has_progress; ///< progress is not stored yet
    frame_progress progress; ///< the newest
    bool has_figures;        ///< key figures are not stored yet
    double figures_t;        ///< of the newest key figures, s
    bf_buffer figures;       ///< the newest, as doubles; empty if none came
    double reported_s;       ///< when a progress event was last made, clock_monotonic_s(); 0: never
    double rate;             ///< steps/s, smoothed; 0: not known yet
    double rate_s;           ///< when rate was last brought up to date
    uint64_t rate_step;      ///< the step then
    bf_buffer output;        ///< bytes that came
    size_t n_decoded;        ///< of them, at the start: decoded, to be dropped before the next read
    uint64_t n_sent;         ///< bytes of frames that are kept, see supervisor_options.output_bytes
    bool has_frames;         ///< whole frames may be left in output
    snapshots_items items;   ///< what is not stored yet
    store_batch batch;       ///< of SUPERVISOR_WRITE_BATCH; points into items and output
    store_ending ending;     ///< of SUPERVISOR_WRITE_END
    snapshots_incoming incoming; ///< the snapshot that is being sent
};

/// A state that the store refused when the run ended here; it is written later.
typedef struct supervisor__pending_update {
    char run_id[API_ID_SIZE]; ///< still `running` in the store
    run_state state;          ///< what it shall be
    double cpu_s;             ///< CPU time of all attempts
} supervisor__pending_update;

/// The supervisor.
///
/// Threads  the thread owns everything but what stands under the lock. Others set flags under the lock
///          and make wake_fd readable.
struct supervisor {
    store *store;               ///< as it was given; never changes
    executor *executor;         ///< as it was given; never changes
    supervisor_options options; ///< the thread's: currently in effect
    pthread_t thread;           ///< runs the loop
    int wake_fd;                ///< eventfd
    int64_t claim_at_ms;        ///< no claiming before; 0: at once
    int64_t held_until_ms; ///< when runs beyond their owners' quotas are looked at again; 0: none
    bool has_left_trials;  ///< the last claim that found nothing did not look for trials
    int64_t backoff_ms;    ///< how long the next backoff is
    int64_t logged_ms;     ///< when trouble was last logged; 0: never
    size_t n_tasks;        ///< tasks
    supervisor__task **tasks; ///< room for SUPERVISOR_TASKS_MAX
    size_t n_pending;         ///< pending updates; nothing is claimed while there are any
    supervisor__pending_update *pending; ///< room for SUPERVISOR_TASKS_MAX
    store_running *running;              ///< room for SUPERVISOR_TASKS_MAX, filled where it is used
    _Atomic uint64_t n_stop_requests;    ///< of the store, that were read
    lock lock;                           ///< guards what follows
    bool may_claim;                      ///< something may be queued
    bool may_stop;                       ///< there may be new stop requests
    bool is_stopping;                    ///< supervisor_stop() was called
    int64_t grace_ms;                    ///< with this
    bool has_new_options;                ///< the thread shall apply new_options
    supervisor_options new_options;      ///< see supervisor_reconfigure()
    bf_error trouble;                    ///< why runs could not be started
    int64_t trouble_until_ms;            ///< until when that counts; 0: there is none
    liveness liveness;                   ///< of the thread
    supervisor__writers writers;         ///< their own
};

/// Make wake_fd readable, so that the loop takes another turn.
void supervisor__wake_loop(supervisor *s);

/// A task without a run, in the list of tasks. NULL: no memory.
supervisor__task *supervisor__task_create(supervisor *s);

/// Start a job of the claimed run, or take over the one of this name (external_id not NULL). Errors are
/// those of executor_functions.
BF_MUST_CHECK bf_status supervisor__task_start(supervisor__task *task, const char *external_id,
                                               bf_error *err);

/// Let the executor do what it can for the next job.
void supervisor__prepare_job(supervisor *s);

/// Remove from the list, release the job and free; no write may be pending.
void supervisor__task_destroy(supervisor__task *task);

/// Read about SUPERVISOR_READ_BYTES of what was sent and begin to store it in one batch. A failure fails the task.
void supervisor__read_frames(supervisor__task *task);

/// Discard the batch that has been stored; end the task if it could not be stored.
void supervisor__finish_batch(supervisor__task *task);

/// What the task has not stored yet when its job is over, as a batch; NULL: nothing. A failure fails the task.
const store_batch *supervisor__last_batch(supervisor__task *task);

/// Count a frame of n bytes that the job has sent. False: it has sent more than output_bytes, and the task fails; what
/// it sent before is stored.
BF_MUST_CHECK bool supervisor__count_output(supervisor__task *task, frame_type type, size_t n);

/// The task fails with this error: discard what was sent and stop the job by force.
void supervisor__fail(supervisor__task *task, const bf_error *err);

/// Signal the requested stop to the task's job, by force after grace_ms; then declare it lost; fail a run that is overdue.
void supervisor__enforce(supervisor__task *task, int64_t grace_ms);

/// How long the loop may block, ms: -1 indefinitely, unless a time is set or there is data to read.
int supervisor__find_timeout(const supervisor *s);

/// How a run whose job has ended or was lost ends.
store_ending supervisor__classify_exit(const supervisor__task *task);

/// Why the job ended, for the metrics.
metrics_reason supervisor__exit_reason(const supervisor__task *task);

/// Write task->ending, with the summary, into the store and the log. What cannot be written of it is a failure of
/// the run, or if the store is at fault the run goes back to the queue: task->ending is what was written. An error
/// means that even that was refused. On a writing thread.
BF_MUST_CHECK bf_status supervisor__store_ending(supervisor__task *task, bf_error *err);

/// Compare what a solver elsewhere says of a run with its scenario: its begin, and with is_end also its end. BF_ECORRUPT.
/// On any thread that has the task.
BF_MUST_CHECK bf_status supervisor__check_claims(const supervisor__task *task, bool is_end,
                                                 bf_error *err);

/// Ask the executor whether who solves the task is at fault, and note it. Returns what it says.
bool supervisor__attribute_fault(supervisor__task *task, const bf_error *why);

/// True if the executor, not n_workers, says how many jobs it takes.
bool supervisor__has_workers(const supervisor *s);

/// The newest key figures of a run that sent some.
key_figures supervisor__figures(const supervisor__task *task);

/// Solving time and CPU time so far, all attempts together, s; the latter on the supervisor's thread.
double supervisor__wall_s(const supervisor__task *task);
double supervisor__cpu_s(const supervisor__task *task);

/// Free the items that are not stored yet.
void supervisor__free_items(supervisor__task *task);

/// Take over the runs that the daemon before left running and whose jobs go on.
void supervisor__attach(supervisor *s);

/// True if another run may be solved at once.
bool supervisor__has_room(const supervisor *s);

/// A task without a run that is to claim one, if there is room and this is the time; else NULL.
supervisor__task *supervisor__create_claiming(supervisor *s);

/// Begin to claim a run from the queue, if there is room and this is the time.
void supervisor__claim(supervisor *s);

/// Start the run that was claimed, or take note that there is none.
void supervisor__finish_claim(supervisor__task *task);

/// Write the state and CPU time (0: no more than is known) of the run later, and claim nothing before that.
void supervisor__defer(supervisor *s, const char *run_id, run_state state, double cpu_s);

/// Runs cannot be started: claim nothing for a while, be not ready, and log it once a minute.
void supervisor__note_trouble(supervisor *s, const bf_error *err);

/// A run has begun, or none waits: there is no trouble any more.
void supervisor__forget_trouble(supervisor *s);

/// True if the failure is of the executor or the store, not of the run, so that it may not come again.
bool supervisor__may_work_later(bf_status code);

/// Claim nothing for a while: something is wrong that the next run would meet too.
void supervisor__backoff(supervisor *s);
