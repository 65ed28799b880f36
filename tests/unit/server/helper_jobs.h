/// A world whose supervisor, once started, has an executor of the test's (helper_executor.h).

#pragma once

#include "tests/unit/server/helper_executor.h"
#include "tests/unit/server/helper_store.h"
#include "tests/unit/server/helper_supervisor.h"

#include <stdint.h>

/// A scenario whose curve has two columns; what its jobs send is the test's.
extern const char helper_jobs_belt[];

/// The two.
typedef struct helper_jobs {
    helper_world *world;
    helper_executor *executor;
} helper_jobs;

/// Make and remove one, with deadlines of 50 ms. Fixtures of cmocka.
int helper_jobs_setup(void **state);
int helper_jobs_teardown(void **state);

/// Start the supervisor, and a run in it; the run's job is number 0.
api_run helper_jobs_start(helper_jobs *f);

/// Assert that the run has samples 0 to n - 1 of helper_executor_samples() without offset, once each, with one event for
/// each, and snapshots 0 to n_snapshots - 1.
void helper_jobs_assert_data(helper_world *w, const char *id, uint64_t n, uint64_t n_snapshots);
