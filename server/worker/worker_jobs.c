// Jobs: their children, and the files that keep what those send.

#include "core/observe/frame.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/worker/worker_priv.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdalign.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum {
    READ_BYTES = 64 * 1024,
    START_AGAIN_MS = 1000,
    START_TRIES = 10,    // of a job, until it is given back
    PAUSE_MS = 30000,    // without asking for more, after that
    END_BYTES_MAX = 512, // of FRAME_END
};

void worker__fail(worker *w, const bf_error *why)
{
    char quoted[LOG_QUOTED_SIZE];

    if (!w->has_failed)
        w->error = *why;
    w->has_failed = true;
    log_event(LOG_LEVEL_ERROR, "worker_failed", "error=%s", log_quote(why->text, quoted));
    worker__drain(w);
}

void worker__drop_job(worker *w, worker_job *job)
{
    if (job->state == WORKER_JOB_RUNS)
        w->solver->functions->release(w->solver, job->child);
    if (job->spool >= 0)
        close(job->spool);
    w->n_spooled -= job->n_spooled;
    job->n_spooled = job->n_taken = 0;
    job->spool = -1;
    job->child = NULL;
    job->state = WORKER_JOB_OVER;
}

static void end_job(worker_job *job, api_job_cause cause, const bf_error *why)
{
    job->end = (executor_end){ .cause = cause };
    if (why != NULL)
        job->end.error = *why;
    job->state = WORKER_JOB_ENDED;
}

// ---- start

static bf_status start_child(worker *w, const worker_lease *lease, worker_job *job, bf_error *err)
{
    const char *in = lease->input.bytes + job->at;
    const size_t n = (size_t)job->about.n_bytes;
    size_t used = 0;
    frame about = { .type = FRAME_JOB }, resume = { .type = FRAME_RESUME };

    BF_TRY(frame_decode_input(in, n, FRAME_JOB, &about, &used, err));
    if (used < n)
        BF_TRY(frame_decode_input(in + used, n - used, FRAME_RESUME, &resume, &used, err));
    const bf_buffer scenario = { .bytes = (char *)about.job.document, .n = about.job.n_document };
    const bf_buffer checkpoint = { .bytes = (char *)resume.bytes.bytes, .n = resume.bytes.n };
    const executor_work work = { .run_id = job->about.run,
                                 .model = job->about.model,
                                 .n_threads = job->about.n_threads,
                                 .is_trial = job->about.is_trial,
                                 .scenario = &scenario,
                                 .checkpoint = &checkpoint,
                                 .step = job->about.step,
                                 .limits = { .checkpoint_ms = (int64_t)job->about.checkpoint_ms,
                                             .memory_bytes = job->about.memory_bytes,
                                             .cpu_s = job->about.cpu_s } };
    return w->solver->functions->start(w->solver, &work, &job->child, err);
}

