#include "server/run/supervisor_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/lock.h"
#include "server/base/log.h"
#include "server/base/metrics.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum {
    EVENTS_MAX = 64,
    LISTEN_BYTES = 1024 * 1024, // of one child in one turn, and so in one batch
    END_GRACE_MS = 5000,        // from SIGTERM, or from the last frame, to SIGKILL
};

static void ring(supervisor *s)
{
    uint64_t one = 1;

    // It can only fail when the bell rings already.
    if (write(s->bell, &one, sizeof one) < 0)
        return;
}

static supervisor__wish read_wish(supervisor *s, const supervisor__task *task)
{
    lock_take(&s->lock);
    supervisor__wish asked = task->asked;
    lock_give(&s->lock);
    return asked;
}

static void kill_by(supervisor__task *task, int64_t at_ms)
{
    if (task->kill_at_ms < 0 || at_ms < task->kill_at_ms)
        task->kill_at_ms = at_ms;
}

// Pass on what is asked of the task, and kill a child whose time is over.
static void press(supervisor *s, supervisor__task *task, int64_t grace_ms)
{
    int64_t now_ms = clock_monotonic_ms();
    supervisor__wish asked = read_wish(s, task);

    if (asked > task->served) {
        if (asked == SUPERVISOR_KILL)
            kill_by(task, now_ms);
        else if (task->served == SUPERVISOR_GO_ON)
            child_signal(&task->child, SIGTERM);
        kill_by(task, now_ms + (asked == SUPERVISOR_HAND_BACK ? grace_ms : END_GRACE_MS));
        task->served = asked;
    }
    if (task->has_ended || task->is_doomed)
        kill_by(task, now_ms + END_GRACE_MS);
    if (task->kill_at_ms >= 0 && task->kill_at_ms <= now_ms) {
        child_signal(&task->child, SIGKILL);
        task->is_late = asked != SUPERVISOR_KILL && !task->is_doomed;
        task->kill_at_ms = INT64_MAX;
    }
}

static void remove_task(supervisor *s, supervisor__task *task)
{
    lock_take(&s->lock);
    for (size_t i = 0; i < s->n_tasks; i++) {
        if (s->tasks[i] == task)
            s->tasks[i--] = s->tasks[--s->n_tasks];
    }
    s->may_claim = true;
    lock_wake_all(&s->changed);
    lock_give(&s->lock);
    supervisor__task_free(task);
}

static void end_task(supervisor *s, supervisor__task *task, int status)
{
    while (supervisor__listen(task, s->options.store, LISTEN_BYTES))
        ;
    supervisor__log_words(task);
    metrics_add(METRICS_CHILD_EXITS, supervisor__exit_reason(task, status), 1);
    supervisor__wish asked = read_wish(s, task);
    store_ending ending = supervisor__judge(task, status, asked, &s->options);
    bool is_back_unasked = ending.state == RUN_QUEUED && asked == SUPERVISOR_GO_ON;
    bool is_stored = supervisor__finish(task, s->options.store, &ending, s->options.n_threads);
    if (!is_stored)
        supervisor__owe(s, task->job.run.id,
                        asked >= SUPERVISOR_CANCEL ? RUN_CANCELLED : RUN_QUEUED);
    // The store's trouble, or somebody else's signals, would make the next one end the same way.
    else if (is_back_unasked || (task->is_doomed && task->error.code == BF_ESYSTEM))
        supervisor__pause(s);
    remove_task(s, task);
}

static void serve(supervisor *s, supervisor__task *task)
{
    unsigned ready = task->ready;
    int status;

    task->ready = 0;
    if (ready & 1U << SUPERVISOR_IN)
        child_feed(&task->child);
    if (ready & 1U << SUPERVISOR_ERR)
        supervisor__log_words(task);
    if (ready & 1U << SUPERVISOR_OUT)
        (void)supervisor__listen(task, s->options.store, LISTEN_BYTES);
    if ((ready & 1U << SUPERVISOR_END) && child_reap(&task->child, &status))
        end_task(s, task, status);
}

static int sooner(int64_t at_ms, int64_t now_ms, int timeout_ms)
{
    int64_t left_ms = at_ms <= now_ms ? 0 : at_ms - now_ms;

    if (left_ms > INT32_MAX)
        return timeout_ms;
    return timeout_ms < 0 || left_ms < timeout_ms ? (int)left_ms : timeout_ms;
}

