// The loop: how many workers are wanted, how many Slurm's queue shows, and a job array for those that are missing.

#include "server/slurm/slurm.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/lock.h"
#include "server/base/log.h"
#include "server/base/metrics.h"
#include "server/base/thread.h"
#include "server/pull/pull_executor.h"
#include "server/slurm/slurm_priv.h"

#include <inttypes.h>
#include <stdio.h>

enum { TURN_MS = 1000 }; // between looks at what waits

#define JOB_NAME "beltflow"

static bf_status run_command(slurm *s, const char *const *argv, const bf_buffer *input,
                             bf_buffer *out)
{
    const slurm__command command = { .argv = argv, .input = input, .must_stop = &s->is_stopping };
    char quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };

    bf_status status = slurm__run(&command, out, &err);
    if (status != BF_OK && !atomic_load(&s->is_stopping)) {
        metrics_add(METRICS_SLURM_FAILURES, 0, 1);
        // Once, not at each attempt while Slurm is away.
        if (!s->is_failing)
            log_event(LOG_LEVEL_WARN, "slurm_failed", "error=%s", log_quote(err.text, quoted));
        s->is_failing = true;
    }
    if (status == BF_OK && s->is_failing) {
        log_event(LOG_LEVEL_INFO, "slurm_back", "command=%s", argv[0]);
        s->is_failing = false;
    }
    return status;
}

// What could not be launched is held by Slurm until somebody looks at it; it would never be a worker. What an operator or
// a user holds stays: that is what they want, and they may release it.
static void cancel_failed(slurm *s, const slurm__queue *queue)
{
    const char *argv[SLURM_CANCELLED_AT_ONCE + 2] = { "scancel" };
    bf_buffer ignored = { 0 };
    size_t n = 1;

    for (size_t k = 0; k < queue->n && n <= SLURM_CANCELLED_AT_ONCE; k++)
        if (queue->tasks[k].state == SLURM_FAILED)
            argv[n++] = queue->tasks[k].name;
    if (n > 1 && run_command(s, argv, NULL, &ignored) == BF_OK) {
        metrics_add(METRICS_SLURM_CANCELLED, 0, (int64_t)(n - 1));
        log_event(LOG_LEVEL_WARN, "slurm_tasks_cancelled", "n=%zu", n - 1);
    }
    buffer_fini(&ignored);
}

// A task on a node is a worker as long as its worker is heard of, or while it may still begin.
static bool counts_as_worker(const slurm *s, const slurm__task *task)
{
    char name[SLURM_NAME_SIZE + 8];

    if (task->state == SLURM_PENDING)
        return true;
    (void)snprintf(name, sizeof name, "slurm-%s", task->name);
    return task->state == SLURM_STARTED &&
           (task->runs_s < SLURM_BEGIN_S || pull_executor_has_worker(s->options.pull, name));
}

static void look(slurm *s, int64_t now_ms)
{
    static const char *const argv[] = {
        "squeue", "--me", "--noheader", "--array", "--name=" JOB_NAME, SLURM_QUEUE_FORMAT, NULL
    };
    slurm__queue queue = { .n = 0 };
    bf_buffer out = { 0 };

    s->look_ms = now_ms + (int64_t)s->options.settings.interval_s * 1000;
    s->has_looked =
        run_command(s, argv, NULL, &out) == BF_OK &&
        slurm__read_queue(out.n == 0 ? "" : out.bytes, s->comment, &queue, NULL) == BF_OK;
    if (s->has_looked) {
        uint64_t n_running = 0;
        s->n_tasks = queue.n;
        s->n_pending = s->n_there = 0;
        for (size_t k = 0; k < queue.n; k++) {
            const slurm__task *task = &queue.tasks[k];
            s->n_pending += task->state == SLURM_PENDING;
            n_running += task->state == SLURM_STARTED;
            s->n_there += counts_as_worker(s, task);
        }
        metrics_set(METRICS_SLURM_TASKS, METRICS_TASK_PENDING, (int64_t)s->n_pending);
        metrics_set(METRICS_SLURM_TASKS, METRICS_TASK_RUNNING, (int64_t)n_running);
        cancel_failed(s, &queue);
    }
    memory_free(queue.tasks);
    buffer_fini(&out);
}

