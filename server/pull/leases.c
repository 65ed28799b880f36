// Leases: which worker has which jobs, from the asking to the end or the silence.

#include "server/pull/pull_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/run_id.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum {
    IDLE_WORKERS_A_SECOND = 64, // that ask again without getting anything
};

// Jobs that a worker gets.
typedef struct batch {
    size_t n;
    executor_job *jobs[API_LEASE_JOBS_MAX];
    uint64_t n_bytes;
    double predicted_s;     // of all that are known
    uint32_t n_run_cores;   // of runs by themselves, also those that the worker has
    uint32_t n_trials;      // in the batch
    uint32_t n_trials_held; // that the worker has
    uint64_t memory_bytes;  // that runs by themselves may use, also those that the worker has
} batch;

bf_status pull__begin_lease(pull_executor *e, const char *id, uint64_t token, const char *worker,
                            size_t n, pull__lease **ret_lease, bf_error *err)
{
    const int64_t now_ms = clock_monotonic_ms();

    if (e->n_leases == API_LEASES_MAX)
        return bf_fail(err, BF_EBUSY, "", "there are %d leases, as many as may be", API_LEASES_MAX);
    pull__lease *lease = memory_alloc(1, sizeof *lease);
    executor_job **jobs = memory_alloc(n, sizeof(executor_job *));
    if (lease == NULL || jobs == NULL) {
        memory_free(lease);
        memory_free(jobs);
        return bf_fail_memory(err);
    }
    *lease = (pull__lease){
        .begun_ms = now_ms, .seen_ms = now_ms, .n_jobs = n, .jobs = jobs, .token = token
    };
    snprintf(lease->id, sizeof lease->id, "%s", id);
    snprintf(lease->worker, sizeof lease->worker, "%s", worker);
    e->leases[e->n_leases++] = lease;
    log_event(LOG_LEVEL_INFO, "lease_begun", "lease=%s worker=%s jobs=%zu", id, worker, n);
    *ret_lease = lease;
    return BF_OK;
}

void pull__put(pull_executor *e, pull__lease *lease, size_t place, executor_job *job)
{
    BF_CHECK(place < lease->n_jobs && lease->jobs[place] == NULL && job->lease == NULL);
    pull__move(e, job, PULL_LEASED);
    lease->jobs[place] = job;
    lease->n_open++;
    job->lease = lease;
    job->about.job = (uint32_t)place;
    job->token = lease->token;
    job->leased_ms = clock_monotonic_ms();
    memcpy(job->worker, lease->worker, sizeof job->worker);
}

pull__lease *pull__hear(pull_executor *e, uint64_t token, const char *id)
{
    const int64_t now_ms = clock_monotonic_ms();

    lock_assert_held(&e->lock);
    for (size_t k = 0; k < e->n_leases; k++) {
        pull__lease *lease = e->leases[k];
        if (lease->token != token || strcmp(lease->id, id) != 0)
            continue;
        pull__worker *worker = pull__find_worker(e, lease->token, lease->worker);
        if (worker != NULL)
            worker->seen_ms = now_ms;
        lease->seen_ms = now_ms;
        return lease;
    }
    return NULL;
}

void pull__end_lease(pull_executor *e, pull__lease *lease)
{
    BF_CHECK(lease->n_open == 0);
    log_event(LOG_LEVEL_INFO, "lease_ended",
              "lease=%s worker=%s jobs=%zu done=%zu bytes=%" PRIu64 " s=%.1f", lease->id,
              lease->worker, lease->n_jobs, lease->n_done, lease->n_bytes,
              1e-3 * (double)(clock_monotonic_ms() - lease->begun_ms));
    for (size_t k = 0; k < e->n_leases; k++) {
        if (e->leases[k] == lease)
            e->leases[k--] = e->leases[--e->n_leases];
    }
    memory_free(lease->jobs);
    memory_free(lease);
}