static void start_job(worker *w, const worker_lease *lease, worker_job *job)
{
    bf_error why = { 0 };

    job->spool = open(w->options->spool, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (job->spool < 0) {
        (void)bf_fail(&why, BF_ESYSTEM, "", "no file can be made in %s: %s", w->options->spool,
                      strerror(errno));
        worker__fail(w, &why);
        return;
    }
    const bf_status status = start_child(w, lease, job, &why);
    if (status == BF_OK) {
        job->state = WORKER_JOB_RUNS;
        return;
    }
    close(job->spool);
    job->spool = -1;
    const int64_t now_ms = clock_monotonic_ms();
    const bool may_work_later = status == BF_EBUSY || status == BF_ENOMEM;
    if (may_work_later && ++job->n_refused < START_TRIES) {
        w->start_ms = now_ms + START_AGAIN_MS;
        return;
    }
    end_job(job, may_work_later ? API_JOB_STOPPED : API_JOB_UNSTARTED, &why);
    if (may_work_later)
        w->ask_ms = now_ms + PAUSE_MS; // others may have room
}

void worker__start_jobs(worker *w)
{
    unsigned n_busy = worker__count_threads(w, WORKER_JOB_RUNS);
    const int64_t now = clock_monotonic_ms();

    for (size_t l = 0; l < WORKER_LEASES; l++)
        for (size_t k = 0; k < w->leases[l].n_jobs; k++) {
            worker_job *job = &w->leases[l].jobs[k];
            // A job of more threads than there are cores is solved alone.
            const bool has_room =
                n_busy == 0 || n_busy + job->about.n_threads <= w->options->who.cores;
            if (w->is_draining || now < w->start_ms || !w->leases[l].has_input)
                break;
            if (job->state != WORKER_JOB_WAITS || !has_room)
                continue;
            start_job(w, &w->leases[l], job);
            if (job->state == WORKER_JOB_RUNS)
                n_busy += job->about.n_threads;
        }
}

// ---- frames

static bf_status fail_spool(const worker *w, const worker_job *job, bf_error *err)
{
    return bf_fail(err, BF_ENOSPACE, "", "the spool in %s has no room for the frames of run %s",
                   w->options->spool, job->about.run);
}

static bool write_bytes(const worker_job *job, const char *bytes, size_t n)
{
    size_t written = 0;

    while (written < n) {
        const ssize_t k =
            pwrite(job->spool, bytes + written, n - written, (off_t)(job->n_spooled + written));
        if (k < 0 && errno == EINTR)
            continue;
        if (k <= 0)
            return false;
        written += (size_t)k;
    }
    return true;
}

// Where the files together are as long as they may be, this job comes back to the service with what it has sent; where the
// disk is full the worker ends.
static bool spool_bytes(worker *w, worker_job *job, const char *bytes, size_t n)
{
    bf_error why;

    if (w->n_spooled + n > w->options->spool_bytes) {
        (void)fail_spool(w, job, &why);
        log_event(LOG_LEVEL_WARN, "spool_full", "run=%s bytes=%" PRIu64, job->about.run,
                  job->n_spooled);
        job->used_s = w->solver->functions->cpu_s(w->solver, job->child);
        w->solver->functions->release(w->solver, job->child);
        job->child = NULL;
        end_job(job, API_JOB_KILLED, &why);
        return false;
    }
    if (write_bytes(job, bytes, n)) {
        job->n_spooled += n;
        w->n_spooled += n;
        return true;
    }
    (void)fail_spool(w, job, &why);
    worker__drop_job(w, job);
    worker__fail(w, &why);
    return false;
}

// The digest of a run's final state, from FRAME_END, which has one length and comes last.
static void find_digest(worker_job *job)
{
    bf_buffer model = { .n = 0 };
    frame f = { .type = FRAME_END };
    bf_error why;
    size_t used = 0;
    alignas(8) char bytes[END_BYTES_MAX];

    const bf_status status = frame_encode(&f, &model, &why);
    const size_t n = model.n;
    buffer_fini(&model);
    if (status != BF_OK || n > sizeof bytes || n > job->n_spooled ||
        pread(job->spool, bytes, n, (off_t)(job->n_spooled - n)) != (ssize_t)n)
        return;
    if (frame_decode(bytes, n, &f, &used, &why) == BF_OK && used == n && f.type == FRAME_END)
        snprintf(job->digest, sizeof job->digest, "%016" PRIx64, f.end.digest);
}

bool worker__has_spool(const worker *w)
{
    return w->n_spooled < w->options->spool_bytes / 4 * 3;
}

// The whole of a job's frames stays until its end was taken, so before there is no room the longest one saves and ends: it
// goes on from there, in a new file, here or elsewhere.
static void save_longest(worker *w)
{
    worker_job *longest = NULL;

    for (size_t l = 0; l < WORKER_LEASES; l++)
        for (size_t k = 0; k < w->leases[l].n_jobs; k++) {
            worker_job *job = &w->leases[l].jobs[k];
            if (job->is_stopping && job->state != WORKER_JOB_OVER)
                return; // one after the other
            if (job->state == WORKER_JOB_RUNS &&
                (longest == NULL || job->n_spooled > longest->n_spooled))
                longest = job;
        }
    if (longest == NULL)
        return;
    log_event(LOG_LEVEL_INFO, "spool_fills", "run=%s bytes=%" PRIu64, longest->about.run,
              longest->n_spooled);
    worker__stop_job(w, longest);
}

static void collect_job(worker *w, worker_job *job)
{
    static char bytes[READ_BYTES]; // one thread
    executor_state state = EXECUTOR_RUNNING;
    executor_end end = { .cause = API_JOB_EXITED };
    size_t n = 0;

    do {
        state = w->solver->functions->poll(w->solver, job->child, bytes, sizeof bytes, &n, &end);
        if (n > 0 && !spool_bytes(w, job, bytes, n))
            return;
        if (!worker__has_spool(w))
            save_longest(w);
    } while (n > 0);
    if (state != EXECUTOR_ENDED)
        return;
    job->used_s = w->solver->functions->cpu_s(w->solver, job->child);
    w->solver->functions->release(w->solver, job->child);
    job->child = NULL;
    end_job(job, end.cause, &end.error);
    find_digest(job);
}

void worker__collect(worker *w)
{
    w->solver->functions->update(w->solver);
    for (size_t l = 0; l < WORKER_LEASES; l++)
        for (size_t k = 0; k < w->leases[l].n_jobs; k++)
            if (w->leases[l].jobs[k].state == WORKER_JOB_RUNS)
                collect_job(w, &w->leases[l].jobs[k]);
}

// ---- stop

void worker__stop_job(worker *w, worker_job *job)
{
    if (job->state == WORKER_JOB_WAITS)
        end_job(job, API_JOB_STOPPED, NULL);
    else if (job->state == WORKER_JOB_RUNS && !job->is_stopping)
        w->solver->functions->stop(w->solver, job->child, EXECUTOR_STOP_GRACEFUL);
    job->is_stopping = true;
}

void worker__drain(worker *w)
{
    if (w->is_draining)
        return;
    w->is_draining = w->is_leaving = true;
    w->end_ms = clock_monotonic_ms() + PULL_WORKER_DRAIN_S * 1000;
    for (size_t l = 0; l < WORKER_LEASES; l++) {
        w->leases[l].must_leave = true;
        for (size_t k = 0; k < w->leases[l].n_jobs; k++) {
            worker_job *job = &w->leases[l].jobs[k];
            if (job->state == WORKER_JOB_RUNS)
                worker__stop_job(w, job);
            else if (job->state == WORKER_JOB_WAITS)
                worker__drop_job(w, job);
        }
    }
}
