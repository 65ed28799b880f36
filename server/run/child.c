#include "server/run/child.h"

#include "core/base/check.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    READ_CHUNK = 256 * 1024,
    ERROR_READS = 16, // a turn: what a pipe holds, so that no flood of words keeps the loop
};

// The two ends of a pipe.
typedef struct ends {
    int read;
    int write;
} ends;

typedef struct pipes {
    ends in;
    ends out;
    ends err;
} pipes;

static void close_fd(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

static void close_pipes(pipes *p)
{
    close_fd(&p->in.read);
    close_fd(&p->in.write);
    close_fd(&p->out.read);
    close_fd(&p->out.write);
    close_fd(&p->err.read);
    close_fd(&p->err.write);
}

static bool open_pipe(ends *ret_ends)
{
    int fds[2];

    if (pipe2(fds, O_CLOEXEC) != 0)
        return false;
    *ret_ends = (ends){ .read = fds[0], .write = fds[1] };
    return true;
}

// Our ends do not block; the child's do. More room in its output pipe than the system wants to give
// is no need.
static bool open_pipes(pipes *p)
{
    if (!open_pipe(&p->in) || !open_pipe(&p->out) || !open_pipe(&p->err))
        return false;
    (void)fcntl(p->out.read, F_SETPIPE_SZ, CHILD_PIPE_BYTES);
    return fcntl(p->in.write, F_SETFL, O_NONBLOCK) == 0 &&
           fcntl(p->out.read, F_SETFL, O_NONBLOCK) == 0 &&
           fcntl(p->err.read, F_SETFL, O_NONBLOCK) == 0;
}

// Returns 0 or an errno.
static int spawn(const char *program, char *const *argv, const pipes *p, pid_t *ret_pid)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;

    int error = posix_spawn_file_actions_init(&actions);
    if (error != 0)
        return error;
    posix_spawnattr_init(&attributes);
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF |
                                              POSIX_SPAWN_SETPGROUP);
    error = posix_spawn_file_actions_adddup2(&actions, p->in.read, STDIN_FILENO);
    if (error == 0)
        error = posix_spawn_file_actions_adddup2(&actions, p->out.write, STDOUT_FILENO);
    if (error == 0)
        error = posix_spawn_file_actions_adddup2(&actions, p->err.write, STDERR_FILENO);
    if (error == 0)
        error = posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    if (error == 0)
        error = posix_spawn(ret_pid, program, &actions, &attributes, argv, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

static bf_status fail_start(const char *program, int error, bf_error *err)
{
    bool is_passing =
        error == EAGAIN || error == ENOMEM || error == EMFILE || error == ENFILE || error == EINTR;

    return bf_fail(err, is_passing ? BF_EBUSY : BF_ESYSTEM, "", "%s cannot be started: %s", program,
                   strerror(error));
}

bf_status child_start(const char *program, char *const *argv, bf_buffer *input, child *ret_child,
                      bf_error *err)
{
    pipes p = { { -1, -1 }, { -1, -1 }, { -1, -1 } };
    pid_t pid = 0;

    int error = open_pipes(&p) ? spawn(program, argv, &p, &pid) : errno;
    if (error != 0) {
        close_pipes(&p);
        return fail_start(program, error, err);
    }
    int pidfd = pidfd_open(pid, 0);
    if (pidfd < 0) {
        error = errno;
        kill(-pid, SIGKILL);
        waitpid(pid, NULL, 0);
        close_pipes(&p);
        return fail_start(program, error, err);
    }
    close_fd(&p.in.read);
    close_fd(&p.out.write);
    close_fd(&p.err.write);
    *ret_child = (child){ .pid = pid,
                          .pidfd = pidfd,
                          .in = p.in.write,
                          .out = p.out.read,
                          .err = p.err.read,
                          .input = *input };
    *input = (bf_buffer){ 0 };
    return BF_OK;
}

void child_feed(child *c)
{
    while (c->in >= 0 && c->n_fed < c->input.n) {
        ssize_t put = write(c->in, c->input.bytes + c->n_fed, c->input.n - c->n_fed);
        if (put < 0 && errno == EAGAIN)
            return;
        if (put < 0 && errno != EINTR)
            break;
        c->n_fed += put > 0 ? (size_t)put : 0;
    }
    close_fd(&c->in);
    buffer_fini(&c->input);
}

bool child_read_output(child *c, size_t limit, bf_status *ret_status)
{
    for (size_t n = 0; c->out >= 0 && n < limit;) {
        char *end = buffer_reserve(&c->output, READ_CHUNK);
        if (end == NULL) {
            *ret_status = BF_ENOMEM;
            return false;
        }
        ssize_t got = read(c->out, end, READ_CHUNK);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0 && errno == EAGAIN)
            return false;
        if (got <= 0)
            close_fd(&c->out);
        c->output.n += got > 0 ? (size_t)got : 0;
        n += got > 0 ? (size_t)got : 0;
    }
    return c->out >= 0;
}