// Until when the loop may sleep: for ever, unless a kill or the end of a pause is planned.
static int find_timeout(const supervisor *s)
{
    int64_t now_ms = clock_monotonic_ms();
    int timeout_ms = -1;

    for (size_t i = 0; i < s->n_tasks; i++) {
        if (s->tasks[i]->kill_at_ms >= 0)
            timeout_ms = sooner(s->tasks[i]->kill_at_ms, now_ms, timeout_ms);
    }
    if (s->claim_at_ms != 0 && s->n_tasks < s->options.n_workers)
        timeout_ms = sooner(s->claim_at_ms, now_ms, timeout_ms);
    return timeout_ms;
}

static void wait_for_events(supervisor *s)
{
    struct epoll_event events[EVENTS_MAX];
    uint64_t rings;

    int n = epoll_wait(s->epoll, events, EVENTS_MAX, find_timeout(s));
    for (int i = 0; i < n; i++) {
        const supervisor__watch *w = events[i].data.ptr;
        if (w->task != NULL)
            w->task->ready |= 1U << w->source;
        else if (read(s->bell, &rings, sizeof rings) < 0)
            continue;
    }
}

// Ask every task for what stopping asks for. Returns true if there is nothing left to wait for.
static bool is_over(supervisor *s, int64_t *ret_grace_ms)
{
    lock_take(&s->lock);
    for (size_t i = 0; s->is_stopping && i < s->n_tasks; i++) {
        if (s->tasks[i]->asked < SUPERVISOR_HAND_BACK)
            s->tasks[i]->asked = SUPERVISOR_HAND_BACK;
    }
    *ret_grace_ms = s->grace_ms;
    bool over = s->is_stopping && s->n_tasks == 0;
    lock_give(&s->lock);
    return over;
}

// The figures of what is being solved, all runs of a model together.
static void note_tasks(const supervisor *s)
{
    int64_t rates[RUN_MODEL_COUNT] = { 0 }, items[RUN_MODEL_COUNT] = { 0 };

    for (size_t i = 0; i < s->n_tasks; i++) {
        const supervisor__task *task = s->tasks[i];
        const frame_begin *b = &task->begin;
        rates[task->job.run.model] += (int64_t)task->rate;
        items[task->job.run.model] +=
            (int64_t)(b->n_values > 0 ? b->n_parts : b->grid.n1 * b->grid.n2);
    }
    for (size_t model = 0; model < RUN_MODEL_COUNT; model++) {
        metrics_set(METRICS_SOLVER_RATE, model, rates[model]);
        metrics_set(METRICS_SOLVER_ITEMS, model, items[model]);
    }
}

// Take over the options that somebody wants.
static void adopt(supervisor *s)
{
    lock_take(&s->lock);
    if (s->has_wanted) {
        s->options = s->wanted;
        s->has_wanted = false;
        s->may_claim = true;
    }
    lock_give(&s->lock);
}

static void *run_loop(void *context)
{
    supervisor *s = context;
    int64_t grace_ms = 0;

    while (supervisor__claim(s))
        ;
    while (!is_over(s, &grace_ms)) {
        pulse_answer(&s->pulse);
        for (size_t i = 0; i < s->n_tasks; i++)
            press(s, s->tasks[i], grace_ms);
        wait_for_events(s);
        // From the last, because one that ends gives its place to the last.
        for (size_t i = s->n_tasks; i > 0; i--)
            serve(s, s->tasks[i - 1]);
        adopt(s);
        while (supervisor__claim(s))
            ;
        note_tasks(s);
    }
    return NULL;
}

// With all signals blocked: they are for the main thread, and SIGPIPE is for nobody.
static int start_thread(supervisor *s)
{
    sigset_t all, before;

    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int error = pthread_create(&s->thread, NULL, run_loop, s);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return error;
}

static void free_supervisor(supervisor *s)
{
    if (s->epoll >= 0)
        close(s->epoll);
    if (s->bell >= 0)
        close(s->bell);
    lock_condition_fini(&s->changed);
    lock_fini(&s->lock);
    memory_free(s->tasks);
    memory_free(s->debts);
    memory_free(s);
}

