// Failures that only one worker has seen. A solver says the same of a run wherever it runs, so the second attempt shows
// whether the run is at fault or who solved it.

#include "server/pull/pull_priv.h"

#include "server/base/clock.h"

#include <string.h>

static size_t count_noted(const pull_executor *e)
{
    return e->n_doubts < PULL_DOUBTS_KEPT ? e->n_doubts : PULL_DOUBTS_KEPT;
}

bool pull__confirm_failure(pull_executor *e, const executor_job *job, const bf_error *why)
{
    pull__doubt *noted = &e->doubts[e->n_doubts % PULL_DOUBTS_KEPT];

    lock_assert_held(&e->lock);
    for (size_t k = 0; k < count_noted(e); k++) {
        const pull__doubt *other = &e->doubts[k];
        if (strcmp(other->run, job->about.run) == 0 && other->attempt != job->about.attempt &&
            strcmp(other->why.text, why->text) == 0)
            return true;
    }
    *noted = (pull__doubt){ .attempt = job->about.attempt, .token = job->token, .why = *why };
    memcpy(noted->run, job->about.run, sizeof noted->run);
    memcpy(noted->worker, job->worker, sizeof noted->worker);
    e->n_doubts++;
    return false;
}

void pull__refute_failures(pull_executor *e, const executor_job *job)
{
    lock_assert_held(&e->lock);
    for (size_t k = 0; k < count_noted(e); k++) {
        pull__doubt *other = &e->doubts[k];
        if (strcmp(other->run, job->about.run) != 0)
            continue;
        pull__attribute_fault(e, other->run, other->token, other->worker, other->why.text);
        other->run[0] = '\0';
    }
}

// Whether there is a worker of another token, or, with this one's token, of another name.
static bool has_others(const pull_executor *e, uint64_t token, const char *name)
{
    const int64_t now_ms = clock_monotonic_ms();

    for (size_t k = 0; k < e->n_workers; k++) {
        const pull__worker *w = &e->workers[k];
        const bool is_other =
            w->about.token != token || (name != NULL && strcmp(w->about.name, name) != 0);
        if (is_other && w->suspended_until_ms <= now_ms)
            return true;
    }
    return false;
}

bool pull__may_have(const pull_executor *e, const executor_job *job, const api_worker *who)
{
    lock_assert_held(&e->lock);
    if (job->is_repetition)
        return !pull__is_witness(job->check, who->token);
    if (clock_monotonic_ms() >= job->started_ms + PULL_OTHERS_FIRST_MS)
        return true;
    for (size_t k = 0; k < count_noted(e); k++) {
        const pull__doubt *of = &e->doubts[k];
        if (of->token != who->token || strcmp(of->run, job->about.run) != 0)
            continue;
        if (has_others(e, of->token, NULL) ||
            (strcmp(of->worker, who->name) == 0 && has_others(e, of->token, of->worker)))
            return false;
    }
    return true;
}
