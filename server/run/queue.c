// How runs get into the list of tasks, and the states that the store would not take.

#include "server/run/supervisor_priv.h"

#include "core/base/check.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <stdio.h>

enum {
    BACKOFF_MAX_MS = 30000,
    HELD_MS = 60000, // between looks at runs that wait for the quota of their owner
};

void supervisor__backoff(supervisor *s)
{
    s->claim_at_ms = clock_monotonic_ms() + s->backoff_ms;
    s->backoff_ms = 2 * s->backoff_ms < BACKOFF_MAX_MS ? 2 * s->backoff_ms : BACKOFF_MAX_MS;
    supervisor_wake(s);
}

// Backoff makes several attempts a minute.
void supervisor__note_trouble(supervisor *s, const bf_error *err)
{
    const int64_t now_ms = clock_monotonic_ms();
    char quoted[LOG_QUOTED_SIZE];

    if (s->logged_ms == 0 || now_ms >= s->logged_ms + SUPERVISOR_TROUBLE_MS) {
        s->logged_ms = now_ms;
        log_event(LOG_LEVEL_ERROR, "runs_not_started", "error=%s", log_quote(err->text, quoted));
    }
    lock_acquire(&s->lock);
    s->trouble = *err;
    s->trouble_until_ms = now_ms + SUPERVISOR_TROUBLE_MS;
    lock_release(&s->lock);
    supervisor__backoff(s);
}

void supervisor__forget_trouble(supervisor *s)
{
    s->backoff_ms = SUPERVISOR_BACKOFF_FIRST_MS;
    s->logged_ms = 0;
    lock_acquire(&s->lock);
    s->trouble_until_ms = 0;
    lock_release(&s->lock);
}

bf_status supervisor_ready(supervisor *s, bf_error *err)
{
    bf_error trouble = { .code = BF_OK };

    lock_acquire(&s->lock);
    if (clock_monotonic_ms() < s->trouble_until_ms)
        trouble = s->trouble;
    lock_release(&s->lock);
    if (trouble.code != BF_OK)
        return bf_fail(err, trouble.code, "", "%s", trouble.text);
    return s->executor->functions->ready(s->executor, err);
}

bool supervisor__may_work_later(bf_status code)
{
    return code == BF_EBUSY || code == BF_ENOMEM || code == BF_ESYSTEM || code == BF_ENOSPACE;
}

// Each pending update is of a run that was a task, and no task is made while there are any, so there is
// room.
void supervisor__defer(supervisor *s, const char *run_id, run_state state, double cpu_s)
{
    BF_CHECK(s->n_pending < SUPERVISOR_TASKS_MAX);
    supervisor__pending_update *update = &s->pending[s->n_pending++];
    update->state = state;
    update->cpu_s = cpu_s;
    snprintf(update->run_id, sizeof update->run_id, "%s", run_id);
    supervisor__backoff(s);
}

// Write the pending updates. False: the store still refuses.
static bool retry_pending(supervisor *s)
{
    while (s->n_pending > 0) {
        const supervisor__pending_update *update = &s->pending[s->n_pending - 1];
        store_ending ending = { .run_id = update->run_id,
                                .state = update->state,
                                .cpu_s = update->cpu_s };
        api_run after;
        bf_status status = store_finish(s->store, &ending, &after, NULL);
        if (status != BF_OK && status != BF_ENOTFOUND && status != BF_ECONFLICT) {
            supervisor__backoff(s);
            return false;
        }
        log_event(LOG_LEVEL_INFO, "run_stored_late", "run=%s state=%s", update->run_id,
                  run_state_word(update->state));
        s->n_pending--;
    }
    return true;
}

// What is being claimed is not known here yet, and counts as a run by itself.
static bool is_trial(const supervisor__task *task)
{
    return task->phase != SUPERVISOR_CLAIMING && task->claimed.run.study[0] != '\0';
}

static size_t count_solving(const supervisor *s, bool with_trials)
{
    size_t n = 0;

    for (size_t i = 0; i < s->n_tasks; i++)
        n += !s->tasks[i]->is_solved && (with_trials || !is_trial(s->tasks[i]));
    return n;
}

bool supervisor__has_workers(const supervisor *s)
{
    return s->executor->functions->has_room != NULL;
}

// Trials take no places of runs by themselves.
bool supervisor__has_room(const supervisor *s)
{
    executor *e = s->executor;

    if (supervisor__has_workers(s))
        return s->n_tasks < SUPERVISOR_TASKS_MAX && e->functions->has_room(e, false);
    return count_solving(s, false) < s->options.n_workers &&
           s->n_tasks < SUPERVISOR_LOCAL_TASKS_MAX;
}

// Where only trials are solved there is one more of them than workers, so that no core idles while the end of one is
// stored and the next one starts.
static bool has_room_for_trials(const supervisor *s)
{
    const size_t n_more = count_solving(s, false) == 0 ? 1 : 0;

    if (supervisor__has_workers(s))
        return s->executor->functions->has_room(s->executor, true);
    return count_solving(s, true) < s->options.n_workers + n_more;
}

