#include "api/run_state.h"

#include "core/base/check.h"

const char *const run_state_words[RUN_STATE_COUNT + 1] = {
#define X(state, word, next) word,
    RUN_STATE_LIST(X)
#undef X
};

static const unsigned next_states[] = {
#define X(state, word, next) next,
    RUN_STATE_LIST(X)
#undef X
};

const char *run_state_word(run_state state)
{
    BF_CHECK(state < RUN_STATE_COUNT);
    return run_state_words[state];
}

bool run_state_may_follow(run_state from, run_state to)
{
    BF_CHECK(from < RUN_STATE_COUNT && to < RUN_STATE_COUNT);
    return (next_states[from] & RUN_TO(to)) != 0;
}

bool run_state_is_end(run_state state)
{
    BF_CHECK(state < RUN_STATE_COUNT);
    return next_states[state] == 0;
}
