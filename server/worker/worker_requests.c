// Requests: which comes next, and what its answer means.

#include "api/results/lease_json.h"
#include "core/base/memory.h"
#include "server/base/log.h"
#include "server/worker/worker_priv.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum {
    SEND_MS = 250,
    SEND_BYTES = 256 * 1024,    // are sent at once
    SECTION_BYTES = SEND_BYTES, // of a job in a request, so that one does not keep others waiting
    SECTION_HEADER = 16,
    REQUEST_BYTES = 1000 * 1024, // of frames with their headers, unless the service lets fewer
    PAUSE_MS = 100,
    RENEW_MS = API_LEASE_RENEW_S * 1000,
    BACKOFF_LEAST_MS = 500,
    BACKOFF_MOST_MS = 10000,
    ASK_LEAST_MS = 200,
    ASK_MOST_MS = 20000,
    ANSWER_BYTES = 4 * 1024 * 1024,
};

static bool is_over(const worker_lease *lease)
{
    for (size_t k = 0; k < lease->n_jobs; k++)
        if (lease->jobs[k].state != WORKER_JOB_OVER)
            return false;
    return true;
}

// All frames of a job that has ended were taken; its end was not told.
static bool is_delivered(const worker_job *job)
{
    return job->state == WORKER_JOB_ENDED && job->n_taken == job->n_spooled;
}

static bool has_frames_to_send(const worker_lease *lease, int64_t now)
{
    uint64_t n = 0;
    bool has_ended = false;

    for (size_t k = 0; k < lease->n_jobs; k++) {
        const worker_job *job = &lease->jobs[k];
        n += job->n_spooled - job->n_taken;
        has_ended = has_ended || (job->state == WORKER_JOB_ENDED && !is_delivered(job));
    }
    return n > 0 && now >= lease->pause_ms &&
           (has_ended || n >= SEND_BYTES || now - lease->sent_ms >= SEND_MS);
}

// ---- bodies

static size_t request_bytes(const worker *w)
{
    return w->request_bytes > 0 && w->request_bytes < REQUEST_BYTES ? w->request_bytes
                                                                    : REQUEST_BYTES;
}

static bf_status append_section(worker *w, const worker_job *job, bf_error *err)
{
    static char bytes[SECTION_BYTES]; // one thread
    const uint64_t n_left = job->n_spooled - job->n_taken;
    const size_t n_room = request_bytes(w) - SECTION_HEADER - w->body.n;
    size_t n = n_left < SECTION_BYTES ? (size_t)n_left : SECTION_BYTES;

    n = n < n_room ? n : n_room;
    if (pread(job->spool, bytes, n, (off_t)job->n_taken) != (ssize_t)n)
        return bf_fail(err, BF_ESYSTEM, "", "the spool cannot be read");
    w->sent_to[job->about.job] = job->n_taken + n;
    return lease_json_write_section(
        &(api_lease_section){
            .job = job->about.job, .offset = job->n_taken, .n = n, .bytes = bytes },
        &w->body, err);
}

static bf_status write_frames(worker *w, worker_lease *lease, int64_t now, bf_error *err)
{
    memset(w->sent_to, 0, sizeof w->sent_to);
    lease->sent_ms = now;
    for (size_t k = 0; k < lease->n_jobs; k++)
        if (lease->jobs[k].n_taken < lease->jobs[k].n_spooled &&
            w->body.n + SECTION_HEADER < request_bytes(w))
            BF_TRY(append_section(w, &lease->jobs[k], err));
    return BF_OK;
}

static bf_status write_renewal(worker *w, worker_lease *lease, bf_error *err)
{
    api_renewal renewal = { .jobs = memory_alloc(lease->n_jobs, sizeof *renewal.jobs),
                            .ended = memory_alloc(lease->n_jobs, sizeof *renewal.ended) };
    bf_status status = BF_ENOMEM;

    if (renewal.jobs == NULL || renewal.ended == NULL) {
        (void)bf_fail(err, BF_ENOMEM, "", "no memory for a renewal");
    } else {
        memcpy(renewal.worker, w->options->who.name, sizeof renewal.worker);
        memcpy(renewal.solver, w->options->who.solver, sizeof renewal.solver);
        for (size_t k = 0; k < lease->n_jobs; k++) {
            worker_job *job = &lease->jobs[k];
            if (job->state == WORKER_JOB_RUNS)
                job->used_s = w->solver->functions->cpu_s(w->solver, job->child);
            api_job_report report = { .job = job->about.job,
                                      .attempt = job->about.attempt,
                                      .cpu_s = job->used_s };
            memcpy(report.run, job->about.run, sizeof report.run);
            w->is_ended[k] = is_delivered(job);
            if (job->state == WORKER_JOB_OVER)
                continue;
            api_job_end end = { .report = report,
                                .cause = job->end.cause,
                                .error = job->end.error,
                                .n_bytes = job->n_spooled };
            memcpy(end.digest, job->digest, sizeof end.digest);
            if (w->is_ended[k])
                renewal.ended[renewal.n_ended++] = end;
            else
                renewal.jobs[renewal.n_jobs++] = report;
        }
        status = lease_json_write_renewal(&renewal, &w->body, err);
    }
    api_renewal_fini(&renewal);
    return status;
}

