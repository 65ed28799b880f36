/// Runs that were found lately, in memory: as long as nothing is committed, each is what the store would find. Dashboards
/// ask for the same runs again and again, and are answered without the disk and without a thread of their own.
///
/// Threads  the functions may be called from any thread.

#pragma once

#include "api/services.h"
#include "server/base/lock.h"

#include <stdbool.h>
#include <stdint.h>

enum { FOUND_RUNS_MAX = 256 }; ///< runs that are remembered

/// A run, and when it was read.
typedef struct found_run {
    uint64_t n_commits; ///< of the store before it was read
    api_run record;     ///< id "": none
} found_run;

/// The runs. Zero-initialise, found_runs_init().
typedef struct found_runs {
    lock lock; ///< guards runs
    found_run
        runs[FOUND_RUNS_MAX]; ///< each at the place of its id; a newer one takes an older one's
} found_runs;

/// Prepare the lock of *f, and free it.
void found_runs_init(found_runs *f);
void found_runs_fini(found_runs *f);

/// Copy the run of this id to *ret_run (NULL: do not), if it was read when the store had made n_commits. False: it was not.
bool found_runs_look(found_runs *f, const char *id, uint64_t n_commits, api_run *ret_run);

/// Remember a run that was read after the store had made n_commits.
void found_runs_remember(found_runs *f, uint64_t n_commits, const api_run *record);
