/// Runs that were found lately, in memory: as long as nothing is committed, each is what the store would find. Dashboards
/// ask for the same runs again and again, and are answered without the disk and without a thread of their own.
///
/// Threads  the functions may be called from any thread.

#pragma once

#include "api/services.h"
#include "server/base/lock.h"

#include <stdbool.h>
#include <stdint.h>

enum { RUN_CACHE_MAX = 256 }; ///< runs that are remembered

/// A run, and when it was read.
typedef struct found_run {
    uint64_t n_commits; ///< of the store before it was read
    api_run record;     ///< id "": none
} found_run;

/// The runs. Zero-initialise, run_cache_init().
typedef struct run_cache {
    lock lock; ///< guards runs
    found_run
        runs[RUN_CACHE_MAX]; ///< each at the place of its id; a newer one takes an older one's
} run_cache;

/// Prepare the lock of *f, and free it.
void run_cache_init(run_cache *f);
void run_cache_fini(run_cache *f);

/// Copy the run of this id to *ret_run (NULL: do not), if it was read when the store had made n_commits. False: it was not.
bool run_cache_look(run_cache *f, const char *id, uint64_t n_commits, api_run *ret_run);

/// Remember a run that was read after the store had made n_commits.
void run_cache_remember(run_cache *f, uint64_t n_commits, const api_run *record);
