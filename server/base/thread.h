/// Threads of the server. Signals are the main thread's: the others are started with all of them blocked.

#pragma once

#include "core/base/status.h"

#include <pthread.h>

/// Start work(context) in a thread, which the caller joins. `name` says in the error what it is for. Errors: BF_ESYSTEM.
BF_MUST_CHECK bf_status thread_start(pthread_t *ret_thread, void *(*work)(void *), void *context,
                                     const char *name, bf_error *err);
