/// Where runs are solved: what the supervisor needs of child processes, of workers on other machines, or
/// of anything else that can run the solver.
///
/// A job is one attempt at one run. It sends back the bytes of frames (core/observe/frame.h), which the
/// supervisor takes with poll() at its own speed: bytes that it does not take stay with the executor, which
/// must then hold the sender back (a full pipe, an HTTP request that is not answered yet) instead of
/// storing without bound.
///
/// A job is named by an external id, a text that only its executor understands and that the store keeps
/// with the run. After a restart of the daemon attach() finds a job by it that goes on meanwhile. Frames
/// belong to a job, not to a run: what a job sends after the supervisor released it is discarded, so
/// that two attempts at one run cannot mix.
///
/// Implementations  server/run/local_executor.h: child processes of the daemon.
/// Threads  all functions but ready() are called from the supervisor's thread (attach() also
///          before that has started). Another source of a job's bytes (a thread that receives frames over
///          HTTP) synchronises inside the executor and makes wake_fd readable.

#pragma once

#include "api/leases.h"
#include "core/base/buffer.h"
#include "core/base/status.h"
#include "core/run/run.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { EXECUTOR_ID_SIZE = 128 }; ///< bytes of an external id with its terminator

typedef struct executor executor;
typedef struct executor_job executor_job;

/// What solvers are started with.
typedef struct executor_limits {
    int64_t checkpoint_ms; ///< between checkpoints
    uint64_t memory_bytes; ///< address space; 0: unlimited
    uint64_t cpu_s;        ///< CPU seconds; 0: unlimited
} executor_limits;

/// What a job has to do, and what it may use. Borrowed for the call of start().
typedef struct executor_work {
    const char *run_id;          ///< for logs
    run_model model;             ///< to solve with
    unsigned n_threads;          ///< of the solver, >= 1
    bool is_trial;               ///< of a study: no snapshots, and others come first
    const char *study_id;        ///< of a trial: whose it is
    const bf_buffer *scenario;   ///< resolved document
    const bf_buffer *checkpoint; ///< to resume from; n = 0: from t = 0
    uint64_t step;               ///< of the checkpoint
    executor_limits limits;      ///< of the solver
} executor_work;

/// How a job is asked to end; the later one is the stronger one.
typedef enum executor_stop {
    EXECUTOR_STOP_GRACEFUL, ///< write a checkpoint, send the frames that are left, and end
    EXECUTOR_STOP_NOW,      ///< end at once, without saving anything
} executor_stop;

/// What poll() finds.
typedef enum executor_state {
    EXECUTOR_RUNNING, ///< it is being solved
    EXECUTOR_WAITING, ///< nobody has begun to solve it: its times do not run yet
    EXECUTOR_ENDED,   ///< it has ended, and all its bytes have been taken
    EXECUTOR_LOST, ///< nothing more will come, for an unknown reason; all its bytes have been taken
    EXECUTOR_UNKNOWN, ///< the state is temporarily not known; it may still be running
} executor_state;

/// The end of a job.
typedef struct executor_end {
    api_job_cause cause; ///< how it ended
    bf_error error;      ///< the run's error, if its frames do not explain the end
} executor_end;

/// The operations of an executor.
typedef struct executor_functions {
    /// BF_OK if jobs can be started, as far as that can be told without starting one; else why not. Does not
    /// block. The one function that any thread may call.
    bf_status (*ready)(executor *e, bf_error *err);

    /// True if it takes one more job now: of a trial, or of a run by itself. It makes wake_fd readable when it has
    /// room again. NULL: supervisor_options.n_workers says how many there are.
    bool (*has_room)(executor *e, bool is_trial);

    /// Do what can be done for the next job before it is known; it has these limits, as far as is known. Whether that
    /// succeeds shows when the job starts. NULL: there is nothing.
    void (*prepare)(executor *e, const executor_limits *limits);

    /// Start a job. The executor keeps nothing of *work. BF_EBUSY, BF_ENOMEM, BF_ESYSTEM: the executor is at
    /// fault, and it may work later; other errors: this job can never be started.
    bf_status (*start)(executor *e, const executor_work *work, executor_job **ret_job,
                       bf_error *err);

    /// Take over the job of this name, started before the daemon was. Its frames come again from
    /// FRAME_BEGIN; samples and snapshots may come again from any one that the store has. Called
    /// again before the supervisor has started, it returns the same job. BF_ENOTFOUND: there is no such
    /// job any more.
    bf_status (*attach)(executor *e, const char *external_id, executor_job **ret_job,
                        bf_error *err);

    /// Signal a job to end. Returns at once; poll() shows when it has ended.
    void (*stop)(executor *e, executor_job *job, executor_stop how);

    /// Notice what has happened since the last call. Called when wake_fd is readable, which it is not
    /// any more then.
    void (*update)(executor *e);

    /// Take at most `capacity` bytes that the job has sent; *ret_n = 0: none are there at the moment.
    /// *ret_end is set with EXECUTOR_ENDED.
    executor_state (*poll)(executor *e, executor_job *job, void *bytes, size_t capacity,
                           size_t *ret_n, executor_end *ret_end);

    /// What came of this job is damaged, or it could not be begun. True: who solves it may be at fault rather than the
    /// run, which is to be queued again; the executor sees to it that the same one does not fail runs again and again.
    /// NULL: the run is at fault.
    bool (*attribute_fault)(executor *e, executor_job *job, const bf_error *why);

    /// Who solved the job says that its run fails for this reason, or, with NULL, its run has succeeded. True: that counts;
    /// false: the run is to be tried again, as nobody else has said the same. NULL: what a job says counts.
    bool (*confirm)(executor *e, const executor_job *job, const bf_error *why);

    /// The token of the worker that has the job; 0: none. NULL: there are no workers.
    uint64_t (*token)(executor *e, const executor_job *job);

    /// CPU seconds that the job has used so far; once it has ended, all that it used. Never falls.
    double (*cpu_s)(executor *e, executor_job *job);

    /// The job's name, valid until it is released.
    const char *(*external_id)(const executor_job *job);

    /// Have nothing more to do with a job; one that still runs is ended like by EXECUTOR_STOP_NOW.
    void (*release)(executor *e, executor_job *job);
} executor_functions;

/// An executor: the first member of each implementation's own struct.
struct executor {
    const executor_functions *functions; ///< never NULL
    int wake_fd;                         ///< readable when poll() may find something new
    bool
        is_elsewhere; ///< who solves its jobs may be wrong or lie: what they say is compared with the scenario
    bool
        outlives_daemon; ///< its jobs, but for those of trials, go on when the daemon ends: attach() may find them
};

/// Append what a solver reads of the work: FRAME_JOB, and FRAME_RESUME where there is a checkpoint. BF_ENOMEM; BF_ELIMIT.
BF_MUST_CHECK bf_status executor_encode(const executor_work *work, bf_buffer *out, bf_error *err);
