/// Leases: how workers on other machines take jobs from the service, and send what solving them gives. A job is one
/// attempt at one run. A worker leases several at once, solves them, delivers the bytes of each one's frames
/// (core/observe/frame.h) in order, and renews its lease; one that is silent for API_LEASE_EXPIRES_S is over, and others
/// get its jobs.

#pragma once

#include "api/event.h"
#include "core/base/buffer.h"
#include "core/base/status.h"
#include "core/run/run.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    API_WORKER_SIZE = 65,      ///< bytes of a worker's name with its terminator
    API_VERSION_SIZE = 65,     ///< bytes of a solver's version with its terminator
    API_DIGEST_SIZE = 17,      ///< bytes of a digest in hexadecimal with its terminator
    API_WORKER_CORES = 1024,   ///< of a worker at most
    API_WORKERS_MAX = 4096,    ///< at once
    API_LEASES_MAX = 4096,     ///< at once
    API_LEASE_JOBS_MAX = 1024, ///< of a lease
    API_LEASE_RENEW_S = 10,    ///< between renewals
    API_LEASE_EXPIRES_S = 60,  ///< from the last sign of life of a worker
};

/// Of a list: the workers of all tokens.
#define API_ANY_TOKEN UINT64_MAX

/// How a job has ended, X(cause, word): after completing its work; with a failure; by a graceful stop, the daemon's or
/// another's, before it could handle it; by force, the daemon's or from outside; by a fault of the program; because it
/// used up its CPU time; its program could not be executed, so that nothing of it was done.
#define API_JOB_CAUSE_LIST(X)                                                                      \
    X(API_JOB_EXITED, "exited")                                                                    \
    X(API_JOB_FAILED, "failed")                                                                    \
    X(API_JOB_STOPPED, "stopped")                                                                  \
    X(API_JOB_KILLED, "killed")                                                                    \
    X(API_JOB_CRASHED, "crashed")                                                                  \
    X(API_JOB_TIMED_OUT, "timed_out")                                                              \
    X(API_JOB_UNSTARTED, "unstarted")

/// The causes.
typedef enum api_job_cause {
#define X(cause, word) cause,
    API_JOB_CAUSE_LIST(X)
#undef X
        API_JOB_CAUSES
} api_job_cause;

/// What is asked of a worker about a job, X(stop, word): go on; write a checkpoint, send what is left, end; drop it, it
/// is not the worker's any more.
#define API_JOB_STOP_LIST(X)                                                                       \
    X(API_JOB_GO_ON, "none")                                                                       \
    X(API_JOB_SAVE, "save")                                                                        \
    X(API_JOB_GONE, "gone")

/// The words.
typedef enum api_job_stop {
#define X(stop, word) stop,
    API_JOB_STOP_LIST(X)
#undef X
        API_JOB_STOPS
} api_job_stop;

/// A worker, as it describes itself. Who it is says its name together with the token that it presents.
typedef struct api_worker {
    uint64_t token;                ///< number of its access token; 0: there are none
    char name[API_WORKER_SIZE];    ///< letters, digits, '.', '_' and '-'
    char solver[API_VERSION_SIZE]; ///< version of its solver
    uint32_t cores;                ///< 1 .. API_WORKER_CORES
    uint64_t memory_bytes;         ///< of its machine
    uint32_t wait_s;               ///< how long it would wait for jobs; nobody has to let it
} api_worker;

/// A job of a lease.
typedef struct api_lease_job {
    uint32_t job;           ///< its number in the lease, from 0
    char run[API_ID_SIZE];  ///< which run
    uint64_t attempt;       ///< at the run: rises with each one
    run_model model;        ///< to solve with
    uint32_t n_threads;     ///< of the solver
    bool is_trial;          ///< of a study
    uint64_t checkpoint_ms; ///< between checkpoints
    uint64_t memory_bytes;  ///< address space; 0: unlimited
    uint64_t cpu_s;         ///< CPU seconds; 0: unlimited
    uint64_t step;          ///< of the checkpoint that it resumes from
    double predicted_s;     ///< CPU time that it may take; NAN: not known
    uint64_t n_bytes;       ///< of its input
} api_lease_job;

/// A lease. Zero-initialise; api_lease_fini().
typedef struct api_lease {
    char id[API_ID_SIZE]; ///< "": there are no jobs
    uint32_t renew_s;     ///< between two renewals at most
    uint32_t expires_s;   ///< after so long without a word it is over
    uint32_t retry_s;     ///< without jobs: seconds until it helps to ask again
    uint64_t body_bytes;  ///< that a request of the worker may have; 0: any number
    size_t n_jobs;        ///< jobs
    api_lease_job *jobs;  ///< n_jobs
} api_lease;

