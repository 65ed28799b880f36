// What workers bring: bytes of frames, signs of life, and ends.

#include "server/pull/pull_priv.h"

#include "core/base/memory.h"
#include "server/base/clock.h"

#include <math.h>
#include <string.h>

// What is answered, while a lease is looked at.
typedef struct answer {
    api_job_states states;
    bool is_named[API_LEASE_JOBS_MAX];
} answer;

static bf_status begin_answer(answer *a, size_t n, bf_error *err)
{
    *a = (answer){ .states = { .items = memory_alloc(n, sizeof *a->states.items) } };
    return a->states.items != NULL ? BF_OK : bf_fail_memory(err);
}

static void add_state(answer *a, uint32_t number, uint64_t next, api_job_stop stop)
{
    a->states.items[a->states.n++] = (api_job_state){ .job = number, .next = next, .stop = stop };
}

static executor_job *job_at(const pull__lease *lease, uint32_t number)
{
    return lease != NULL && number < lease->n_jobs ? lease->jobs[number] : NULL;
}

// The jobs that were named, and those of which something is asked.
static void answer_named(answer *a, const pull__lease *lease)
{
    for (uint32_t k = 0; k < API_LEASE_JOBS_MAX; k++) {
        const executor_job *job = job_at(lease, k);
        if (job != NULL && (a->is_named[k] || job->stop != API_JOB_GO_ON))
            add_state(a, k, job->n_received, job->stop);
        else if (job == NULL && a->is_named[k])
            add_state(a, k, 0, API_JOB_GONE);
    }
}

static void note_begin(executor_job *job)
{
    job->has_begun = true;
    if (job->check == NULL)
        buffer_fini(&job->input);
}

// Take what is new of a section and has room. Without memory nothing is taken, and the worker tries again.
static void take_section(pull_executor *e, pull__lease *lease, executor_job *job,
                         const api_lease_section *section)
{
    const uint64_t end = section->offset + section->n;

    if (section->offset > job->n_received || end <= job->n_received)
        return;
    const size_t skip = (size_t)(job->n_received - section->offset);
    const size_t of_job = PULL_JOB_BYTES_MAX - job->bytes.n, of_all = PULL_BYTES_MAX - e->n_bytes;
    const size_t room = of_job < of_all ? of_job : of_all;
    const size_t n = section->n - skip < room ? section->n - skip : room;
    const char *bytes = (const char *)section->bytes + skip;
    if (n == 0 || (!job->is_repetition && buffer_append(&job->bytes, bytes, n) != BF_OK))
        return;
    note_begin(job);
    pull__check_bytes(job->check, bytes, n);
    job->n_received += n;
    e->n_bytes += job->is_repetition ? 0 : n;
    lease->n_bytes += n;
}

bf_status pull__deliver(void *context, uint64_t token, const char *id,
                        const api_lease_section *sections, size_t n, api_job_states *ret_states,
                        bf_error *err)
{
    pull_executor *e = pull__enter(context);
    pull__lease *lease = pull__hear(e, token, id);
    answer a;

    bf_status status = lease == NULL ? bf_fail(err, BF_ENOTFOUND, "", "there is no lease '%s'", id)
                                     : begin_answer(&a, API_LEASE_JOBS_MAX, err);
    if (status == BF_OK) {
        for (size_t k = 0; k < n; k++) {
            executor_job *job = job_at(lease, sections[k].job);
            a.is_named[sections[k].job] = true;
            if (job != NULL)
                take_section(e, lease, job, &sections[k]);
        }
        answer_named(&a, lease);
        *ret_states = a.states;
        pull__wake(e);
    }
    lock_release(&e->lock);
    return status;
}

// The most CPU time that a job can have used: that of its threads since it was leased. One of the daemon before was
// leased behind the time that its attempt is counted from, by a worker of any size.
static double most_cpu_s(const executor_job *job)
{
    const double slack_s = 1.0;

    if (!job->is_adopted)
        return job->about.n_threads *
               (slack_s + 1e-3 * (double)(clock_monotonic_ms() - job->leased_ms));
    const int64_t since_ms = (int64_t)(job->about.attempt % INT64_MAX);
    const int64_t passed_ms = clock_unix_ms() - since_ms;
    return passed_ms > 0 ? API_WORKER_CORES * (slack_s + 1e-3 * (double)passed_ms) : 0.0;
}

// The job that a worker means, if it is still its own.
static executor_job *take_report(answer *a, const pull__lease *lease, const api_job_report *report)
{
    executor_job *job = job_at(lease, report->job);

    a->is_named[report->job] = true;
    if (job == NULL || job->about.attempt != report->attempt ||
        strcmp(job->about.run, report->run) != 0)
        return NULL;
    job->used_s = fmax(job->used_s, fmin(report->cpu_s, most_cpu_s(job)));
    if (report->cpu_s > 0.0)
        note_begin(job);
    return job;
}