// ---- what comes next

static worker_request choose_for(const worker_lease *lease, int64_t now)
{
    if (is_over(lease))
        return WORKER_REQUEST_LEAVE;
    if (lease->must_renew || now - lease->renewed_ms >= RENEW_MS)
        return WORKER_REQUEST_RENEW;
    if (!lease->has_input)
        return WORKER_REQUEST_JOBS;
    if (has_frames_to_send(lease, now))
        return WORKER_REQUEST_FRAMES;
    for (size_t k = 0; k < lease->n_jobs; k++)
        if (is_delivered(&lease->jobs[k]))
            return WORKER_REQUEST_RENEW; // its end is to be told
    return WORKER_REQUEST_NONE;
}

static worker_request choose(worker *w, int64_t now, worker_lease **ret_about)
{
    *ret_about = NULL;
    for (size_t l = 0; l < WORKER_LEASES; l++) {
        worker_lease *lease = &w->leases[l];
        if (lease->id[0] != '\0' && is_over(lease) && !lease->must_leave)
            worker__end_lease(w, lease);
        const worker_request next =
            lease->id[0] == '\0' ? WORKER_REQUEST_NONE : choose_for(lease, now);
        if (next == WORKER_REQUEST_NONE)
            continue;
        *ret_about = lease;
        return next;
    }
    return !w->is_leaving && now >= w->ask_ms && worker__wants_jobs(w) ? WORKER_REQUEST_LEASE
                                                                       : WORKER_REQUEST_NONE;
}

static bf_status write_body(worker *w, worker_request request, worker_lease *about, int64_t now,
                            bf_error *err)
{
    switch (request) {
    case WORKER_REQUEST_LEASE:
        return lease_json_write_worker(&w->options->who, &w->body, err);
    case WORKER_REQUEST_FRAMES:
        return write_frames(w, about, now, err);
    case WORKER_REQUEST_RENEW:
        return write_renewal(w, about, err);
    default:
        return BF_OK;
    }
}

static bf_status begin(worker *w, worker_request next, worker_lease *about, int64_t now,
                       bf_error *err)
{
    static const struct {
        const char *method;
        const char *path; // after the lease
        const char *type;
    } forms[] = {
        [WORKER_REQUEST_LEASE] = { "POST", "", "application/json" },
        [WORKER_REQUEST_JOBS] = { "GET", "/jobs", NULL },
        [WORKER_REQUEST_FRAMES] = { "PUT", "/frames", "application/octet-stream" },
        [WORKER_REQUEST_RENEW] = { "POST", "/renew", "application/json" },
        [WORKER_REQUEST_LEAVE] = { "DELETE", "", NULL },
    };
    char path[128];

    w->body.n = 0;
    BF_TRY(write_body(w, next, about, now, err));
    snprintf(path, sizeof path, "/v1/leases%s%s%s", about == NULL ? "" : "/",
             about == NULL ? "" : about->id, forms[next].path);
    http_call_request request = { .method = forms[next].method,
                                  .path = path,
                                  .type = forms[next].type,
                                  .body = w->body.bytes,
                                  .n_body = w->body.n,
                                  .n_most = ANSWER_BYTES };
    if (next == WORKER_REQUEST_JOBS) {
        const worker_job *last = &about->jobs[about->n_jobs - 1];
        request.n_most += last->at + (size_t)last->about.n_bytes;
    }
    return http_call_begin(w->call, &request, err);
}

void worker__ask(worker *w, int64_t now)
{
    bf_error why = { 0 };

    if (w->request != WORKER_REQUEST_NONE || now < w->retry_ms)
        return;
    const worker_request next = choose(w, now, &w->about);
    if (next == WORKER_REQUEST_NONE)
        return;
    if (begin(w, next, w->about, now, &why) == BF_OK) {
        w->request = next;
        return;
    }
    worker__fail(w, &why);
    w->must_end = true;
}

// ---- answers

static void end_at_once(worker *w, const bf_error *why)
{
    worker__fail(w, why);
    w->must_end = true;
}

// Nothing more is done for a lease; the daemon is told.
static void abandon(worker *w, worker_lease *lease, const bf_error *why)
{
    char quoted[LOG_QUOTED_SIZE];

    log_event(LOG_LEVEL_WARN, "lease_abandoned", "lease=%s error=%s", lease->id,
              log_quote(why->text, quoted));
    for (size_t k = 0; k < lease->n_jobs; k++)
        worker__drop_job(w, &lease->jobs[k]);
    lease->must_leave = true;
}

