#include "server/run/supervisor_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/thread.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum {
    STOP_GRACE_MS = 5000, // from a graceful stop, or the last frame, to a stop by force
    LOST_MS = 30000,      // from that until the job counts as lost
};

void supervisor__wake_loop(supervisor *s)
{
    uint64_t one = 1;

    // It can only fail when wake_fd is readable already.
    if (write(s->wake_fd, &one, sizeof one) < 0)
        return;
}

static void request_stop(supervisor__task *task, supervisor__stop how)
{
    if (task->requested < how)
        task->requested = how;
}

// Read the outstanding stop requests, if there may be new ones. What cannot be read is read in the next turn.
static void read_stop_requests(supervisor *s)
{
    const uint64_t n_requests = store_count_stop_requests(s->store);
    store_running *running = s->running;
    size_t n = 0;

    lock_acquire(&s->lock);
    const bool may_stop = s->may_stop;
    s->may_stop = false;
    lock_release(&s->lock);
    if (!may_stop && n_requests == s->n_stop_requests)
        return;
    if (store_list_running(s->store, SUPERVISOR_TASKS_MAX, running, &n, NULL) != BF_OK) {
        lock_acquire(&s->lock);
        s->may_stop = true;
        lock_release(&s->lock);
        return;
    }
    s->n_stop_requests = n_requests;
    for (size_t k = 0; k < n; k++) {
        for (size_t i = 0; running[k].stop_request != STORE_STOP_NONE && i < s->n_tasks; i++) {
            supervisor__task *task = s->tasks[i];
            if (task->phase == SUPERVISOR_SOLVING &&
                strcmp(running[k].id, task->claimed.run.id) == 0)
                request_stop(task, running[k].stop_request == STORE_STOP_CANCEL
                                       ? SUPERVISOR_STOP_CANCEL
                                       : SUPERVISOR_STOP_KILL);
        }
    }
}

// True if that is news: else the loop was told already, and looks at the queue when it can.
static bool allow_claim(supervisor *s)
{
    lock_acquire(&s->lock);
    const bool is_news = !s->may_claim;
    s->may_claim = true;
    lock_release(&s->lock);
    return is_news;
}

// Of a job that ended before its run: its frames end too early, or nothing could be started.
static void attribute_end(supervisor__task *task)
{
    const api_job_cause cause = task->exit.cause;
    bf_error why = task->exit.error;

    if (task->failed || task->has_ended || task->state != EXECUTOR_ENDED)
        return;
    if ((cause == API_JOB_EXITED || cause == API_JOB_FAILED) && task->output.n > 0)
        (void)bf_fail(&why, BF_ECORRUPT, "", "the solver's output ends inside a frame");
    else if (cause == API_JOB_EXITED)
        (void)bf_fail(&why, BF_ECORRUPT, "", "the solver's output ends before the run");
    else if (cause != API_JOB_UNSTARTED)
        return;
    (void)supervisor__attribute_fault(task, &why);
}

// A failure that only one has seen, elsewhere, may be that one's: the run is tried again, and fails for good when another
// attempt fails in the same way.
static void doubt_failure(supervisor__task *task)
{
    executor *e = task->supervisor->executor;
    store_ending *ending = &task->ending;
    const bf_error why = ending->error;

    if (ending->state != RUN_FAILED || task->requested != SUPERVISOR_STOP_NONE ||
        task->job == NULL || e->functions->confirm == NULL ||
        e->functions->confirm(e, task->job, &why))
        return;
    ending->state = RUN_QUEUED;
    ending->attempt = STORE_ATTEMPT_FAILED;
    (void)bf_fail(&ending->error, BF_ESYSTEM, "", "%s", why.text);
}

// The job is over, and of what it has sent only the last is not stored. The place of a run that has succeeded is free:
// the next one is claimed together with its end. One that ends in another way may have met what the next would meet.
static void begin_end(supervisor__task *task)
{
    const store_batch *last = supervisor__last_batch(task);
    supervisor *s = task->supervisor;

    metrics_add(METRICS_CHILD_EXITS, supervisor__exit_reason(task), 1);
    attribute_end(task);
    task->ending = supervisor__classify_exit(task);
    doubt_failure(task);
    task->ending.last = last;
    task->ending.cpu_s = supervisor__cpu_s(task);
    task->phase = SUPERVISOR_ENDING;
    task->is_solved = task->ending.state == RUN_SUCCEEDED;
    if (task->is_solved)
        (void)allow_claim(s);
    supervisor__begin_end(task, task->is_solved ? supervisor__create_claiming(s) : NULL);
}

