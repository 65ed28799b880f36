/// The trials of a round, solved by several threads.

#pragma once

#include "server/cli/study_files.h"

/// The trials to solve.
typedef struct study_round {
    study_document *document; ///< of the study; not to be used meanwhile
    const study *study;       ///< same
    const size_t *trials;     ///< n of them
    size_t n;                 ///< how many
    int n_workers;            ///< at a time
    void *context;            ///< given to ended
    bf_status (*ended)(void *context, const api_trial *trial,
                       bf_error *err); ///< a trial has ended; called by one thread at a time
} study_round;

/// Solve them until all have ended or a caught signal has come (run_control_is_stopped()); then those under way are dropped.
/// A trial that fails is told; other failures are returned: BF_ENOMEM, BF_ESYSTEM, that of ended.
BF_MUST_CHECK bf_status study_round_solve(study_round *t, bf_error *err);