static void check_options(const supervisor_options *options)
{
    BF_CHECK(options->n_workers >= 1 && options->n_workers <= SUPERVISOR_WORKERS_MAX);
    BF_CHECK(options->n_threads >= 1);
}

bf_status supervisor_start(const supervisor_options *options, supervisor **ret_supervisor,
                           bf_error *err)
{
    supervisor *s = memory_alloc(1, sizeof *s);
    supervisor__task **tasks = memory_alloc(SUPERVISOR_WORKERS_MAX, sizeof(supervisor__task *));
    supervisor__debt *debts = memory_alloc(SUPERVISOR_WORKERS_MAX, sizeof *debts);

    check_options(options);
    if (s == NULL || tasks == NULL || debts == NULL) {
        memory_free(s);
        memory_free(tasks);
        memory_free(debts);
        return bf_fail(err, BF_ENOMEM, "", "no memory for the supervisor");
    }
    s->options = *options;
    s->tasks = tasks;
    s->debts = debts;
    s->may_claim = true;
    s->pause_ms = SUPERVISOR_PAUSE_FIRST_MS;
    lock_init(&s->lock);
    lock_condition_init(&s->changed);
    s->epoll = epoll_create1(EPOLL_CLOEXEC);
    s->bell = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    bool ok =
        s->epoll >= 0 && s->bell >= 0 && supervisor__watch_fd(s, s->bell, EPOLLIN, &s->bell_watch);
    int error = ok ? start_thread(s) : errno;
    if (error != 0) {
        free_supervisor(s);
        return bf_fail(err, BF_ESYSTEM, "", "the supervisor cannot be started: %s",
                       strerror(error));
    }
    *ret_supervisor = s;
    return BF_OK;
}

void supervisor_reconfigure(supervisor *s, const supervisor_options *options)
{
    check_options(options);
    lock_take(&s->lock);
    s->wanted = *options;
    s->wanted.store = s->options.store;
    s->wanted.program = s->options.program;
    s->has_wanted = true;
    lock_give(&s->lock);
    ring(s);
}

bool supervisor_is_alive(supervisor *s)
{
    bool is_alive = !pulse_is_asked(&s->pulse);

    pulse_ask(&s->pulse);
    ring(s);
    return is_alive;
}

void supervisor_wake(supervisor *s)
{
    lock_take(&s->lock);
    s->may_claim = true;
    lock_give(&s->lock);
    ring(s);
}

// The task of a run, under the lock; NULL: it is not running. Waits for a claim that may be its.
static supervisor__task *find_task(supervisor *s, const char *run_id)
{
    lock_assert_held(&s->lock);
    while (s->is_claiming)
        (void)lock_wait(&s->changed, &s->lock, -1);
    for (size_t i = 0; i < s->n_tasks; i++) {
        if (strcmp(s->tasks[i]->job.run.id, run_id) == 0)
            return s->tasks[i];
    }
    return NULL;
}

bf_status supervisor_cancel(supervisor *s, const char *run_id, bf_error *err)
{
    lock_take(&s->lock);
    supervisor__task *task = find_task(s, run_id);
    if (task != NULL && task->asked < SUPERVISOR_CANCEL)
        task->asked = SUPERVISOR_CANCEL;
    lock_give(&s->lock);
    if (task == NULL)
        return bf_fail(err, BF_ECONFLICT, "", "the run is not running");
    ring(s);
    return BF_OK;
}

bf_status supervisor_kill(supervisor *s, const char *run_id, bf_error *err)
{
    (void)err;
    lock_take(&s->lock);
    supervisor__task *task = find_task(s, run_id);
    if (task != NULL) {
        task->asked = SUPERVISOR_KILL;
        ring(s);
    }
    while (task != NULL) {
        (void)lock_wait(&s->changed, &s->lock, -1);
        task = find_task(s, run_id);
    }
    lock_give(&s->lock);
    return BF_OK;
}

supervisor *supervisor_stop(supervisor *s, int64_t grace_ms)
{
    if (s == NULL)
        return NULL;
    lock_take(&s->lock);
    s->is_stopping = true;
    s->grace_ms = grace_ms;
    lock_give(&s->lock);
    ring(s);
    BF_CHECK(pthread_join(s->thread, NULL) == 0);
    free_supervisor(s);
    return NULL;
}
