/// The executor of this machine: each job is a child process, `beltflow-worker`, in a process group of its
/// own. The job (and checkpoint) frames go to its standard input, its frames come from its standard
/// output, and what it writes to stderr goes to the log (`run_said`).
///
/// Safety   a child is started by process_spawn() with every descriptor but its three pipes closed and no signal
///          blocked or ignored; it limits its own address space and CPU time and confines itself
///          (server/run/confinement.h) before it reads anything. A
///          graceful stop is SIGTERM, a stop by force SIGKILL to its whole group. Its pid cannot be of
///          another process before it is reaped.
/// Spare    prepare() starts the child of the next job, which waits for its input. A child serves one job; one that was
///          started with other limits, or has ended, is replaced when the job starts.
/// Restart  a child is killed by the kernel when the thread that started it ends (PR_SET_PDEATHSIG). So none
///          outlives the daemon, and attach() returns BF_ENOTFOUND.

#pragma once

#include "server/run/executor.h"

/// Create an executor that starts this program; the path is borrowed. BF_ESYSTEM: no memory or descriptor.
BF_MUST_CHECK bf_status local_executor_create(const char *program, executor **ret_executor,
                                              bf_error *err);

/// Free it; all jobs must have been released. Waits for children that were released before they ended.
/// NULL is fine. Always returns NULL.
executor *local_executor_destroy(executor *e);
