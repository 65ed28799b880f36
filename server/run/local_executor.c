// Child processes behind the table of executor.h. One epoll descriptor, which is wake_fd, watches the pipes
// and the pidfd of every child. Standard output is watched edge-triggered: a job that the supervisor
// does not read does not wake it again and again, and its child blocks when the pipe is full.

#include "server/run/local_executor.h"

#include "core/base/memory.h"
#include "server/base/log.h"
#include "server/run/child.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    TRIAL_NICE = 10,
    LINE_SIZE = 240,        // of a line of stderr with its terminator; the rest is left out
    LINES_LOGGED_MAX = 100, // of a job
    ERROR_READS = 16,       // a turn: what a pipe holds, so that no flood of words blocks the loop
    EVENTS_MAX = 64,
    EXIT_NOT_EXECUTABLE = 126, // of shells and of the dynamic loader, for a program that
    EXIT_NOT_FOUND = 127,      // cannot be executed, or lacks a library
};

// What an event of a job's descriptors is about.
typedef enum source {
    SOURCE_INPUT,
    SOURCE_OUTPUT,
    SOURCE_ERROR,
    SOURCE_EXIT,
    SOURCE_COUNT,
} source;

// What an epoll event points at.
typedef struct watch {
    source about;
    executor_job *job;
} watch;

struct executor_job {
    char id[EXECUTOR_ID_SIZE];
    char run_id[64];        // for the log
    executor_limits limits; // that it was started with
    child child;
    bf_buffer input; // what the child is to read
    size_t n_written;
    bool has_output;      // there may be something to read from out
    char line[LINE_SIZE]; // of stderr, as far as it has come
    size_t n_line;
    char last_line[LINE_SIZE]; // the last complete one
    unsigned n_logged;
    bool has_spoken;    // bytes have come from out
    bool is_released;   // freed when it is reaped
    executor_job *next; // in the executor's list of released jobs
    watch watches[SOURCE_COUNT];
};

typedef struct local_executor {
    executor base;
    const char *program;
    executor_job *released; // jobs that were released before their child had ended
    executor_job *spare;    // whose child waits for its input; NULL: none
} local_executor;

static bf_status fail_start(const char *program, int error, bf_error *err)
{
    bool may_work_later =
        error == EAGAIN || error == ENOMEM || error == EMFILE || error == ENFILE || error == EINTR;

    return bf_fail(err, may_work_later ? BF_EBUSY : BF_ESYSTEM, "", "%s cannot be started: %s",
                   program, strerror(error));
}

static bool watch_fd(const executor *e, executor_job *job, int fd, uint32_t events, source about)
{
    struct epoll_event event = { .events = events, .data.ptr = &job->watches[about] };

    job->watches[about] = (watch){ about, job };
    return epoll_ctl(e->wake_fd, EPOLL_CTL_ADD, fd, &event) == 0;
}

static void destroy_job(executor_job *job)
{
    child_end(&job->child);
    buffer_fini(&job->input);
    memory_free(job);
}

// A job whose child waits for its input, and whose end is watched. Returns 0 or an errno.
static int create_job(local_executor *e, const executor_limits *limits, executor_job **ret_job)
{
    executor_job *job = memory_alloc(1, sizeof *job);

    if (job == NULL)
        return ENOMEM;
    job->limits = *limits;
    job->child = CHILD_NONE;
    int error = child_start(e->program, limits, &job->child);
    if (error == 0 && !watch_fd(&e->base, job, job->child.exit, EPOLLIN, SOURCE_EXIT))
        error = errno;
    if (error == 0)
        *ret_job = job;
    else
        destroy_job(job);
    return error;
}

// The spare, if it still waits and has these limits; else there is none any more.
static executor_job *take_spare(local_executor *e, const executor_limits *limits)
{
    executor_job *spare = e->spare;

    e->spare = NULL;
    if (spare == NULL ||
        (!child_reap(&spare->child) && memcmp(&spare->limits, limits, sizeof *limits) == 0))
        return spare;
    destroy_job(spare);
    return NULL;
}

// Write what the child's input takes; close it after the last byte, or when it is not read any more.
static void write_input(executor_job *job)
{
    while (job->child.in >= 0 && job->n_written < job->input.n) {
        ssize_t n =
            write(job->child.in, job->input.bytes + job->n_written, job->input.n - job->n_written);
        if (n < 0 && errno == EAGAIN)
            return;
        if (n < 0 && errno != EINTR)
            break;
        job->n_written += n > 0 ? (size_t)n : 0;
    }
    child_close_one(&job->child.in);
    buffer_fini(&job->input);
}

// The effective user counts, as in execve().
static bf_status ready(executor *base, bf_error *err)
{
    const local_executor *e = (const local_executor *)base;
    struct stat info;
    int error = stat(e->program, &info) != 0 ? errno : 0;

    if (error == 0 && !S_ISREG(info.st_mode))
        error = EACCES;
    if (error == 0 && faccessat(AT_FDCWD, e->program, X_OK, AT_EACCESS) != 0)
        error = errno;
    return error == 0 ? BF_OK : fail_start(e->program, error, err);
}

