// Programs of Slurm, each in a process group of its own. What they say on both streams is taken together: a message is wanted
// when one fails, and what squeue prints is told from messages by its form.

#include "server/base/clock.h"
#include "server/base/process.h"
#include "server/slurm/slurm_priv.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TURN_MS = 100, CHUNK = 65536 };

// Its descriptors; -1: none.
typedef struct child {
    pid_t pid;
    int exit;   // readable when it has ended
    int output; // what it prints; does not block
} child;

static void close_fd(int fd)
{
    if (fd >= 0)
        (void)close(fd);
}

static int open_input(const bf_buffer *input)
{
    if (input == NULL)
        return open("/dev/null", O_RDONLY | O_CLOEXEC);
    const int fd = memfd_create("script", MFD_CLOEXEC);
    if (fd >= 0 && write(fd, input->bytes, input->n) == (ssize_t)input->n &&
        lseek(fd, 0, SEEK_SET) == 0)
        return fd;
    close_fd(fd);
    return -1;
}

static bf_status start(const slurm__command *c, child *ret_child, bf_error *err)
{
    int pipe[2] = { -1, -1 };
    const int input = open_input(c->input);
    int error = input < 0 || pipe2(pipe, O_CLOEXEC) != 0 ? errno : 0;

    if (error == 0 && fcntl(pipe[0], F_SETFL, O_NONBLOCK) != 0)
        error = errno;
    if (error == 0)
        error =
            process_spawn(c->argv[0], c->argv, (int[]){ input, pipe[1], pipe[1] }, &ret_child->pid);
    close_fd(input);
    close_fd(pipe[1]);
    if (error != 0) {
        close_fd(pipe[0]);
        return bf_fail(err, BF_ESYSTEM, "", "%s cannot be run: %s", c->argv[0], strerror(error));
    }
    ret_child->output = pipe[0];
    ret_child->exit = pidfd_open(ret_child->pid, 0);
    return BF_OK;
}

// Takes what is there. BF_ELIMIT, BF_ENOMEM.
static bf_status take_output(const child *p, size_t limit, bf_buffer *out, bf_error *err)
{
    for (;;) {
        char *room = buffer_reserve(out, CHUNK);
        if (room == NULL)
            return bf_fail(err, BF_ENOMEM, "", "no memory for what a command of Slurm prints");
        const ssize_t n = read(p->output, room, CHUNK);
        if (n <= 0)
            return BF_OK;
        out->n += (size_t)n;
        if (out->n > limit)
            return bf_fail(err, BF_ELIMIT, "", "a command of Slurm printed more than %d bytes",
                           SLURM_OUTPUT_MAX);
    }
}

// Until it has ended; BF_ESYSTEM: that takes too long, or is to stop.
static bf_status await(const slurm__command *c, const child *p, bf_buffer *out, bf_error *err)
{
    const int64_t deadline_ms = clock_monotonic_ms() + SLURM_COMMAND_MS;
    const size_t limit = out->n + SLURM_OUTPUT_MAX;

    for (;;) {
        struct pollfd fds[] = { { .fd = p->exit, .events = POLLIN },
                                { .fd = p->output, .events = POLLIN } };
        // The output of a program that has closed it stays readable: then only its end is waited for.
        (void)poll(fds, 2, TURN_MS);
        if ((fds[1].revents & (POLLHUP | POLLIN)) == POLLHUP)
            (void)poll(fds, 1, TURN_MS);
        bf_status status = take_output(p, limit, out, err);
        if (status != BF_OK || (fds[0].revents & POLLIN) != 0)
            return status;
        if (atomic_load(c->must_stop) || clock_monotonic_ms() >= deadline_ms)
            return bf_fail(err, BF_ESYSTEM, "", "%s did not end within %d s", c->argv[0],
                           SLURM_COMMAND_MS / 1000);
    }
}

bf_status slurm__run(const slurm__command *c, bf_buffer *out, bf_error *err)
{
    const size_t n_before = out->n;
    child p = { .exit = -1, .output = -1 };
    int code = 0;

    BF_TRY(start(c, &p, err));
    bf_status status = p.exit < 0
                           ? bf_fail(err, BF_ESYSTEM, "", "%s cannot be waited for", c->argv[0])
                           : await(c, &p, out, err);
    if (status != BF_OK)
        (void)kill(-p.pid, SIGKILL);
    while (waitpid(p.pid, &code, 0) < 0 && errno == EINTR)
        continue;
    close_fd(p.exit);
    close_fd(p.output);
    if (status == BF_OK && (!WIFEXITED(code) || WEXITSTATUS(code) != 0)) {
        // The last line, without its end.
        while (out->n > n_before && out->bytes[out->n - 1] == '\n')
            buffer_truncate(out, out->n - 1);
        const char *line =
            out->n == n_before ? NULL : memrchr(out->bytes + n_before, '\n', out->n - n_before);
        if (line != NULL)
            buffer_drop(out, (size_t)(line + 1 - out->bytes));
        status = bf_fail(err, BF_ESYSTEM, "", "%s failed: %s", c->argv[0],
                         out->n == 0 ? "without a message" : out->bytes);
    }
    return status;
}
