/// The life of a run: its states, and which may follow which, as one table.
///
///     queued ----> running ----> succeeded | failed | cancelled
///       |  <---------'  (handed back: the daemon stopped or was restarted)
///       '---> cancelled | failed

#pragma once

#include <stdbool.h>

/// State, word in the API, states that may follow (flags), whether it is an end.
#define RUN_STATE_LIST(X)                                                                          \
    X(RUN_QUEUED, "queued", RUN_TO(RUN_RUNNING) | RUN_TO(RUN_CANCELLED) | RUN_TO(RUN_FAILED))      \
    X(RUN_RUNNING, "running",                                                                      \
      RUN_TO(RUN_QUEUED) | RUN_TO(RUN_SUCCEEDED) | RUN_TO(RUN_FAILED) | RUN_TO(RUN_CANCELLED))     \
    X(RUN_SUCCEEDED, "succeeded", 0)                                                               \
    X(RUN_FAILED, "failed", 0)                                                                     \
    X(RUN_CANCELLED, "cancelled", 0)

/// The flag of a state in the third column.
#define RUN_TO(state) (1U << (state))

/// The states. The values stand in the store: never renumber.
typedef enum run_state {
#define X(state, word, next) state,
    RUN_STATE_LIST(X)
#undef X
        RUN_STATE_COUNT
} run_state;

/// The words of the states in the API, ended by NULL; and that of one, never NULL.
extern const char *const run_state_words[RUN_STATE_COUNT + 1];
const char *run_state_word(run_state state);

/// True if a run may go from one state to the other.
bool run_state_may_follow(run_state from, run_state to);

/// True if nothing may follow.
bool run_state_is_end(run_state state);