// An end counts when all that it is the end of has come; until then the worker says it again.
static void take_end(pull_executor *e, answer *a, const pull__lease *lease, const char *worker,
                     const api_job_end *end)
{
    executor_job *job = take_report(a, lease, &end->report);

    if (job == NULL) {
        pull__compare_end(e, worker, end);
        return;
    }
    if (job->n_received < end->n_bytes)
        return;
    job->end = (executor_end){ .cause = end->cause, .error = end->error };
    if (end->error.code == BF_OK)
        (void)bf_fail(&job->end.error, BF_ESYSTEM, "",
                      "the solver ended before the end of the run");
    if (end->cause == API_JOB_EXITED)
        pull__check_end(e, job);
    pull__note_end(e, worker, end);
    if (e->predictor != NULL && job->study[0] != '\0' && end->cause == API_JOB_EXITED)
        predictor_learn(e->predictor, job->study, job->used_s);
    a->is_named[end->report.job] = false;
    add_state(a, end->report.job, job->n_received, API_JOB_GO_ON);
    pull__move(e, job, PULL_ENDED);
}

static size_t count_places(const api_renewal *renewal)
{
    uint32_t last = 0;

    for (size_t k = 0; k < renewal->n_jobs; k++)
        last = renewal->jobs[k].job > last ? renewal->jobs[k].job : last;
    for (size_t k = 0; k < renewal->n_ended; k++)
        last = renewal->ended[k].report.job > last ? renewal->ended[k].report.job : last;
    return last + 1;
}

static bf_status adopt_job(pull_executor *e, const char *id, const api_renewal *renewal,
                           const api_job_report *report, pull__lease **lease, bf_error *err)
{
    executor_job *job;

    TAILQ_FOREACH(job, &e->jobs, entry)
        if (job->place == PULL_AWAITED && job->about.attempt == report->attempt &&
            strcmp(job->about.run, report->run) == 0)
            break;
    if (job == NULL)
        return BF_OK;
    if (*lease == NULL)
        BF_TRY(pull__begin_lease(e, id, renewal->token, renewal->worker, count_places(renewal),
                                 lease, err));
    if ((*lease)->jobs[report->job] == NULL) {
        pull__put(e, *lease, report->job, job);
        job->is_adopted = true;
    }
    return BF_OK;
}

// A lease of the daemon before: what waits for its worker is in it. NULL: nothing does.
static bf_status adopt(pull_executor *e, const char *id, const api_renewal *renewal,
                       pull__lease **lease, bf_error *err)
{
    for (size_t k = 0; k < renewal->n_jobs; k++)
        BF_TRY(adopt_job(e, id, renewal, &renewal->jobs[k], lease, err));
    for (size_t k = 0; k < renewal->n_ended; k++)
        BF_TRY(adopt_job(e, id, renewal, &renewal->ended[k].report, lease, err));
    return BF_OK;
}

static bf_status renew(pull_executor *e, const char *id, const api_renewal *renewal, answer *a,
                       bf_error *err)
{
    pull__lease *lease = pull__hear(e, renewal->token, id);
    const bool is_known = lease != NULL;

    BF_TRY(is_known ? BF_OK : adopt(e, id, renewal, &lease, err));
    for (size_t k = 0; k < renewal->n_jobs; k++)
        (void)take_report(a, lease, &renewal->jobs[k]);
    for (size_t k = 0; k < renewal->n_ended; k++)
        take_end(e, a, lease, renewal->worker, &renewal->ended[k]);
    // What a worker has and does not name any more it has forgotten.
    for (uint32_t k = 0; is_known && k < lease->n_jobs; k++)
        if (lease->jobs[k] != NULL && !a->is_named[k])
            pull__lose_job(e, lease->jobs[k], "forgotten");
    answer_named(a, lease);
    if (lease != NULL && lease->n_open == 0)
        pull__end_lease(e, lease);
    pull__wake(e);
    return BF_OK;
}

bf_status pull__renew(void *context, const char *id, const api_renewal *renewal,
                      api_job_states *ret_states, bf_error *err)
{
    answer a;

    BF_TRY(pull__check_version(renewal->worker, renewal->solver, err));
    BF_TRY(begin_answer(&a, API_LEASE_JOBS_MAX + renewal->n_ended, err));
    pull_executor *e = pull__enter(context);
    bf_status status = renew(e, id, renewal, &a, err);
    lock_release(&e->lock);
    if (status == BF_OK)
        *ret_states = a.states;
    else
        memory_free(a.states.items);
    return status;
}
