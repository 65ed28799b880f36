#include "api/studies.h"

#include "core/base/check.h"

const char *const api_study_state_words[API_STUDY_STATES + 1] = {
#define X(state, word, is_end) word,
    API_STUDY_STATE_LIST(X)
#undef X
};

const char *const api_trial_state_words[API_TRIAL_STATES + 1] = {
#define X(state, word, is_end) word,
    API_TRIAL_STATE_LIST(X)
#undef X
};

static const bool studies_end[] = {
#define X(state, word, is_end) is_end,
    API_STUDY_STATE_LIST(X)
#undef X
};

static const bool trials_end[] = {
#define X(state, word, is_end) is_end,
    API_TRIAL_STATE_LIST(X)
#undef X
};

const char *api_study_state_word(api_study_state state)
{
    BF_CHECK(state < API_STUDY_STATES);
    return api_study_state_words[state];
}

const char *api_trial_state_word(api_trial_state state)
{
    BF_CHECK(state < API_TRIAL_STATES);
    return api_trial_state_words[state];
}

bool api_study_state_is_end(api_study_state state)
{
    BF_CHECK(state < API_STUDY_STATES);
    return studies_end[state];
}

bool api_trial_state_is_end(api_trial_state state)
{
    BF_CHECK(state < API_TRIAL_STATES);
    return trials_end[state];
}

uint64_t api_study_ended(const api_study *about)
{
    uint64_t n = 0;

    for (api_trial_state state = 0; state < API_TRIAL_STATES; state++)
        n += about->n_ended[state];
    return n;
}