// What is longer than a line's room is left out.
static void take_errors(child *c, const char *bytes, size_t n, child_take_line *take, void *context)
{
    for (size_t i = 0; i < n; i++) {
        if (bytes[i] != '\n') {
            if (c->n_line < sizeof c->line - 1)
                c->line[c->n_line++] = bytes[i] == '\0' ? '?' : bytes[i];
            continue;
        }
        c->line[c->n_line] = '\0';
        c->n_line = 0;
        memcpy(c->last, c->line, sizeof c->last);
        take(context, c->last);
    }
}

void child_read_errors(child *c, child_take_line *take, void *context)
{
    char bytes[4096];

    for (int i = 0; c->err >= 0 && i < ERROR_READS; i++) {
        ssize_t got = read(c->err, bytes, sizeof bytes);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0 && errno == EAGAIN)
            return;
        if (got > 0) {
            take_errors(c, bytes, (size_t)got, take, context);
            continue;
        }
        if (c->n_line > 0)
            take_errors(c, "\n", 1, take, context);
        close_fd(&c->err);
    }
}

void child_signal(const child *c, int signal_number)
{
    if (c->pid > 0)
        kill(signal_number == SIGKILL ? -c->pid : c->pid, signal_number);
}

bool child_reap(child *c, int *ret_status)
{
    siginfo_t info = { .si_pid = 0 };
    int status;

    // First look, so that the group is still ours to be killed; only then let the pid go.
    if (waitid(P_PID, (id_t)c->pid, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0)
        return false;
    kill(-c->pid, SIGKILL);
    if (waitpid(c->pid, &status, 0) != c->pid)
        status = SIGKILL; // somebody else took the word of it
    c->pid = 0;
    *ret_status = status;
    return true;
}

void child_wait(child *c)
{
    struct pollfd end = { .fd = c->pidfd, .events = POLLIN };
    int status;

    while (!child_reap(c, &status))
        (void)poll(&end, 1, -1);
}

void child_describe_end(const child *c, int status, uint64_t memory_bytes, uint64_t cpu_s,
                        bf_error *ret_error)
{
    char how[160];
    bf_status code = BF_ESYSTEM;
    int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;

    if (number == SIGXCPU) {
        code = BF_ELIMIT;
        snprintf(how, sizeof how, "the solver used up its limit of %llu CPU seconds",
                 (unsigned long long)cpu_s);
    } else if (number == SIGKILL) {
        code = BF_ENOMEM;
        snprintf(how, sizeof how,
                 "the solver was killed (SIGKILL), most likely because the machine is out of "
                 "memory; its limit is %llu bytes",
                 (unsigned long long)memory_bytes);
    } else if (number != 0) {
        const char *name = sigabbrev_np(number);
        snprintf(how, sizeof how, "the solver crashed (SIG%s)", name == NULL ? "?" : name);
    } else {
        snprintf(how, sizeof how, "the solver ended with exit code %d before the end of the run",
                 WEXITSTATUS(status));
    }
    (void)bf_fail(ret_error, code, "", "%s%s%.120s", how,
                  c->last[0] == '\0' ? "" : "; it said: ", c->last);
}

void child_fini(child *c)
{
    if (c == NULL)
        return;
    BF_CHECK(c->pid == 0);
    if (c->pidfd > 0) {
        close_fd(&c->pidfd);
        close_fd(&c->in);
        close_fd(&c->out);
        close_fd(&c->err);
    }
    buffer_fini(&c->input);
    buffer_fini(&c->output);
    *c = (child){ .in = -1, .out = -1, .err = -1, .pidfd = -1 };
}