// True if something may be queued that was not looked at yet, or again.
static bool take_may_claim(supervisor *s, bool with_trials)
{
    const bool is_due = (s->held_until_ms != 0 && clock_monotonic_ms() >= s->held_until_ms) ||
                        (s->has_left_trials && with_trials);

    lock_acquire(&s->lock);
    bool is_time = (s->may_claim || is_due) && !s->is_stopping;
    if (is_time)
        s->may_claim = false;
    lock_release(&s->lock);
    if (is_time || is_due) {
        s->held_until_ms = 0;
        s->has_left_trials = false;
    }
    return is_time;
}

supervisor__task *supervisor__create_claiming(supervisor *s)
{
    const bool with_trials = has_room_for_trials(s);
    bf_error err = { 0 };

    for (size_t i = 0; i < s->n_tasks; i++)
        if (s->tasks[i]->phase == SUPERVISOR_CLAIMING)
            return NULL; // one at a time
    if (!supervisor__has_room(s))
        return NULL;
    if (s->claim_at_ms != 0 && clock_monotonic_ms() < s->claim_at_ms)
        return NULL;
    s->claim_at_ms = 0;
    if (!retry_pending(s) || !take_may_claim(s, with_trials))
        return NULL;
    if (s->executor->functions->ready(s->executor, &err) != BF_OK) {
        supervisor__note_trouble(s, &err);
        return NULL;
    }
    supervisor__task *task = supervisor__task_create(s);
    if (task == NULL) {
        supervisor__backoff(s);
        return NULL;
    }
    task->with_trials = with_trials;
    return task;
}

void supervisor__claim(supervisor *s)
{
    supervisor__task *task = supervisor__create_claiming(s);

    if (task != NULL)
        supervisor__begin_write(task, SUPERVISOR_WRITE_CLAIM);
}

static void start_claimed(supervisor__task *task)
{
    supervisor *s = task->supervisor;
    bf_error err = { 0 };

    if (task->requested != SUPERVISOR_STOP_NONE) {
        (void)bf_fail(&err, BF_EBUSY, "", "the daemon is stopping");
    } else if (supervisor__task_start(task, NULL, &err) == BF_OK) {
        log_event(LOG_LEVEL_INFO, "run_started", "run=%s job=%s", task->claimed.run.id,
                  task->external_id);
        if (s->executor->outlives_daemon && !is_trial(task))
            supervisor__begin_write(task, SUPERVISOR_WRITE_ID);
        return;
    } else if (supervisor__may_work_later(err.code)) {
        supervisor__note_trouble(s, &err);
    }
    // Back to the queue if it may work later, else it has failed, so that it does not come first again and again.
    task->phase = SUPERVISOR_ENDING;
    task->ending = (store_ending){
        .run_id = task->claimed.run.id,
        .state = supervisor__may_work_later(err.code) ? RUN_QUEUED : RUN_FAILED,
        .error = err,
    };
    supervisor__begin_end(task, NULL);
}

void supervisor__finish_claim(supervisor__task *task)
{
    supervisor *s = task->supervisor;
    const bf_error err = task->write.error;
    const bool with_trials = task->with_trials;
    bf_status status = task->write.status;

    if (status == BF_OK) {
        start_claimed(task);
        // A stop request may have come before the run was known here; and there may be room for more.
        lock_acquire(&s->lock);
        s->may_claim = s->may_stop = true;
        lock_release(&s->lock);
        return;
    }
    supervisor__task_destroy(task);
    s->has_left_trials = !with_trials;
    if (status == BF_ELIMIT)
        s->held_until_ms = clock_monotonic_ms() + HELD_MS;
    if (status == BF_ENOTFOUND || status == BF_ELIMIT) {
        supervisor__forget_trouble(s); // no run waits that may be solved
        return;
    }
    supervisor__note_trouble(s, &err);
}

bool supervisor_still_runs(void *context, const store_running *running)
{
    executor *e = context;
    executor_job *job;

    return running->external_id[0] != '\0' &&
           e->functions->attach(e, running->external_id, &job, NULL) == BF_OK;
}

// Take over one run that was running before the daemon was; it goes back to the queue if its job no longer exists.
static void attach_run(supervisor *s, const store_running *running)
{
    supervisor__task *task = supervisor__task_create(s);
    bf_error err = { 0 };

    bf_status status = task == NULL ? bf_fail(&err, BF_ENOMEM, "", "no memory to take over a run")
                                    : store_read_job(s->store, running->id, &task->claimed, &err);
    if (status == BF_OK)
        status = supervisor__task_start(task, running->external_id, &err);
    if (status == BF_OK) {
        log_event(LOG_LEVEL_INFO, "run_attached", "run=%s job=%s", running->id, task->external_id);
        return;
    }
    if (task != NULL)
        supervisor__task_destroy(task);
    supervisor__defer(s, running->id,
                      running->stop_request == STORE_STOP_NONE ? RUN_QUEUED : RUN_CANCELLED, 0.0);
}

void supervisor__attach(supervisor *s)
{
    store_running *running = s->running;
    bf_error err = { 0 };
    size_t n = 0;
    char quoted[LOG_QUOTED_SIZE];

    if (store_list_running(s->store, SUPERVISOR_TASKS_MAX, running, &n, &err) != BF_OK)
        log_event(LOG_LEVEL_ERROR, "queue_not_read", "error=%s", log_quote(err.text, quoted));
    for (size_t i = 0; i < n; i++)
        attach_run(s, &running[i]);
}