static void take_state(worker *w, worker_lease *lease, const api_job_state *state, int64_t now)
{
    worker_job *job = state->job < lease->n_jobs ? &lease->jobs[state->job] : NULL;

    if (job == NULL || job->state == WORKER_JOB_OVER)
        return;
    job->n_taken = state->next < job->n_spooled ? state->next : job->n_spooled;
    if (w->request == WORKER_REQUEST_FRAMES && state->next < w->sent_to[state->job])
        lease->pause_ms = now + PAUSE_MS;
    const bool is_taken = w->request == WORKER_REQUEST_RENEW && w->is_ended[state->job] &&
                          state->next >= job->n_spooled;
    if (state->stop == API_JOB_GONE || (state->stop == API_JOB_GO_ON && is_taken))
        worker__drop_job(w, job);
    else if (state->stop == API_JOB_SAVE)
        worker__stop_job(w, job);
}

static bf_status take_states(worker *w, const bf_buffer *body, int64_t now, bf_error *err)
{
    api_job_states states = { .n = 0 };

    BF_TRY(lease_json_read_states(body->bytes, body->n, &states, err));
    for (size_t k = 0; k < states.n; k++)
        take_state(w, w->about, &states.items[k], now);
    memory_free(states.items);
    if (w->request == WORKER_REQUEST_RENEW) {
        w->about->renewed_ms = now;
        w->about->must_renew = false;
    }
    return BF_OK;
}

static bf_status take_lease(worker *w, const bf_buffer *body, int64_t now, bf_error *err)
{
    api_lease lease = { .id = "" };

    bf_status status = lease_json_read(body->bytes, body->n, &lease, err);
    if (status != BF_OK)
        return status;
    int64_t wait_ms = (int64_t)lease.retry_s * 1000;
    wait_ms = wait_ms < ASK_LEAST_MS ? ASK_LEAST_MS : wait_ms;
    w->ask_ms = now + (wait_ms < ASK_MOST_MS ? wait_ms : ASK_MOST_MS);
    w->request_bytes = (size_t)lease.body_bytes;
    if (lease.n_jobs > 0) {
        w->ask_ms = now;
        status = worker__add_lease(w, &lease, err);
    }
    api_lease_fini(&lease);
    return status;
}

static void take_success(worker *w, const bf_buffer *body, int64_t now)
{
    bf_status status = BF_OK;
    bf_error why = { 0 };

    if (w->request == WORKER_REQUEST_LEASE)
        status = take_lease(w, body, now, &why);
    else if (w->request == WORKER_REQUEST_JOBS)
        status = worker__take_input(w->about, body, &why);
    else if (w->request == WORKER_REQUEST_LEAVE)
        w->about->must_leave = false;
    else
        status = take_states(w, body, now, &why);
    if (status != BF_OK && w->about == NULL)
        end_at_once(w, &why);
    else if (status != BF_OK)
        abandon(w, w->about, &why);
}

// The service refused, and would do so again.
static void take_refusal(worker *w, long http, const bf_buffer *body)
{
    const bf_status code = http == 404 ? BF_ENOTFOUND : http == 409 ? BF_ECONFLICT : BF_ESYSTEM;
    bf_error why = { 0 };

    (void)lease_json_read_problem(body->bytes == NULL ? "" : body->bytes, body->n, code, &why);
    const bool is_version = http == 409 && w->request != WORKER_REQUEST_JOBS;
    if (w->request == WORKER_REQUEST_LEASE || http == 401 || http == 403 || is_version) {
        end_at_once(w, &why);
    } else if (w->request == WORKER_REQUEST_LEAVE) {
        w->about->must_leave = false;
    } else if (w->request == WORKER_REQUEST_FRAMES && http == 404) {
        w->about->must_renew = true;
    } else {
        abandon(w, w->about, &why);
    }
}

void worker__take_answer(worker *w, const http_call_answer *answer, int64_t now)
{
    const long http = answer->status;
    char why[64];

    if (http == 0 || http >= 500 || http == 408 || http == 429) {
        snprintf(why, sizeof why, "HTTP status %ld", http);
        char quoted[LOG_QUOTED_SIZE];
        if (w->backoff_ms == 0)
            log_event(LOG_LEVEL_WARN, "service_lost", "error=%s",
                      log_quote(http == 0 ? answer->error : why, quoted));
        w->backoff_ms = w->backoff_ms == 0 ? BACKOFF_LEAST_MS : 2 * w->backoff_ms;
        w->backoff_ms = w->backoff_ms < BACKOFF_MOST_MS ? w->backoff_ms : BACKOFF_MOST_MS;
        w->retry_ms = now + w->backoff_ms;
    } else {
        if (w->backoff_ms > 0)
            log_event(LOG_LEVEL_INFO, "service_back", "status=%ld", http);
        w->backoff_ms = 0;
        if (http >= 200 && http < 300)
            take_success(w, answer->body, now);
        else
            take_refusal(w, http, answer->body);
    }
    w->request = WORKER_REQUEST_NONE;
}