static void finish_end(supervisor *s, supervisor__task *task)
{
    // Where there is no job, that was noted when it could not be started.
    bool is_back_unasked = task->job != NULL && task->ending.state == RUN_QUEUED &&
                           task->requested == SUPERVISOR_STOP_NONE;
    // Another worker takes the run.
    bool is_of_worker = supervisor__has_workers(s) && !task->is_store_error;

    // What the store would not take, or cannot be of the scenario.
    if (task->ending.state == RUN_QUEUED && task->ending.error.code == BF_ECORRUPT &&
        !task->is_fault_of_worker && task->job != NULL)
        (void)supervisor__attribute_fault(task, &task->ending.error);
    if (task->is_solved && task->ending.state == RUN_SUCCEEDED && task->write.status == BF_OK &&
        s->executor->functions->confirm != NULL)
        (void)s->executor->functions->confirm(s->executor, task->job, NULL);
    if (task->write.status != BF_OK)
        supervisor__defer(s, task->claimed.run.id,
                          task->requested >= SUPERVISOR_STOP_CANCEL ? RUN_CANCELLED : RUN_QUEUED,
                          task->ending.cpu_s);
    else if (is_back_unasked && is_of_worker)
        supervisor_wake(s);
    // Trouble of the store or of the executor would make the next run end the same way.
    else if (is_back_unasked && task->ending.error.code != BF_OK)
        supervisor__note_trouble(s, &task->ending.error);
    else if (is_back_unasked || (task->failed && task->error.code == BF_ESYSTEM))
        supervisor__backoff(s);
    if (!task->is_solved)
        supervisor_wake(s); // there is room for another run
    else
        supervisor__prepare_job(s); // a program that fails is not started without need
    supervisor__task_destroy(task);
}

// Take the result of the task's write. False: it is still pending, or the task was freed.
static bool finish_write(supervisor *s, supervisor__task *task)
{
    if (!task->write.is_pending)
        return true;
    if (!atomic_load(&task->write.is_done))
        return false;
    task->write.is_pending = false;
    switch (task->write.kind) {
    case SUPERVISOR_WRITE_CLAIM:
        supervisor__finish_claim(task);
        return false;
    case SUPERVISOR_WRITE_ID:
        return true; // without it the job is not found after a restart, and the run starts again
    case SUPERVISOR_WRITE_BATCH:
        supervisor__finish_batch(task);
        return true;
    default:
        finish_end(s, task);
        return false;
    }
}

static void advance_task(supervisor *s, supervisor__task *task)
{
    if (!finish_write(s, task))
        return;
    supervisor__read_frames(task);
    bool is_over = task->state == EXECUTOR_ENDED || task->state == EXECUTOR_LOST;
    bool is_taken = task->failed || !task->has_frames;
    if (is_over && is_taken && !task->write.is_pending)
        begin_end(task);
}

static void wait_for_events(supervisor *s)
{
    executor *e = s->executor;
    struct pollfd fds[] = { { .fd = s->wake_fd, .events = POLLIN },
                            { .fd = e->wake_fd, .events = POLLIN } };
    uint64_t n_wakes;

    if (poll(fds, sizeof fds / sizeof *fds, supervisor__find_timeout(s)) <= 0)
        return;
    if (fds[0].revents != 0 && read(s->wake_fd, &n_wakes, sizeof n_wakes) < 0)
        return;
    if (fds[1].revents != 0)
        e->functions->update(e);
}

// While the supervisor is stopping, hand back every task. Returns true if there is nothing left to wait
// for.
static bool is_over(supervisor *s, int64_t *ret_grace_ms)
{
    lock_acquire(&s->lock);
    bool is_stopping = s->is_stopping;
    *ret_grace_ms = s->grace_ms;
    lock_release(&s->lock);
    if (is_stopping && supervisor__has_workers(s)) {
        // Jobs of workers are left to the daemon after this one, which knows them by what is stored of them: workers hear of no
        // stop any more. Of trials nothing is stored, so they are queued again.
        for (size_t i = s->n_tasks; i > 0; i--) {
            supervisor__task *task = s->tasks[i - 1];
            if (task->phase != SUPERVISOR_SOLVING || task->write.is_pending)
                continue;
            if (task->claimed.run.study[0] != '\0') {
                task->requested = task->signalled = SUPERVISOR_STOP_HAND_BACK;
                task->state = EXECUTOR_LOST;
            } else {
                supervisor__task_destroy(task);
            }
        }
    }
    for (size_t i = 0; is_stopping && i < s->n_tasks; i++)
        if (!supervisor__has_workers(s) || s->tasks[i]->phase == SUPERVISOR_CLAIMING)
            request_stop(s->tasks[i], SUPERVISOR_STOP_HAND_BACK);
    return is_stopping && s->n_tasks == 0;
}

