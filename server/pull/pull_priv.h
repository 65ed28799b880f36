/// What the files of the pulling workers' executor have in common: pull_executor.c (what the supervisor calls), workers.c
/// (who there is), leases.c (who has which jobs), delivery.c (bytes of frames), ends.c (what was reported as ended), doubts.c (failures
/// that are to be confirmed), and checks.c (runs that are solved twice).
/// All functions but the executor's and the services' own are called with the lock held.

#pragma once

#include "server/base/lock.h"
#include "server/base/metrics.h"
#include "server/pull/pull_executor.h"

#include <string.h>
#include <sys/queue.h>

enum {
    PULL_TICK_MS = 1000,                 ///< between looks at who is silent
    PULL_ENDS_KEPT = 4096,               ///< that later ones are compared with
    PULL_DOUBTS_KEPT = 512,              ///< failures that are to be confirmed
    PULL_OTHERS_FIRST_MS = 600000,       ///< that a run waits for a worker who has not failed at it
    PULL_BEGIN_MS = 300000,              ///< until a run that was leased must have begun
    PULL_BEGIN_TRIAL_MS = 3600000,       ///< the same of a trial, which waits for others
    PULL_TRIALS_A_CORE = 4,              ///< of a batch; as many again wait here
    PULL_BATCH_S = 45,                   ///< of predicted time for each core of a worker
    PULL_BATCH_BYTES = 16 * 1024 * 1024, ///< of input, unless it is one job
};

typedef struct pull__lease pull__lease;
typedef struct pull__check pull__check;

/// Where a job is.
typedef enum pull__place {
    PULL_WAITING, ///< for a worker who asks
    PULL_AWAITED, ///< for the worker who had it before the daemon was started
    PULL_LEASED,  ///< in a lease
    PULL_ENDED,   ///< its worker has sent all and said how it ended
    PULL_LOST,    ///< its worker is gone
    PULL_PLACES
} pull__place;

/// A job of the supervisor, or a repetition of one for comparison. It is in the executor's list until the supervisor
/// releases it; a repetition, of which the supervisor does not know, until it is over.
struct executor_job {
    char id[EXECUTOR_ID_SIZE];    ///< "pull:RUN:ATTEMPT"
    api_lease_job about;          ///< as workers see it
    char study[API_ID_SIZE];      ///< whose trial it is; "": a run by itself
    pull__place place;            ///< where it is
    pull__lease *lease;           ///< PULL_LEASED: whose it is; else NULL
    uint64_t token;               ///< of who had it last
    char worker[API_WORKER_SIZE]; ///< who had it last; "": nobody
    int64_t started_ms;           ///< since when it is the supervisor's
    int64_t leased_ms;            ///< PULL_LEASED: since when
    bool is_adopted;              ///< it was leased by the daemon before
    int64_t until_ms;             ///< PULL_AWAITED: then it is lost
    bf_buffer input;     ///< for the solver, until it has begun; with a check until the end
    pull__check *check;  ///< of a run that is solved twice; NULL: it is not
    bool is_repetition;  ///< what comes is compared and dropped
    bool has_begun;      ///< its worker has sent something, or used time
    bf_buffer bytes;     ///< that came and were not taken
    uint64_t n_received; ///< bytes of its frames so far
    api_job_stop stop;   ///< what its worker is to do
    executor_end end;    ///< PULL_ENDED
    double used_s;       ///< CPU time so far
    TAILQ_ENTRY(executor_job) entry; ///< in pull_executor.jobs
};

/// A worker.
typedef struct pull__worker {
    api_worker about;           ///< as it describes itself
    int64_t seen_ms;            ///< when it was last heard of
    unsigned n_faults;          ///< of its, since it was last suspended
    int64_t suspended_until_ms; ///< it gets nothing before that; 0: it does
} pull__worker;