void pull__lose_job(pull_executor *e, executor_job *job, const char *why)
{
    metrics_add(METRICS_PULL_LOST, 0, 1);
    log_event(LOG_LEVEL_WARN, "job_lost", "run=%s attempt=%" PRIu64 " worker=%s why=%s",
              job->about.run, job->about.attempt, job->worker, why);
    const bool has_begun = job->has_begun || job->place != PULL_LEASED;
    if (!has_begun) {
        job->end.cause = API_JOB_STOPPED;
        (void)bf_fail(&job->end.error, BF_ESYSTEM, "", "worker %s had the run and did not begin it",
                      job->worker);
    }
    pull__move(e, job, has_begun ? PULL_LOST : PULL_ENDED);
}

void pull__lose_lease(pull_executor *e, pull__lease *lease, const char *why)
{
    for (size_t k = 0; k < lease->n_jobs; k++)
        if (lease->jobs[k] != NULL)
            pull__lose_job(e, lease->jobs[k], why);
    pull__end_lease(e, lease);
}

// A run by itself begins at once where it is leased; trials wait for those before them.
static bool is_held(const executor_job *job, int64_t now_ms)
{
    const int64_t most_ms = job->about.is_trial ? PULL_BEGIN_TRIAL_MS : PULL_BEGIN_MS;

    return job->place == PULL_LEASED && !job->has_begun && now_ms >= job->leased_ms + most_ms;
}

void pull__expire(pull_executor *e, int64_t now_ms)
{
    lock_assert_held(&e->lock);
    for (size_t k = e->n_leases; k > 0; k--)
        if (now_ms >= e->leases[k - 1]->seen_ms + API_LEASE_EXPIRES_S * 1000)
            pull__lose_lease(e, e->leases[k - 1], "silent");
        else if (e->leases[k - 1]->n_open == 0)
            pull__end_lease(e, e->leases[k - 1]);
    executor_job *job;
    TAILQ_FOREACH(job, &e->jobs, entry) {
        if (job->place == PULL_AWAITED && now_ms >= job->until_ms)
            pull__lose_job(e, job, "restart");
        else if (is_held(job, now_ms)) {
            pull__attribute_fault(e, job->about.run, job->token, job->worker,
                                  "it renews the lease of a run that it does not begin");
            pull__lose_job(e, job, "not_begun");
        }
    }
    pull__drop_workers(e, now_ms);
}

// A run by itself begins at once, so it needs free cores, and memory as much as it may use; trials are short, and some of
// them wait at the worker. One run any worker gets: what it may use is more than most use.
static bool fits(const batch *b, const executor_job *job, const api_worker *who)
{
    const api_lease_job *about = &job->about;
    const uint32_t n_cores = who->cores;
    const uint32_t n_free = b->n_run_cores < n_cores ? n_cores - b->n_run_cores : 0;

    if (b->n > 0 && b->n_bytes + about->n_bytes > PULL_BATCH_BYTES)
        return false;
    if (!about->is_trial)
        return b->n_run_cores == 0 ||
               (about->n_threads <= n_free &&
                (who->memory_bytes == 0 ||
                 b->memory_bytes + about->memory_bytes <= who->memory_bytes));
    return b->n_trials < PULL_TRIALS_A_CORE * n_free &&
           b->n_trials + b->n_trials_held < 2 * PULL_TRIALS_A_CORE * n_free &&
           (b->n_trials < n_free || b->predicted_s < PULL_BATCH_S * (double)n_free);
}

static void add_waiting(batch *b, const pull_executor *e, bool is_trial, const api_worker *who)
{
    executor_job *job;

    TAILQ_FOREACH(job, &e->jobs, entry) {
        if (job->place != PULL_WAITING || job->about.is_trial != is_trial ||
            !pull__may_have(e, job, who))
            continue;
        job->about.predicted_s = pull__predict(e, job);
        if (b->n == API_LEASE_JOBS_MAX || !fits(b, job, who))
            return;
        b->jobs[b->n++] = job;
        b->n_bytes += job->about.n_bytes;
        b->predicted_s += job->about.predicted_s > 0.0 ? job->about.predicted_s : 0.0;
        b->memory_bytes += is_trial ? 0 : job->about.memory_bytes;
        b->n_run_cores += is_trial ? 0 : job->about.n_threads;
        b->n_trials += is_trial;
    }
}

