/// What the files of a worker share: leases and their jobs, and the functions on them.

#pragma once

#include "server/run/executor.h"
#include "server/worker/http_call.h"
#include "server/worker/pull_worker.h"

/// How far a job is.
typedef enum worker_job_state {
    WORKER_JOB_WAITS, ///< for a core
    WORKER_JOB_RUNS,  ///< its child does
    WORKER_JOB_ENDED, ///< all its bytes are in the file; the daemon has not taken its end
    WORKER_JOB_OVER,  ///< nothing of it is left here
} worker_job_state;

/// A job of a lease.
typedef struct worker_job {
    api_lease_job about;          ///< as leased
    worker_job_state state;       ///< how far it is
    size_t at;                    ///< where its input begins in that of the lease, bytes
    executor_job *child;          ///< WORKER_JOB_RUNS
    executor_end end;             ///< WORKER_JOB_ENDED
    double used_s;                ///< CPU time
    int spool;                    ///< file of its frames
    uint64_t n_spooled;           ///< bytes in it
    uint64_t n_taken;             ///< of them, by the daemon
    char digest[API_DIGEST_SIZE]; ///< of its end; "": none
    unsigned n_refused;           ///< times that its child could not be started
    bool is_stopping;             ///< its child was asked to save and end
} worker_job;

/// A lease.
typedef struct worker_lease {
    char id[API_ID_SIZE]; ///< "": there is none
    worker_job *jobs;     ///< n_jobs
    size_t n_jobs;        ///< jobs
    bf_buffer input;      ///< of all jobs, when has_input
    bool has_input;       ///< it was fetched
    bool must_leave;      ///< jobs of it were given up
    int64_t begun_ms;     ///< by the clock that never jumps, as all times here
    int64_t renewed_ms;   ///< when it was last renewed
    int64_t sent_ms;      ///< when frames were last sent
    int64_t pause_ms;     ///< until then the daemon has no room for more frames
    bool must_renew;      ///< at once: the daemon does not know it
} worker_lease;

/// Leases at once: one that comes next, and those of which a job takes long.
enum { WORKER_LEASES = 64 };

/// What a request is about.
typedef enum worker_request {
    WORKER_REQUEST_NONE,
    WORKER_REQUEST_LEASE,
    WORKER_REQUEST_JOBS,
    WORKER_REQUEST_FRAMES,
    WORKER_REQUEST_RENEW,
    WORKER_REQUEST_LEAVE,
} worker_request;

/// The worker.
typedef struct worker {
    const pull_worker_options *options; ///< the caller's
    executor *solver;                   ///< child processes
    http_call *call;                    ///< to the daemon
    worker_lease leases[WORKER_LEASES]; ///< some of them
    worker_request request;             ///< that is going on
    worker_lease *about;                ///< whose it is; NULL: of none
    bf_buffer body;                     ///< of the request
    /// WORKER_REQUEST_FRAMES: end of what it has of each job; 0: nothing
    uint64_t sent_to[API_LEASE_JOBS_MAX];
    bool is_ended[API_LEASE_JOBS_MAX]; ///< WORKER_REQUEST_RENEW: the job is told to have ended
    size_t request_bytes;              ///< of a request, as the service lets; 0: not said
    int64_t ask_ms;                    ///< when to ask for jobs
    int64_t busy_ms;                   ///< when there last was a job
    int64_t retry_ms;                  ///< no request before: the last one failed
    int64_t backoff_ms;                ///< until the one after that
    int64_t start_ms;                  ///< no child before: the last one could not be started
    uint64_t n_spooled;                ///< bytes of all files
    int64_t end_ms;                    ///< is_draining: when what is left is given up
    bool is_leaving;                   ///< it leases nothing more
    bool is_draining;                  ///< it is to end
    bool must_end;                     ///< at once
    bool has_failed;                   ///< with this error:
    bf_error error;                    ///< why
} worker;

/// Note why the worker has to end, as soon as it has delivered what it has.
void worker__fail(worker *w, const bf_error *why);

/// Make a lease of what was leased. BF_ENOMEM.
BF_MUST_CHECK bf_status worker__add_lease(worker *w, const api_lease *lease, bf_error *err);

/// Take the input of a lease's jobs. BF_ECORRUPT: it is not as long as was said.
BF_MUST_CHECK bf_status worker__take_input(worker_lease *lease, const bf_buffer *input,
                                           bf_error *err);

/// Forget a lease with all its jobs.
void worker__end_lease(worker *w, worker_lease *lease);

/// Let a job go: its child ends at once, its file is closed.
void worker__drop_job(worker *w, worker_job *job);

/// Start what waits and has cores.
void worker__start_jobs(worker *w);

/// Take what children have sent, and note which have ended.
void worker__collect(worker *w);

/// True if the files have a quarter of their room left: time to lease more, and none to save what is being solved.
bool worker__has_spool(const worker *w);

/// Ask a job to save and end; one that has not begun ends at once.
void worker__stop_job(worker *w, worker_job *job);

/// Lease nothing more; all jobs are to save and end, those that wait are given up. A second call changes nothing.
void worker__drain(worker *w);

/// True if there is no lease.
bool worker__is_idle(const worker *w);

/// Threads of all jobs in a state.
unsigned worker__count_threads(const worker *w, worker_job_state state);

/// True if less waits than all cores can begin at once: time to lease more.
bool worker__wants_jobs(const worker *w);

/// Begin the request that is most urgent, if there is one.
void worker__ask(worker *w, int64_t now);

/// Act on an answer.
void worker__take_answer(worker *w, const http_call_answer *answer, int64_t now);