/// A lease.
struct pull__lease {
    char id[API_ID_SIZE];         ///< as workers know it
    uint64_t token;               ///< of whose
    char worker[API_WORKER_SIZE]; ///< whose
    int64_t begun_ms;             ///< when it began
    int64_t seen_ms;              ///< when its worker was last heard of
    size_t n_jobs;                ///< that it began with
    size_t n_open;                ///< of them, still in it
    size_t n_done;                ///< of them, ended
    uint64_t n_bytes;             ///< that came
    executor_job **jobs;          ///< n_jobs; NULL: not in it any more
};

/// The end of an attempt, for comparison.
typedef struct pull__end {
    char run[API_ID_SIZE];        ///< "": none
    uint64_t attempt;             ///< which
    char worker[API_WORKER_SIZE]; ///< whose
    char digest[API_DIGEST_SIZE]; ///< of its last frame
} pull__end;

/// A failure of a run that one worker has told of.
typedef struct pull__doubt {
    char run[API_ID_SIZE];        ///< "": none
    uint64_t attempt;             ///< which
    uint64_t token;               ///< of whose
    char worker[API_WORKER_SIZE]; ///< whose
    bf_error why;                 ///< as it says
} pull__doubt;

/// The executor.
typedef struct pull_executor {
    executor base;                   ///< first
    int news_fd;                     ///< eventfd: something has come for the supervisor
    int timer_fd;                    ///< ticks while there is anybody who could fall silent
    bool is_ticking;                 ///< it does
    lock lock;                       ///< guards what follows
    predictor *predictor;            ///< of jobs; NULL: none
    uint64_t last_attempt;           ///< rises, also from one daemon to the next
    TAILQ_HEAD(, executor_job) jobs; ///< the oldest first
    size_t n_at[PULL_PLACES];        ///< jobs at each place
    uint32_t n_cores_used[2];        ///< by jobs that have not ended: runs by themselves, trials
    size_t n_bytes;                  ///< that came and were not taken, of all jobs
    uint32_t n_cores;                ///< of all workers
    size_t n_workers;                ///< workers
    pull__worker *workers;           ///< room for API_WORKERS_MAX
    size_t n_leases;                 ///< leases
    pull__lease **leases;            ///< room for API_LEASES_MAX
    size_t n_ends;                   ///< ever noted
    pull__end *ends;                 ///< PULL_ENDS_KEPT, the newest ones, in a ring
    size_t n_doubts;                 ///< ever noted
    pull__doubt *doubts;             ///< PULL_DOUBTS_KEPT, the newest ones, in a ring
    uint32_t check_every;            ///< one of so many runs is solved twice; 0: none
    pull_suspecting *suspect;        ///< is told of results that may be wrong; NULL: nobody is
    void *suspect_context;           ///< given to it
} pull_executor;

/// Make wake_fd readable.
void pull__wake(pull_executor *e);

/// A job at the end of the list. NULL: no memory.
executor_job *pull__add_job(pull_executor *e, pull__place place, const char *run_id,
                            uint64_t attempt);

/// Take a job off the list, and free it.
void pull__remove_job(pull_executor *e, executor_job *job);

/// Move a job to another place: out of its lease, if it is in one, and out of the count of cores, if it has ended.
void pull__move(pull_executor *e, executor_job *job, pull__place place);

/// CPU time that a job will take, s; NAN: not known.
double pull__predict(const pull_executor *e, const executor_job *job);

/// The executor of a table of functions for workers, with its lock held from here on.
pull_executor *pull__enter(void *context);

/// The worker of this token and name, or NULL.
pull__worker *pull__find_worker(pull_executor *e, uint64_t token, const char *name);

/// Whether a lease is this worker's.
static inline bool pull__is_of(const pull__lease *lease, uint64_t token, const char *name)
{
    return lease->token == token && strcmp(lease->worker, name) == 0;
}

/// A worker is at fault for what became of a run; with PULL_FAULTS_MAX faults it gets nothing for a while.
void pull__attribute_fault(pull_executor *e, const char *run_id, uint64_t token, const char *worker,
                           const char *why);

/// Register a worker or bring it up to date. BF_ECONFLICT: another version of the solver; BF_EBUSY: there are too many.
BF_MUST_CHECK bf_status pull__meet_worker(pull_executor *e, const api_worker *who,
                                          pull__worker **ret_worker, bf_error *err);