static bf_status make_lease(pull_executor *e, const api_worker *who, const batch *b,
                            api_lease *ret_lease, bf_error *err)
{
    api_lease made = { .n_jobs = b->n, .jobs = memory_alloc(b->n, sizeof *made.jobs) };
    pull__lease *lease;

    bf_status status = made.jobs == NULL ? bf_fail_memory(err) : run_id_make(made.id, err);
    if (status == BF_OK)
        status = pull__begin_lease(e, made.id, who->token, who->name, b->n, &lease, err);
    if (status != BF_OK) {
        api_lease_fini(&made);
        return status;
    }
    for (size_t k = 0; k < b->n; k++) {
        pull__put(e, lease, k, b->jobs[k]);
        made.jobs[k] = b->jobs[k]->about;
    }
    *ret_lease = made;
    return BF_OK;
}

bf_status pull__lease_jobs(void *context, const api_worker *who, api_lease *ret_lease,
                           bf_error *err)
{
    pull_executor *e = pull__enter(context);
    pull__worker *worker = NULL;
    batch b = { .n = 0 };

    bf_status status = pull__meet_worker(e, who, &worker, err);
    if (status == BF_OK && worker->suspended_until_ms <= clock_monotonic_ms()) {
        // What the worker has already counts.
        const executor_job *job;
        TAILQ_FOREACH(job, &e->jobs, entry) {
            if (job->place != PULL_LEASED || !pull__is_of(job->lease, who->token, who->name))
                continue;
            b.memory_bytes += job->about.is_trial ? 0 : job->about.memory_bytes;
            b.n_run_cores += job->about.is_trial ? 0 : job->about.n_threads;
            b.n_trials_held += job->about.is_trial;
        }
        add_waiting(&b, e, false, who);
        add_waiting(&b, e, true, who);
    }
    if (status == BF_OK && b.n > 0)
        status = make_lease(e, who, &b, ret_lease, err);
    else if (status == BF_OK)
        *ret_lease = (api_lease){ .retry_s = 1 + (uint32_t)(e->n_workers / IDLE_WORKERS_A_SECOND) };
    pull__wake(e); // a new worker is room for further jobs
    lock_release(&e->lock);
    return status;
}

static bf_status fail_unknown(const char *id, bf_error *err)
{
    return bf_fail(err, BF_ENOTFOUND, "", "there is no lease '%s'", id);
}

static bf_status read_input(const pull__lease *lease, bf_buffer *out, bf_error *err)
{
    const size_t n_before = out->n;

    for (size_t k = 0; k < lease->n_jobs; k++) {
        const executor_job *job = lease->jobs[k];
        bf_status status = BF_OK;
        if (job == NULL || job->has_begun)
            status = bf_fail(err, BF_ECONFLICT, "", "job %zu of the lease has begun or is gone", k);
        else if (buffer_append(out, job->input.bytes, job->input.n) != BF_OK)
            status = bf_fail_memory(err);
        if (status != BF_OK) {
            buffer_truncate(out, n_before);
            return status;
        }
    }
    return BF_OK;
}

bf_status pull__read_jobs(void *context, uint64_t token, const char *id, bf_buffer *out,
                          bf_error *err)
{
    pull_executor *e = pull__enter(context);
    const pull__lease *lease = pull__hear(e, token, id);

    bf_status status = lease == NULL ? fail_unknown(id, err) : read_input(lease, out, err);
    lock_release(&e->lock);
    return status;
}

// A worker without a lease has left altogether: nothing is claimed for it.
bf_status pull__leave(void *context, uint64_t token, const char *id, bf_error *err)
{
    pull_executor *e = pull__enter(context);
    pull__lease *lease = pull__hear(e, token, id);
    bf_status status = BF_OK;

    if (lease == NULL) {
        status = fail_unknown(id, err);
    } else {
        pull__worker *worker = pull__find_worker(e, lease->token, lease->worker);
        pull__lose_lease(e, lease, "left");
        if (worker != NULL)
            worker->seen_ms -= API_LEASE_EXPIRES_S * 1000;
        pull__drop_workers(e, clock_monotonic_ms());
    }
    pull__wake(e);
    lock_release(&e->lock);
    return status;
}
