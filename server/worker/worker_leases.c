// Leases: made, filled, ended; how much work is left of them.

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/worker/worker_priv.h"

#include <string.h>

static worker_lease *find_free(worker *w)
{
    for (size_t l = 0; l < WORKER_LEASES; l++)
        if (w->leases[l].id[0] == '\0')
            return &w->leases[l];
    return NULL;
}

bf_status worker__add_lease(worker *w, const api_lease *from, bf_error *err)
{
    worker_lease *lease = find_free(w);
    worker_job *jobs = memory_alloc(from->n_jobs, sizeof *jobs);
    size_t at = 0;

    if (lease == NULL || jobs == NULL) {
        memory_free(jobs);
        return bf_fail(err, BF_ENOMEM, "", "no memory for a lease");
    }
    for (size_t k = 0; k < from->n_jobs; k++) {
        jobs[k] = (worker_job){ .about = from->jobs[k], .at = at, .spool = -1 };
        at += (size_t)from->jobs[k].n_bytes;
    }
    const int64_t now = clock_monotonic_ms();
    *lease = (worker_lease){
        .jobs = jobs, .n_jobs = from->n_jobs, .begun_ms = now, .renewed_ms = now, .sent_ms = now
    };
    memcpy(lease->id, from->id, sizeof lease->id);
    log_event(LOG_LEVEL_INFO, "lease_begun", "lease=%s jobs=%zu bytes=%zu", lease->id,
              lease->n_jobs, at);
    return BF_OK;
}

bf_status worker__take_input(worker_lease *lease, const bf_buffer *input, bf_error *err)
{
    const worker_job *last = &lease->jobs[lease->n_jobs - 1];

    if (input->n != last->at + last->about.n_bytes)
        return bf_fail(err, BF_ECORRUPT, "",
                       "the input of a lease has not the length that it said");
    if (buffer_append(&lease->input, input->bytes, input->n) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the input of a lease");
    lease->has_input = true;
    return BF_OK;
}

void worker__end_lease(worker *w, worker_lease *lease)
{
    for (size_t k = 0; k < lease->n_jobs; k++)
        worker__drop_job(w, &lease->jobs[k]);
    log_event(LOG_LEVEL_INFO, "lease_ended", "lease=%s jobs=%zu duration_s=%.1f", lease->id,
              lease->n_jobs, (double)(clock_monotonic_ms() - lease->begun_ms) / 1e3);
    memory_free(lease->jobs);
    buffer_fini(&lease->input);
    *lease = (worker_lease){ .n_jobs = 0 };
}

bool worker__is_idle(const worker *w)
{
    for (size_t l = 0; l < WORKER_LEASES; l++)
        if (w->leases[l].id[0] != '\0')
            return false;
    return true;
}

unsigned worker__count_threads(const worker *w, worker_job_state state)
{
    unsigned n = 0;

    for (size_t l = 0; l < WORKER_LEASES; l++)
        for (size_t k = 0; k < w->leases[l].n_jobs; k++)
            if (w->leases[l].jobs[k].state == state)
                n += w->leases[l].jobs[k].about.n_threads;
    return n;
}

bool worker__wants_jobs(const worker *w)
{
    bool has_place = false;

    for (size_t l = 0; l < WORKER_LEASES; l++)
        has_place = has_place || w->leases[l].id[0] == '\0';
    return has_place && worker__has_spool(w) &&
           worker__count_threads(w, WORKER_JOB_WAITS) < w->options->who.cores;
}
