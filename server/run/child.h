/// A child process that solves, in a process group of its own: started with three pipes, stopped, and reaped. Its pid cannot
/// be of another process before it is reaped.

#pragma once

#include "server/run/executor.h"

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

/// Begin with CHILD_NONE.
typedef struct child {
    pid_t pid;           ///< 0: none, or reaped
    int exit;            ///< its pidfd: readable when it has ended
    int in;              ///< its standard input, not blocking; -1 when all is written
    int out;             ///< its standard output, not blocking; -1 at its end
    int err;             ///< its standard error, not blocking; -1 at its end
    int status;          ///< of wait4(), when reaped
    double used_s;       ///< CPU time so far, as child_cpu_s() and child_reap() found it
    uint64_t peak_bytes; ///< of memory that it had at once, when reaped
} child;

#define CHILD_NONE ((child){ .exit = -1, .in = -1, .out = -1, .err = -1 })

/// Start a program as a worker with these limits. Returns 0, and child_end() ends it; or an errno, and *c is as it was.
int child_start(const char *program, const executor_limits *limits, child *c);

/// True if the child has ended; it is reaped then, and nothing of its process group is left.
bool child_reap(child *c);

/// Send a signal to a child that was not reaped: to end by itself (SIGTERM), or to its whole group (SIGKILL).
void child_stop(const child *c, bool by_force);

/// Stop it by force, reap it, and close what is open.
void child_end(child *c);

/// CPU time that it has used, s.
double child_cpu_s(child *c);

/// Close its pipes, or one of its descriptors; those that are closed are -1.
void child_close_pipes(child *c);
void child_close_one(int *fd);
