#include "server/supervisor_priv.h"

#include "server/clock.h"
#include "server/log.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/epoll.h>

enum { PAUSE_MOST_MS = 30000 };

void supervisor__pause(supervisor *s)
{
    s->claim_at_ms = clock_monotonic_ms() + s->pause_ms;
    s->pause_ms = 2 * s->pause_ms < PAUSE_MOST_MS ? 2 * s->pause_ms : PAUSE_MOST_MS;
    lock_take(&s->lock);
    s->may_claim = true;
    lock_give(&s->lock);
}

bool supervisor__watch_fd(supervisor *s, int fd, uint32_t events, supervisor__watch *w)
{
    struct epoll_event event = { .events = events, .data.ptr = w };

    return epoll_ctl(s->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

static bool watch_task(supervisor *s, supervisor__task *task)
{
    const child *c = &task->child;

    return supervisor__watch_fd(s, c->in, EPOLLOUT, &task->watches[SUPERVISOR_IN]) &&
           supervisor__watch_fd(s, c->out, EPOLLIN, &task->watches[SUPERVISOR_OUT]) &&
           supervisor__watch_fd(s, c->err, EPOLLIN, &task->watches[SUPERVISOR_ERR]) &&
           supervisor__watch_fd(s, c->pidfd, EPOLLIN, &task->watches[SUPERVISOR_END]);
}

static void end_claiming(supervisor *s, supervisor__task *task)
{
    lock_take(&s->lock);
    s->is_claiming = false;
    if (task != NULL) {
        s->tasks[s->n_tasks++] = task;
        s->may_claim = true;
    }
    lock_wake_all(&s->changed);
    lock_give(&s->lock);
}

// A claimed run that cannot be started: back to the queue if that can pass, else it has failed.
static void give_up(supervisor *s, const store_job *job, const bf_error *err)
{
    store_ending ending = { .run_id = job->run.id,
                            .state = err->code == BF_ESYSTEM ? RUN_FAILED : RUN_QUEUED,
                            .error = *err };
    api_run after;
    bf_error why = { 0 };
    char quoted[LOG_QUOTED_SIZE];

    log_event(LOG_LEVEL_ERROR, "run_not_started", "run=%s error=%s", job->run.id,
              log_quote(err->text, quoted));
    if (store_finish(s->options.store, &ending, &after, &why) != BF_OK)
        log_event(LOG_LEVEL_ERROR, "run_not_stored", "run=%s error=%s", job->run.id,
                  log_quote(why.text, quoted));
    supervisor__pause(s);
}

static void start_task(supervisor *s, store_job *job)
{
    bf_error err = { 0 };
    supervisor__task *task = NULL;

    if (supervisor__task_start(&s->options, job, &task, &err) != BF_OK) {
        give_up(s, job, &err);
        end_claiming(s, NULL);
        return;
    }
    s->pause_ms = SUPERVISOR_PAUSE_FIRST_MS;
    log_event(LOG_LEVEL_INFO, "run_started", "run=%s pid=%ld", task->job.run.id,
              (long)task->child.pid);
    if (!watch_task(s, task)) {
        // The list must not keep what nobody watches.
        (void)bf_fail(&err, BF_EBUSY, "", "a child cannot be watched: %s", strerror(errno));
        child_signal(&task->child, SIGKILL);
        child_wait(&task->child);
        give_up(s, &task->job, &err);
        supervisor__task_free(task);
        task = NULL;
    }
    end_claiming(s, task);
}

bool supervisor__claim(supervisor *s)
{
    store_job job = { .step = 0 };
    bf_error err = { 0 };
    char quoted[LOG_QUOTED_SIZE];

    if (s->claim_at_ms != 0 && clock_monotonic_ms() < s->claim_at_ms)
        return false;
    s->claim_at_ms = 0;
    lock_take(&s->lock);
    bool is_time = s->may_claim && !s->is_stopping && s->n_tasks < s->options.n_workers;
    if (is_time) {
        s->is_claiming = true;
        s->may_claim = false;
    }
    lock_give(&s->lock);
    if (!is_time)
        return false;
    bf_status status = store_claim(s->options.store, &job, &err);
    if (status == BF_OK) {
        start_task(s, &job);
        store_job_fini(&job);
        return true;
    }
    end_claiming(s, NULL);
    if (status != BF_ENOTFOUND) {
        log_event(LOG_LEVEL_ERROR, "queue_not_read", "error=%s", log_quote(err.text, quoted));
        supervisor__pause(s);
    }
    return false;
}