// Workers that all runs which may be claimed or are being solved would keep busy.
static uint64_t count_wanted(const slurm *s)
{
    const slurm_settings *settings = &s->options.settings;
    store_stats stats;

    store_read_stats(s->options.store, &stats);
    const uint64_t n_cores =
        stats.n_claimable * s->options.n_threads + pull_executor_count_cores(s->options.pull);
    const uint64_t n_workers = (n_cores + settings->cores - 1) / settings->cores;
    const uint64_t n = n_workers < settings->n_workers_max ? n_workers : settings->n_workers_max;

    metrics_set(METRICS_SLURM_WANTED, 0, (int64_t)n);
    return n;
}

// Whatever becomes of it, the next look at the queue shows it.
static void submit(slurm *s, uint64_t n)
{
    char array[32], comment[SLURM_COMMENT_SIZE + 16];
    bf_buffer out = { 0 };

    (void)snprintf(array, sizeof array, "--array=1-%" PRIu64, n);
    (void)snprintf(comment, sizeof comment, "--comment=%s", s->comment);
    const char *const argv[] = { "sbatch", "--parsable", "--job-name=" JOB_NAME,
                                 array,    comment,      NULL };
    s->has_looked = false;
    if (run_command(s, argv, &s->script, &out) == BF_OK) {
        char quoted[LOG_QUOTED_SIZE];
        metrics_add(METRICS_SLURM_SUBMITTED, 0, (int64_t)n);
        while (out.n > 0 && out.bytes[out.n - 1] == '\n')
            buffer_truncate(&out, out.n - 1);
        log_event(LOG_LEVEL_INFO, "slurm_submitted", "tasks=%" PRIu64 " job=%s", n,
                  log_quote(out.n == 0 ? "" : out.bytes, quoted));
        s->n_tasks += n;
    }
    buffer_fini(&out);
}

void slurm__take_turn(slurm *s, int64_t now_ms)
{
    const uint64_t n_wanted = count_wanted(s);

    // Without work and jobs Slurm is left alone.
    if ((n_wanted > 0 || s->n_tasks > 0) && now_ms >= s->look_ms)
        look(s, now_ms);
    if (s->has_looked && s->n_pending == 0 && n_wanted > s->n_there) {
        const uint64_t n = n_wanted - s->n_there;
        submit(s, n < SLURM_ARRAY_MAX ? n : SLURM_ARRAY_MAX);
    }
}

static void *run_loop(void *context)
{
    slurm *s = context;

    lock_acquire(&s->lock);
    while (!atomic_load(&s->is_stopping)) {
        lock_release(&s->lock);
        slurm__take_turn(s, clock_monotonic_ms());
        lock_acquire(&s->lock);
        if (!atomic_load(&s->is_stopping))
            (void)lock_wait(&s->stopped, &s->lock, clock_monotonic_ms() + TURN_MS);
    }
    lock_release(&s->lock);
    return NULL;
}

bf_status slurm__create(const slurm_options *o, slurm **ret_slurm, bf_error *err)
{
    slurm *s = memory_alloc(1, sizeof *s);

    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for Slurm");
    s->options = *o;
    (void)snprintf(s->comment, sizeof s->comment, "beltflow %s", o->settings.url);
    lock_init(&s->lock);
    lock_condition_init(&s->stopped);
    bf_status status = slurm_write_script(&o->settings, &s->script, err);
    if (status == BF_OK)
        *ret_slurm = s;
    else
        slurm__destroy(s);
    return status;
}

void slurm__destroy(slurm *s)
{
    lock_condition_fini(&s->stopped);
    lock_fini(&s->lock);
    buffer_fini(&s->script);
    memory_free(s);
}

bf_status slurm_start(const slurm_options *o, slurm **ret_slurm, bf_error *err)
{
    slurm *s = NULL;

    BF_TRY(slurm__create(o, &s, err));
    bf_status status = thread_start(&s->thread, run_loop, s, "Slurm", err);
    if (status == BF_OK)
        *ret_slurm = s;
    else
        slurm__destroy(s);
    return status;
}

slurm *slurm_stop(slurm *s)
{
    if (s == NULL)
        return NULL;
    lock_acquire(&s->lock);
    atomic_store(&s->is_stopping, true);
    lock_wake_all(&s->stopped);
    lock_release(&s->lock);
    BF_CHECK(pthread_join(s->thread, NULL) == 0);
    slurm__destroy(s);
    return NULL;
}
