/// A supervisor with a store of its own in a temporary directory, and worker programs made for a
/// test, for tests.

#pragma once

#include "server/base/lock.h"
#include "server/run/local_executor.h"
#include "server/run/supervisor.h"
#include "tests/unit/helper_cmocka.h"

#include <stdatomic.h>
#include <stdbool.h>

enum { HELPER_PATH_SIZE = 256 }; ///< bytes of a path with its terminator

/// A scenario that ends soon, with 101 samples and 11 snapshots; a jam before a wall across the whole belt that does not
/// end, and one that takes about a second.
extern const char helper_short_belt[], helper_long_jam[], helper_medium_jam[];

/// What a test of the supervisor needs.
typedef struct helper_world {
    char directory[HELPER_PATH_SIZE]; ///< of the test, removed at the end
    char program[HELPER_PATH_SIZE];   ///< that is started for each run
    supervisor_options options;       ///< for helper_supervise()
    run_model model;                  ///< of what is submitted (RUN_MACRO)
    store *store;                     ///< open
    uint64_t attempts_max;            ///< for helper_world_reopen(); at first any number
    supervisor *supervisor;           ///< NULL: not started
    executor *local;                  ///< of helper_supervise(), if options name no executor
    lock lock;                        ///< of n_commits, and of supervisor for the listener
    lock_condition committed;         ///< n_commits has changed
    uint64_t n_commits;               ///< changed runs that the listener was called for
    _Atomic unsigned commit_us; ///< how much longer a commit takes for each run that it changes
} helper_world;

/// Fixtures of cmocka: a store, no supervisor yet, the real program.
int helper_world_setup(void **state);
int helper_world_teardown(void **state);

/// Close the store and open it again.
void helper_world_reopen(helper_world *w);

/// Make the program a shell script of these lines.
void helper_world_fake(helper_world *w, const char *lines);

/// Write bytes to a file in the test's directory and return its path (static storage).
const char *helper_world_file(const helper_world *w, const char *name, const void *bytes, size_t n);

/// Start the supervisor, with the executor of the options or else with child processes.
void helper_supervise(helper_world *w);

/// Stop it.
void helper_world_stop(helper_world *w, int64_t grace_ms);

/// From now on a commit takes this much longer for each run that it changes.
void helper_world_slow_commits(helper_world *w, unsigned ms);

/// Request a running run to be cancelled; to be stopped at once, and wait until it has.
void helper_world_cancel(helper_world *w, const char *id);
void helper_world_kill(helper_world *w, const char *id);

/// Submit a scenario and wake the supervisor, if there is one.
api_run helper_world_submit(helper_world *w, const char *json);

/// Wait until the run is in this state, or has this many samples stored; fails after a minute.
api_run helper_await_state(helper_world *w, const char *id, run_state state);
api_run helper_await_samples(helper_world *w, const char *id, uint64_t n);

/// True if this process has no child.
bool helper_is_childless(void);