// Give the child its work.
static bf_status hand_over(const local_executor *e, const executor_work *work, executor_job *job,
                           bf_error *err)
{
    BF_TRY(executor_encode(work, &job->input, err));
    snprintf(job->id, sizeof job->id, "local:%ld", (long)job->child.pid);
    snprintf(job->run_id, sizeof job->run_id, "%s", work->run_id);
    // Runs by themselves are solved beside trials, and are to have the cores.
    if (work->is_trial && setpriority(PRIO_PROCESS, (id_t)job->child.pid, TRIAL_NICE) != 0) {
        // Once: it is the service manager that forbids it, and goes on doing so.
        static atomic_flag has_warned = ATOMIC_FLAG_INIT;
        if (!atomic_flag_test_and_set(&has_warned))
            log_event(LOG_LEVEL_WARN, "trials_have_no_priority",
                      "error=\"trials cannot be solved at a lower priority: %s\"", strerror(errno));
    }
    if (!watch_fd(&e->base, job, job->child.in, EPOLLOUT, SOURCE_INPUT) ||
        !watch_fd(&e->base, job, job->child.out, EPOLLIN | EPOLLET, SOURCE_OUTPUT) ||
        !watch_fd(&e->base, job, job->child.err, EPOLLIN, SOURCE_ERROR))
        return fail_start(e->program, errno, err);
    write_input(job);
    return BF_OK;
}

static bf_status start(executor *base, const executor_work *work, executor_job **ret_job,
                       bf_error *err)
{
    local_executor *e = (local_executor *)base;
    executor_job *job = take_spare(e, &work->limits);
    int error = job == NULL ? create_job(e, &work->limits, &job) : 0;

    if (error != 0)
        return fail_start(e->program, error, err);
    const bf_status status = hand_over(e, work, job, err);
    if (status != BF_OK) {
        destroy_job(job);
        return status;
    }
    *ret_job = job;
    return BF_OK;
}

static void prepare(executor *base, const executor_limits *limits)
{
    local_executor *e = (local_executor *)base;

    if (e->spare == NULL)
        (void)create_job(e, limits, &e->spare);
}

static bf_status attach(executor *base, const char *external_id, executor_job **ret_job,
                        bf_error *err)
{
    (void)base;
    (void)ret_job;
    return bf_fail(err, BF_ENOTFOUND, "", "there is no child process %s any more", external_id);
}

static void stop(executor *base, executor_job *job, executor_stop how)
{
    (void)base;
    child_stop(&job->child, how == EXECUTOR_STOP_NOW);
}

static void take_error_bytes(executor_job *job, const char *bytes, size_t n)
{
    char quoted[LOG_QUOTED_SIZE];

    for (size_t i = 0; i < n; i++) {
        if (bytes[i] != '\n') {
            if (job->n_line < sizeof job->line - 1)
                job->line[job->n_line++] = bytes[i] == '\0' ? '?' : bytes[i];
            continue;
        }
        job->line[job->n_line] = '\0';
        job->n_line = 0;
        memcpy(job->last_line, job->line, sizeof job->last_line);
        if (job->n_logged++ < LINES_LOGGED_MAX)
            log_event(LOG_LEVEL_WARN, "run_said", "run=%s text=%s", job->run_id,
                      log_quote(job->last_line, quoted));
    }
}

static void read_errors(executor_job *job)
{
    char bytes[4096];

    for (int i = 0; job->child.err >= 0 && i < ERROR_READS; i++) {
        ssize_t n = read(job->child.err, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0 && errno == EAGAIN)
            return;
        if (n > 0) {
            take_error_bytes(job, bytes, (size_t)n);
            continue;
        }
        if (job->n_line > 0)
            take_error_bytes(job, "\n", 1);
        child_close_one(&job->child.err);
    }
}

static void forget_released(local_executor *e, executor_job *job)
{
    for (executor_job **at = &e->released; *at != NULL; at = &(*at)->next) {
        if (*at == job) {
            *at = job->next;
            break;
        }
    }
    destroy_job(job);
}

static void take_exit(local_executor *e, executor_job *job)
{
    if (!child_reap(&job->child))
        return;
    job->has_output = true;
    child_close_one(&job->child.exit);
    if (job->is_released)
        forget_released(e, job);
}

static void update(executor *base)
{
    struct epoll_event events[EVENTS_MAX];

    int n = epoll_wait(base->wake_fd, events, EVENTS_MAX, 0);
    for (int i = 0; i < n; i++) {
        watch *w = events[i].data.ptr;
        switch (w->about) {
        case SOURCE_INPUT:
            write_input(w->job);
            break;
        case SOURCE_OUTPUT:
            w->job->has_output = true;
            break;
        case SOURCE_ERROR:
            read_errors(w->job);
            break;
        default:
            // Of a released job nothing else is watched, so no other event here can be of a freed one.
            take_exit((local_executor *)base, w->job);
            break;
        }
    }
}

