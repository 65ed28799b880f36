/// Starting programs: in a process group of their own, with no signal blocked or handled, and with no descriptors but the
/// three standard ones.

#pragma once

#include <sys/types.h>

/// Start a program, found by PATH if its name has no '/', with arguments that end with NULL, the environment of this process,
/// and these as its standard input, output and error. Returns 0 or an errno.
int process_spawn(const char *program, const char *const *argv, const int fds[static 3],
                  pid_t *ret_pid);