/// Bytes of a job's frames.
typedef struct api_lease_section {
    uint32_t job;      ///< whose
    uint64_t offset;   ///< of the first byte in the whole of its frames
    size_t n;          ///< bytes
    const void *bytes; ///< n, borrowed
} api_lease_section;

/// What a worker says of a job that it has.
typedef struct api_job_report {
    uint32_t job;          ///< its number in the lease
    char run[API_ID_SIZE]; ///< which run
    uint64_t attempt;      ///< as leased
    double cpu_s;          ///< CPU time so far
} api_job_report;

/// And of one that has ended.
typedef struct api_job_end {
    api_job_report report;        ///< which
    api_job_cause cause;          ///< how
    bf_error error;               ///< why, if its frames do not say; code BF_OK: none
    uint64_t n_bytes;             ///< of all its frames
    char digest[API_DIGEST_SIZE]; ///< of its last frame; "": it has none
} api_job_end;

/// A renewal: all jobs of the lease, those that have ended apart. api_renewal_fini().
typedef struct api_renewal {
    uint64_t token;                ///< as of api_worker
    char worker[API_WORKER_SIZE];  ///< whose lease it is
    char solver[API_VERSION_SIZE]; ///< version of its solver
    size_t n_jobs;                 ///< that have not ended
    api_job_report *jobs;          ///< n_jobs
    size_t n_ended;                ///< that have
    api_job_end *ended;            ///< n_ended
} api_renewal;

/// What became of a job's bytes, and what is asked of its worker. One that has ended is taken when all its bytes are.
typedef struct api_job_state {
    uint32_t job;      ///< its number in the lease
    uint64_t next;     ///< the offset that is expected next
    api_job_stop stop; ///< what is asked
} api_job_state;

/// States of jobs: of those that were named, and of others of which something is asked. Free the items.
typedef struct api_job_states {
    size_t n;             ///< states
    api_job_state *items; ///< n
} api_job_states;

/// A lease as others see it.
typedef struct api_lease_view {
    char id[API_ID_SIZE]; ///< of the lease
    uint64_t n_jobs;      ///< that it began with
    uint64_t n_done;      ///< of them, ended
    double expires_in_s;  ///< unless the worker is heard of
} api_lease_view;

/// A worker as others see it.
typedef struct api_worker_view {
    api_worker about;       ///< as it describes itself
    double seen_s;          ///< since it was last heard of
    size_t n_leases;        ///< leases
    api_lease_view *leases; ///< n_leases, of the list's array
} api_worker_view;

/// All workers that were heard of. Zero-initialise; api_worker_list_fini().
typedef struct api_worker_list {
    size_t n;                 ///< workers
    api_worker_view *workers; ///< n
    api_lease_view *leases;   ///< of all of them
} api_worker_list;

/// The services for workers. Thread-safe, and none of them waits. A lease is there for the token alone that took it.
typedef struct api_leases {
    void *context; ///< first argument of every function
    /// Lease jobs, as many as the worker should have. BF_ECONFLICT: its solver is another version than the service's;
    /// BF_EBUSY: too many workers or leases.
    bf_status (*lease)(void *context, const api_worker *who, api_lease *ret_lease, bf_error *err);
    /// Append the input of a lease's jobs: of each FRAME_JOB and, where it resumes, FRAME_RESUME. BF_ENOTFOUND;
    /// BF_ECONFLICT: some of them have begun.
    bf_status (*read_jobs)(void *context, uint64_t token, const char *id, bf_buffer *out,
                           bf_error *err);
    /// Take bytes of jobs: what came before is ignored, what leaves a gap or has no place now is not taken. BF_ENOTFOUND.
    bf_status (*deliver)(void *context, uint64_t token, const char *id,
                         const api_lease_section *sections, size_t n, api_job_states *ret_states,
                         bf_error *err);
    /// Renew a lease; one that is not known becomes one where jobs wait for it. BF_ECONFLICT as of lease().
    bf_status (*renew)(void *context, const char *id, const api_renewal *renewal,
                       api_job_states *ret_states, bf_error *err);
    /// End a lease: what has not ended is for others. BF_ENOTFOUND.
    bf_status (*leave)(void *context, uint64_t token, const char *id, bf_error *err);
    /// The workers of a token, or of API_ANY_TOKEN.
    bf_status (*list)(void *context, uint64_t token, api_worker_list *ret_list, bf_error *err);
} api_leases;

/// Free what they own and zero them.
void api_lease_fini(api_lease *lease);
void api_renewal_fini(api_renewal *renewal);
void api_worker_list_fini(api_worker_list *list);
