/// Facts that other threads and processes bring about, for tests: how soon is up to the machine.

#pragma once

#include "server/base/clock.h"

#include <stdint.h>

/// Nothing that a test waits for takes so long, be the machine ever so busy.
enum { HELPER_PATIENCE_MS = 300000 };

/// Wait until an expression is true; it is evaluated again every few ms. Where it is not in time, the test fails.
#define HELPER_AWAIT(fact)                                                                         \
    for (int64_t until_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS; !(fact);)                   \
    helper_wait_more(until_ms, #fact, __FILE__, __LINE__)

/// Part of HELPER_AWAIT(): sleep for 5 ms, or fail when it is too late.
void helper_wait_more(int64_t until_ms, const char *fact, const char *file, int line);