/// BF_ECONFLICT: the worker's solver is another version than this one's.
BF_MUST_CHECK bf_status pull__check_version(const char *name, const char *solver, bf_error *err);

/// Forget the workers that are silent and have no lease.
void pull__drop_workers(pull_executor *e, int64_t now_ms);

/// Describe the workers of a token (API_ANY_TOKEN: all) and their leases; *ret_list is the caller's.
BF_MUST_CHECK bf_status pull__list(pull_executor *e, uint64_t token, api_worker_list *ret_list,
                                   bf_error *err);

/// A lease with n empty places. BF_EBUSY: too many; BF_ENOMEM.
BF_MUST_CHECK bf_status pull__begin_lease(pull_executor *e, const char *id, uint64_t token,
                                          const char *worker, size_t n, pull__lease **ret_lease,
                                          bf_error *err);

/// Put a job into a place of a lease.
void pull__put(pull_executor *e, pull__lease *lease, size_t place, executor_job *job);

/// The lease of this id that a token has, whose worker was heard of now, or NULL.
pull__lease *pull__hear(pull_executor *e, uint64_t token, const char *id);

/// Free a lease without jobs, and say so in the log.
void pull__end_lease(pull_executor *e, pull__lease *lease);

/// A job is lost, for this reason; one that had not begun comes back as if it had been stopped. Counts it and says so in the log.
void pull__lose_job(pull_executor *e, executor_job *job, const char *why);

/// The jobs of a lease are lost. Ends it.
void pull__lose_lease(pull_executor *e, pull__lease *lease, const char *why);

/// Lose what was not heard of in time.
void pull__expire(pull_executor *e, int64_t now_ms);

/// The services, of api/leases.h.
BF_MUST_CHECK bf_status pull__lease_jobs(void *context, const api_worker *who, api_lease *ret_lease,
                                         bf_error *err);
BF_MUST_CHECK bf_status pull__read_jobs(void *context, uint64_t token, const char *id,
                                        bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status pull__deliver(void *context, uint64_t token, const char *id,
                                      const api_lease_section *sections, size_t n,
                                      api_job_states *ret_states, bf_error *err);
BF_MUST_CHECK bf_status pull__renew(void *context, const char *id, const api_renewal *renewal,
                                    api_job_states *ret_states, bf_error *err);
BF_MUST_CHECK bf_status pull__leave(void *context, uint64_t token, const char *id, bf_error *err);

/// True if another attempt at the run has failed in the same way; else note that this one did.
bool pull__confirm_failure(pull_executor *e, const executor_job *job, const bf_error *why);

/// The run of a job has succeeded: who said that it fails is at fault.
void pull__refute_failures(pull_executor *e, const executor_job *job);

/// Whether a worker may have the job: not one that failed at its run, while there are others, first of all of other tokens.
bool pull__may_have(const pull_executor *e, const executor_job *job, const api_worker *who);

/// A check for a run that begins, if it is one of those that are solved twice; else, and without memory, NULL.
pull__check *pull__choose_check(const pull_executor *e);

/// Further bytes of a job's frames; NULL is fine.
void pull__check_bytes(pull__check *c, const char *bytes, size_t n);

/// A job has been solved: begin its repetition, or compare with those who have solved it before.
void pull__check_end(pull_executor *e, executor_job *job);

/// Whether a worker with this token has solved the run before.
bool pull__is_witness(const pull__check *c, uint64_t token);

/// Remove the repetitions that are over, or that took too long.
void pull__drop_repetitions(pull_executor *e, int64_t now_ms);

/// Free a check; NULL is fine. Always returns NULL.
pull__check *pull__check_destroy(pull__check *c);

/// Note the end of an attempt that was completed, and compare that of another attempt at the same run with it.
void pull__note_end(pull_executor *e, const char *worker, const api_job_end *end);
void pull__compare_end(const pull_executor *e, const char *worker, const api_job_end *end);
