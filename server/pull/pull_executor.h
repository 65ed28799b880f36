/// The executor of workers that pull: a job waits until a worker on any machine leases it (api/leases.h), and its frames
/// come over HTTP. The supervisor sees jobs (server/run/executor.h), requests see leases; what they have in common is
/// under one lock.
///
/// Safety   what workers do wrong is theirs: a damaged stream or a job that cannot be begun brings the run back to the
///          queue, and a worker with PULL_FAULTS_MAX of them gets nothing for PULL_SUSPENDED_MS.
/// Restart  a job outlives the daemon under the name "pull:RUN:ATTEMPT". After a restart it waits for its worker, which
///          sends all its frames again.

#pragma once

#include "api/leases.h"
#include "server/run/executor.h"
#include "server/run/predictor.h"

enum {
    PULL_JOB_BYTES_MAX = 1024 * 1024,  ///< of a job that wait for the supervisor
    PULL_BYTES_MAX = 64 * 1024 * 1024, ///< of all jobs together
    PULL_FAULTS_MAX = 3,               ///< of a worker, until it gets no jobs for a while
    PULL_SUSPENDED_MS = 600000,        ///< how long
};

/// Create one. BF_ENOMEM, BF_ESYSTEM: no memory or descriptor.
BF_MUST_CHECK bf_status pull_executor_create(executor **ret_executor, bf_error *err);

/// From now on say of jobs how long they will take; the predictor must outlive the use of the executor's services. NULL, as
/// at the beginning: nothing is said.
void pull_executor_set_predictor(executor *e, predictor *p);

/// From now on solve one of n runs a second time, at a worker with another token, and compare the results. 0, as at the beginning: none.
void pull_executor_set_check_every(executor *e, uint32_t n);

/// The results of a run may be wrong, or, with run_id NULL, all that workers with this token have sent. Must neither block nor call
/// the executor.
typedef void pull_suspecting(void *context, const char *run_id, uint64_t token);

/// From now on tell of results that others contradict. NULL, as at the beginning: nobody is told.
void pull_executor_set_suspecting(executor *e, pull_suspecting *tell, void *context);

/// Free it; all jobs that the supervisor took must have been released, and no request may be in it. NULL is fine. Always
/// returns NULL.
executor *pull_executor_destroy(executor *e);

/// Cores that jobs which wait or are being solved use.
uint32_t pull_executor_count_cores(executor *e);

/// True if a worker of this name was heard of in the last minute, or has a lease.
bool pull_executor_has_worker(executor *e, const char *worker);

/// The services for workers; the executor must outlive their use.
api_leases pull_executor_leases(executor *e);