static void *run_loop(void *context)
{
    supervisor *s = context;
    int64_t grace_ms = 0;

    supervisor__attach(s);
    supervisor__claim(s);
    while (!is_over(s, &grace_ms)) {
        liveness_answer(&s->liveness);
        read_stop_requests(s);
        for (size_t i = 0; i < s->n_tasks; i++)
            supervisor__enforce(s->tasks[i], grace_ms);
        wait_for_events(s);
        // From the last, because one that is destroyed leaves its place to the last.
        for (size_t i = s->n_tasks; i > 0; i--)
            advance_task(s, s->tasks[i - 1]);
        lock_acquire(&s->lock);
        if (s->has_new_options) {
            s->options = s->new_options;
            s->has_new_options = false;
            s->may_claim = true;
        }
        lock_release(&s->lock);
        supervisor__claim(s);
        // The figures of what is being solved, all runs of a model together.
        int64_t rates[RUN_MODEL_COUNT] = { 0 }, items[RUN_MODEL_COUNT] = { 0 };
        for (size_t i = 0; i < s->n_tasks; i++) {
            const supervisor__task *task = s->tasks[i];
            const frame_begin *b = &task->begin;
            if (task->phase == SUPERVISOR_CLAIMING)
                continue;
            rates[task->claimed.run.model] += (int64_t)task->rate;
            items[task->claimed.run.model] +=
                (int64_t)(b->n_values > 0 ? b->n_parts : b->grid.n1 * b->grid.n2);
        }
        for (size_t model = 0; model < RUN_MODEL_COUNT; model++) {
            metrics_set(METRICS_SOLVER_RATE, model, rates[model]);
            metrics_set(METRICS_SOLVER_ITEMS, model, items[model]);
        }
    }
    return NULL;
}

static void free_supervisor(supervisor *s)
{
    supervisor__stop_writers(s);
    if (s->wake_fd >= 0)
        close(s->wake_fd);
    lock_fini(&s->lock);
    memory_free(s->tasks);
    memory_free(s->pending);
    memory_free(s->running);
    memory_free(s);
}

// The options with what 0 stands for.
static supervisor_options complete(const supervisor_options *options)
{
    supervisor_options o = *options;

    BF_CHECK(o.n_workers >= 1 && o.n_workers <= SUPERVISOR_WORKERS_MAX);
    BF_CHECK(o.n_threads >= 1);
    if (o.stop_grace_ms == 0)
        o.stop_grace_ms = STOP_GRACE_MS;
    if (o.lost_ms == 0)
        o.lost_ms = LOST_MS;
    return o;
}

static supervisor *create_supervisor(const supervisor_options *options)
{
    supervisor *s = memory_alloc(1, sizeof *s);
    supervisor__task **tasks = memory_alloc(SUPERVISOR_TASKS_MAX, sizeof(supervisor__task *));
    supervisor__pending_update *pending = memory_alloc(SUPERVISOR_TASKS_MAX, sizeof *pending);
    store_running *running = memory_alloc(SUPERVISOR_TASKS_MAX, sizeof *running);

    if (s == NULL || tasks == NULL || pending == NULL || running == NULL) {
        memory_free(s);
        memory_free(tasks);
        memory_free(pending);
        memory_free(running);
        return NULL;
    }
    s->store = options->store;
    s->executor = options->executor;
    s->options = complete(options);
    s->tasks = tasks;
    s->pending = pending;
    s->running = running;
    s->may_claim = s->may_stop = true;
    s->backoff_ms = SUPERVISOR_BACKOFF_FIRST_MS;
    s->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    lock_init(&s->lock);
    return s;
}

bf_status supervisor_start(const supervisor_options *options, supervisor **ret_supervisor,
                           bf_error *err)
{
    supervisor *s = create_supervisor(options);

    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the supervisor");
    const int error = s->wake_fd < 0 ? errno : 0;
    bf_status status = supervisor__start_writers(s, err);
    if (status == BF_OK && error != 0)
        status =
            bf_fail(err, BF_ESYSTEM, "", "no descriptor for the supervisor: %s", strerror(error));
    if (status == BF_OK)
        status = thread_start(&s->thread, run_loop, s, "the supervisor", err);
    if (status != BF_OK) {
        free_supervisor(s);
        return status;
    }
    *ret_supervisor = s;
    return BF_OK;
}

void supervisor_reconfigure(supervisor *s, const supervisor_options *options)
{
    lock_acquire(&s->lock);
    s->new_options = complete(options);
    s->has_new_options = true;
    lock_release(&s->lock);
    supervisor__wake_loop(s);
}

bool supervisor_is_alive(supervisor *s)
{
    bool is_alive = !liveness_is_asked(&s->liveness);

    liveness_ask(&s->liveness);
    supervisor__wake_loop(s);
    return is_alive;
}

void supervisor_wake(supervisor *s)
{
    if (allow_claim(s))
        supervisor__wake_loop(s);
}

void supervisor_notify(supervisor *s)
{
    if (store_count_stop_requests(s->store) != s->n_stop_requests)
        supervisor__wake_loop(s);
}

supervisor *supervisor_stop(supervisor *s, int64_t grace_ms)
{
    if (s == NULL)
        return NULL;
    lock_acquire(&s->lock);
    s->is_stopping = true;
    s->grace_ms = grace_ms;
    lock_release(&s->lock);
    supervisor__wake_loop(s);
    BF_CHECK(pthread_join(s->thread, NULL) == 0);
    free_supervisor(s);
    return NULL;
}
