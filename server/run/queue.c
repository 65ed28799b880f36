#include "server/run/supervisor_priv.h"

#include "core/base/check.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
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

// Each debt is of a run that had a place, and no place is given away while there are debts, so there
// is room.
void supervisor__owe(supervisor *s, const char *run_id, run_state state)
{
    BF_CHECK(s->n_debts < SUPERVISOR_WORKERS_MAX);
    supervisor__debt *debt = &s->debts[s->n_debts++];
    debt->state = state;
    snprintf(debt->run_id, sizeof debt->run_id, "%s", run_id);
    supervisor__pause(s);
}

// False: the store cannot be told yet.
static bool settle(supervisor *s)
{
    while (s->n_debts > 0) {
        const supervisor__debt *debt = &s->debts[s->n_debts - 1];
        store_ending ending = { .run_id = debt->run_id, .state = debt->state };
        api_run after;
        bf_status status = store_finish(s->options.store, &ending, &after, NULL);
        if (status != BF_OK && status != BF_ENOTFOUND && status != BF_ECONFLICT) {
            supervisor__pause(s);
            return false;
        }
        log_event(LOG_LEVEL_INFO, "run_stored_late", "run=%s state=%s", debt->run_id,
                  run_state_word(debt->state));
        s->n_debts--;
    }
    return true;
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

// A claimed run that cannot be started: back to the queue if that can pass, else it has failed, so
// that it does not come first again and again.
static void give_up(supervisor *s, const store_job *job, const bf_error *err)
{
    bool can_pass = err->code == BF_EBUSY || err->code == BF_ENOMEM;
    store_ending ending = { .run_id = job->run.id,
                            .state = can_pass ? RUN_QUEUED : RUN_FAILED,
                            .error = *err };
    api_run after;
    bf_error why = { 0 };
    char quoted[LOG_QUOTED_SIZE];

    log_event(LOG_LEVEL_ERROR, "run_not_started", "run=%s error=%s", job->run.id,
              log_quote(err->text, quoted));
    if (store_finish(s->options.store, &ending, &after, &why) == BF_OK) {
        supervisor__pause(s);
        return;
    }
    log_event(LOG_LEVEL_ERROR, "run_not_stored", "run=%s error=%s", job->run.id,
              log_quote(why.text, quoted));
    supervisor__owe(s, job->run.id, RUN_QUEUED);
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
    if (!settle(s))
        return false;
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
