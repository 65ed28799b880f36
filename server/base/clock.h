/// The clocks of the daemon.

#pragma once

#include <stdint.h>

/// Milliseconds of a clock that never jumps; for deadlines and durations.
int64_t clock_monotonic_ms(void);

/// Nanoseconds of the same clock.
int64_t clock_monotonic_ns(void);

/// Seconds of the same clock, with its full resolution.
double clock_monotonic_s(void);

/// Nanoseconds of CPU time that this thread has used.
int64_t clock_thread_cpu_ns(void);

/// Milliseconds since 1970-01-01 UTC; for people and ids.
int64_t clock_unix_ms(void);
