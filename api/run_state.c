#include "api/run_state.h"

#include "core/base/check.h"

#include <string.h>

static const struct {
    const char *word;
    unsigned next;
} states[] = {
#define X(state, word, next) [state] = { word, next },
    RUN_STATE_LIST(X)
#undef X
};

const char *run_state_word(run_state state)
{
    BF_CHECK(state < RUN_STATE_COUNT);
    return states[state].word;
}

run_state run_state_find(const char *word)
{
    unsigned state = 0;

    while (state < RUN_STATE_COUNT && strcmp(states[state].word, word) != 0)
        state++;
    return (run_state)state;
}

bool run_state_may_follow(run_state from, run_state to)
{
    BF_CHECK(from < RUN_STATE_COUNT && to < RUN_STATE_COUNT);
    return (states[from].next & RUN_TO(to)) != 0;
}

bool run_state_is_end(run_state state)
{
    BF_CHECK(state < RUN_STATE_COUNT);
    return states[state].next == 0;
}