static api_job_cause classify_end(const executor_job *job)
{
    const int code = WEXITSTATUS(job->child.status);
    const bool is_unstarted =
        !job->has_spoken && (code == EXIT_NOT_EXECUTABLE || code == EXIT_NOT_FOUND);

    if (!WIFSIGNALED(job->child.status))
        return code == EXIT_SUCCESS ? API_JOB_EXITED
               : is_unstarted       ? API_JOB_UNSTARTED
                                    : API_JOB_FAILED;
    switch (WTERMSIG(job->child.status)) {
    case SIGTERM:
        return API_JOB_STOPPED;
    case SIGKILL:
        return API_JOB_KILLED;
    case SIGXCPU:
        return API_JOB_TIMED_OUT;
    default:
        return API_JOB_CRASHED;
    }
}

static void describe_end(const executor_job *job, executor_end *ret_end)
{
    char text[160];
    bf_status code = BF_ESYSTEM;
    const char *name =
        WIFSIGNALED(job->child.status) ? sigabbrev_np(WTERMSIG(job->child.status)) : NULL;

    ret_end->cause = classify_end(job);
    if (ret_end->cause == API_JOB_TIMED_OUT) {
        code = BF_ELIMIT;
        snprintf(text, sizeof text, "the solver used up its limit of %" PRIu64 " CPU seconds",
                 job->limits.cpu_s);
    } else if (ret_end->cause == API_JOB_KILLED) {
        snprintf(text, sizeof text,
                 "the solver was killed from outside (SIGKILL); it had %" PRIu64
                 " MiB of memory at most. The kernel's log tells if memory was short",
                 job->child.peak_bytes >> 20);
    } else if (ret_end->cause == API_JOB_UNSTARTED) {
        snprintf(text, sizeof text, "the solver cannot be executed (exit code %d)",
                 WEXITSTATUS(job->child.status));
    } else if (WIFSIGNALED(job->child.status)) {
        snprintf(text, sizeof text, "the solver crashed (SIG%s)", name == NULL ? "?" : name);
    } else {
        snprintf(text, sizeof text, "the solver ended with exit code %d before the end of the run",
                 WEXITSTATUS(job->child.status));
    }
    (void)bf_fail(&ret_end->error, code, "", "%s%s%.120s", text,
                  job->last_line[0] == '\0' ? "" : "; it said: ", job->last_line);
}

static size_t read_output(executor_job *job, void *bytes, size_t capacity)
{
    while (job->has_output && job->child.out >= 0) {
        ssize_t n = read(job->child.out, bytes, capacity);
        job->has_spoken = job->has_spoken || n > 0;
        if (n > 0)
            return (size_t)n;
        if (n < 0 && errno == EINTR)
            continue;
        job->has_output = false;
        if (n == 0 || errno != EAGAIN)
            child_close_one(&job->child.out);
    }
    return 0;
}

static executor_state poll_job(executor *base, executor_job *job, void *bytes, size_t capacity,
                               size_t *ret_n, executor_end *ret_end)
{
    (void)base;
    *ret_n = read_output(job, bytes, capacity);
    if (*ret_n > 0 || job->child.pid != 0)
        return EXECUTOR_RUNNING;
    read_errors(job);
    describe_end(job, ret_end);
    return EXECUTOR_ENDED;
}

static const char *external_id(const executor_job *job)
{
    return job->id;
}

static double cpu_s(executor *base, executor_job *job)
{
    (void)base;
    return child_cpu_s(&job->child);
}

static void release(executor *base, executor_job *job)
{
    local_executor *e = (local_executor *)base;

    stop(base, job, EXECUTOR_STOP_NOW);
    if (job->child.pid == 0) {
        destroy_job(job);
        return;
    }
    child_close_pipes(&job->child);
    job->is_released = true;
    job->next = e->released;
    e->released = job;
}

bf_status local_executor_create(const char *program, executor **ret_executor, bf_error *err)
{
    static const executor_functions functions = { .ready = ready,
                                                  .prepare = prepare,
                                                  .start = start,
                                                  .attach = attach,
                                                  .stop = stop,
                                                  .update = update,
                                                  .poll = poll_job,
                                                  .cpu_s = cpu_s,
                                                  .external_id = external_id,
                                                  .release = release };
    local_executor *e = memory_alloc(1, sizeof *e);
    int epoll = e == NULL ? -1 : epoll_create1(EPOLL_CLOEXEC);

    if (epoll < 0) {
        memory_free(e);
        return bf_fail(err, BF_ESYSTEM, "", "child processes cannot be watched: %s",
                       strerror(errno));
    }
    *e = (local_executor){ .base = { &functions, epoll }, .program = program };
    *ret_executor = &e->base;
    return BF_OK;
}

executor *local_executor_destroy(executor *base)
{
    local_executor *e = (local_executor *)base;

    if (e == NULL)
        return NULL;
    if (e->spare != NULL)
        destroy_job(e->spare);
    while (e->released != NULL)
        forget_released(e, e->released);
    close(base->wake_fd);
    memory_free(e);
    return NULL;
}
