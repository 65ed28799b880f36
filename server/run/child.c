#include "server/run/child.h"

#include "server/base/process.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <sys/pidfd.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum {
    PIPE_BYTES = 1024 * 1024, // asked for in the pipe of a child's output
    NUMBER_TEXT = 24,
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

void child_close_one(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

void child_close_pipes(child *c)
{
    child_close_one(&c->in);
    child_close_one(&c->out);
    child_close_one(&c->err);
}

static void close_pipes(pipes *p)
{
    child_close_one(&p->in.read);
    child_close_one(&p->in.write);
    child_close_one(&p->out.read);
    child_close_one(&p->out.write);
    child_close_one(&p->err.read);
    child_close_one(&p->err.write);
}

static bool open_pipe(ends *ret_ends)
{
    int fds[2];

    if (pipe2(fds, O_CLOEXEC) != 0)
        return false;
    *ret_ends = (ends){ .read = fds[0], .write = fds[1] };
    return true;
}

// Our ends do not block; the child's do. A smaller output pipe than asked for is no failure.
static bool open_pipes(pipes *p)
{
    if (!open_pipe(&p->in) || !open_pipe(&p->out) || !open_pipe(&p->err))
        return false;
    (void)fcntl(p->out.read, F_SETPIPE_SZ, PIPE_BYTES);
    return fcntl(p->in.write, F_SETFL, O_NONBLOCK) == 0 &&
           fcntl(p->out.read, F_SETFL, O_NONBLOCK) == 0 &&
           fcntl(p->err.read, F_SETFL, O_NONBLOCK) == 0;
}

// Returns 0 or an errno.
static int spawn(const char *program, const executor_limits *limits, const pipes *p, pid_t *ret_pid)
{
    char memory[NUMBER_TEXT], cpu[NUMBER_TEXT], parent[NUMBER_TEXT], checkpoint[NUMBER_TEXT];
    const char *const argv[] = { "beltflow", "worker",  "--memory-bytes",
                                 memory,     "--cpu-s", cpu,
                                 "--parent", parent,    "--checkpoint-ms",
                                 checkpoint, NULL };
    const int fds[] = { p->in.read, p->out.write, p->err.write };

    snprintf(memory, sizeof memory, "%" PRIu64, limits->memory_bytes);
    snprintf(cpu, sizeof cpu, "%" PRIu64, limits->cpu_s);
    snprintf(parent, sizeof parent, "%ld", (long)getpid());
    snprintf(checkpoint, sizeof checkpoint, "%" PRId64, limits->checkpoint_ms);
    return process_spawn(program, argv, fds, ret_pid);
}

int child_start(const char *program, const executor_limits *limits, child *c)
{
    pipes p = { { -1, -1 }, { -1, -1 }, { -1, -1 } };
    pid_t pid = 0;

    int error = open_pipes(&p) ? spawn(program, limits, &p, &pid) : errno;
    const int exit = error == 0 ? pidfd_open(pid, 0) : -1;
    if (error == 0 && exit < 0) {
        error = errno;
        kill(-pid, SIGKILL);
        waitpid(pid, NULL, 0);
    }
    if (error != 0) {
        close_pipes(&p);
        return error;
    }
    *c =
        (child){ .pid = pid, .exit = exit, .in = p.in.write, .out = p.out.read, .err = p.err.read };
    p.in.write = p.out.read = p.err.read = -1;
    close_pipes(&p);
    return 0;
}

static double seconds_of(const struct timeval *t)
{
    return (double)t->tv_sec + 1e-6 * (double)t->tv_usec;
}

bool child_reap(child *c)
{
    siginfo_t info = { .si_pid = 0 };
    struct rusage used = { .ru_maxrss = 0 };

    if (c->pid == 0)
        return true;
    // First look, while the group is still known to be the child's; only then free the pid.
    if (waitid(P_PID, (id_t)c->pid, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0)
        return false;
    kill(-c->pid, SIGKILL);
    if (wait4(c->pid, &c->status, 0, &used) != c->pid)
        c->status = SIGKILL; // already reaped elsewhere
    c->used_s = fmax(c->used_s, seconds_of(&used.ru_utime) + seconds_of(&used.ru_stime));
    c->peak_bytes = (uint64_t)used.ru_maxrss * 1024;
    c->pid = 0;
    return true;
}

void child_stop(const child *c, bool by_force)
{
    if (c->pid > 0)
        kill(by_force ? -c->pid : c->pid, by_force ? SIGKILL : SIGTERM);
}

void child_end(child *c)
{
    struct pollfd end = { .fd = c->exit, .events = POLLIN };

    child_stop(c, true);
    while (!child_reap(c))
        (void)poll(&end, 1, -1);
    child_close_pipes(c);
    child_close_one(&c->exit);
}

double child_cpu_s(child *c)
{
    struct timespec used;
    clockid_t clock;

    if (c->pid != 0 && clock_getcpuclockid(c->pid, &clock) == 0 && clock_gettime(clock, &used) == 0)
        c->used_s = fmax(c->used_s, (double)used.tv_sec + 1e-9 * (double)used.tv_nsec);
    return c->used_s;
}
