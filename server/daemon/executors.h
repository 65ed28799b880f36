/// Who solves runs: the executor that the settings name, with what belongs to it.

#pragma once

#include "api/leases.h"
#include "server/daemon/config.h"
#include "server/run/executor.h"
#include "server/run/predictor.h"
#include "server/slurm/slurm.h"
#include "server/store/store.h"

/// The executor and its helpers. Zero-initialise.
typedef struct executors {
    config_executor kind; ///< of the settings at the start
    executor *executor;   ///< the supervisor's
    api_leases leases;    ///< for workers, unless kind is CONFIG_LOCAL
    slurm *slurm;         ///< CONFIG_SLURM: starts workers; else NULL
} executors;

/// Create the executor. BF_ENOMEM, BF_ESYSTEM.
BF_MUST_CHECK bf_status executors_create(executors *e, const config *c, bf_error *err);

/// From now on start workers, if it is this daemon that does; after the store, the predictor and HTTP. BF_EINPUT: a
/// setting of Slurm; BF_ENOMEM, BF_ESYSTEM.
BF_MUST_CHECK bf_status executors_start(executors *e, const config *c, store *s, bf_error *err);

/// Let predictions be told to workers, who are to have ended their requests before the predictor goes. Does nothing
/// for CONFIG_LOCAL.
void executors_set_predictor(executors *e, predictor *p);

/// Start no more workers.
void executors_stop(executors *e);

/// Free the executor, after the supervisor.
void executors_destroy(executors *e);

/// How many runs the supervisor may have solved at once.
unsigned executors_count_workers(const config *c);

/// What Slurm is to start workers with; the texts are those of the settings.
slurm_settings executors_slurm_settings(const config *c);
