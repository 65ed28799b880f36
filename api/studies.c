#include "api/studies.h"

#include "core/base/check.h"

#include <string.h>

// Of studies and of trials.
typedef struct state_row {
    const char *word;
    bool is_end;
} state_row;

static const state_row studies[] = {
#define X(state, word, is_end) [state] = { word, is_end },
    API_STUDY_STATE_LIST(X)
#undef X
};

static const state_row trials[] = {
#define X(state, word, is_end) [state] = { word, is_end },
    API_TRIAL_STATE_LIST(X)
#undef X
};

const char *api_study_state_word(api_study_state state)
{
    BF_CHECK(state < API_STUDY_STATES);
    return studies[state].word;
}

const char *api_trial_state_word(api_trial_state state)
{
    BF_CHECK(state < API_TRIAL_STATES);
    return trials[state].word;
}

api_study_state api_study_state_find(const char *word)
{
    unsigned state = 0;

    while (state < API_STUDY_STATES && strcmp(studies[state].word, word) != 0)
        state++;
    return (api_study_state)state;
}

bool api_study_state_is_end(api_study_state state)
{
    BF_CHECK(state < API_STUDY_STATES);
    return studies[state].is_end;
}

bool api_trial_state_is_end(api_trial_state state)
{
    BF_CHECK(state < API_TRIAL_STATES);
    return trials[state].is_end;
}

uint64_t api_study_ended(const api_study *about)
{
    uint64_t n = 0;

    for (api_trial_state state = 0; state < API_TRIAL_STATES; state++)
        n += about->n_ended[state];
    return n;
}
