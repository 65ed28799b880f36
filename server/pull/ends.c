// Ends of attempts. A worker that was thought lost may end a run that another has ended meanwhile: the same run has the
// same results on every machine, so a difference between the two is an alarm.

#include "server/pull/pull_priv.h"

#include "server/base/log.h"

#include <string.h>

void pull__note_end(pull_executor *e, const char *worker, const api_job_end *end)
{
    pull__end *noted = &e->ends[e->n_ends % PULL_ENDS_KEPT];

    lock_assert_held(&e->lock);
    if (end->cause != API_JOB_EXITED || end->digest[0] == '\0')
        return;
    *noted = (pull__end){ .attempt = end->report.attempt };
    memcpy(noted->run, end->report.run, sizeof noted->run);
    memcpy(noted->digest, end->digest, sizeof noted->digest);
    strncpy(noted->worker, worker, sizeof noted->worker - 1);
    e->n_ends++;
}

void pull__compare_end(const pull_executor *e, const char *worker, const api_job_end *end)
{
    const size_t n = e->n_ends < PULL_ENDS_KEPT ? e->n_ends : PULL_ENDS_KEPT;

    lock_assert_held(&e->lock);
    for (size_t k = 0; k < n && end->cause == API_JOB_EXITED && end->digest[0] != '\0'; k++) {
        const pull__end *other = &e->ends[k];
        if (other->attempt == end->report.attempt || strcmp(other->run, end->report.run) != 0)
            continue;
        const bool is_equal = strcmp(other->digest, end->digest) == 0;
        metrics_add(METRICS_PULL_DUPLICATES, is_equal ? METRICS_MATCH_EQUAL : METRICS_MATCH_UNEQUAL,
                    1);
        if (!is_equal)
            log_event(LOG_LEVEL_ERROR, "duplicate_unequal",
                      "run=%s worker=%s digest=%s first_worker=%s first_digest=%s", end->report.run,
                      worker, end->digest, other->worker, other->digest);
        return;
    }
}
