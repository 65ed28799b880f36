/// A child process in its own process group, with three pipes and a pidfd for an epoll loop. It
/// knows nothing of runs or frames.
///
/// Safety   started by posix_spawn, with every descriptor but its three pipes closed, no signal
///          blocked or ignored. Its pid cannot be of another process before child_reap().
/// Threads  a child belongs to the thread that started it, which must outlive it: worker programs
///          ask to be killed when that thread is gone.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum {
    CHILD_LINE_SIZE = 240,          ///< bytes of a kept line of stderr with its terminator
    CHILD_PIPE_BYTES = 1024 * 1024, ///< room that is asked for in the pipe of its output
};

/// A child. Zero-initialise; child_start() fills it, child_fini() frees it.
typedef struct child {
    pid_t pid;                  ///< 0: none
    int pidfd;                  ///< readable when it has ended
    int in;                     ///< its standard input, not blocking; -1 when all is written
    int out;                    ///< its standard output, not blocking; -1 at its end
    int err;                    ///< its standard error, not blocking; -1 at its end
    bf_buffer input;            ///< what is still to be written to it
    size_t n_fed;               ///< of it, how much is written
    bf_buffer output;           ///< what it wrote, for the owner to take from
    char line[CHILD_LINE_SIZE]; ///< the line of stderr that is coming
    size_t n_line;              ///< bytes of it
    char last[CHILD_LINE_SIZE]; ///< the last complete line of stderr
} child;

/// Take a line of a child's stderr, without its end.
typedef void child_take_line(void *context, const char *line);

/// Start program with argv. *input, what it is to read, is taken over: *input is then empty.
/// BF_EBUSY: the system has no room for a process just now; BF_ESYSTEM: it cannot be started.
BF_MUST_CHECK bf_status child_start(const char *program, char *const *argv, bf_buffer *input,
                                    child *ret_child, bf_error *err);

/// Write what its input takes; closes it after the last byte, or when it is not read any more.
void child_feed(child *c);

/// Append what can be read of its output, at most about limit bytes, to c->output. False: that was
/// all for now (or for ever, then c->out is -1). BF_ENOMEM goes to *ret_status.
bool child_read_output(child *c, size_t limit, bf_status *ret_status);

/// Give the complete lines that can be read of its stderr to take.
void child_read_errors(child *c, child_take_line *take, void *context);

/// Send a signal to the child; SIGKILL goes to its whole group.
void child_signal(const child *c, int signal_number);

/// True if it has ended; *ret_status is as from waitpid(). Nothing of its group is left then.
bool child_reap(child *c, int *ret_status);

/// Wait until it has ended and reap it.
void child_wait(child *c);

/// How it ended, as an error of the run: which signal or code, which limit, its last words.
void child_describe_end(const child *c, int status, uint64_t memory_bytes, uint64_t cpu_s,
                        bf_error *ret_error);

/// Close and free; the child must have been reaped. NULL is fine.
void child_fini(child *c);
