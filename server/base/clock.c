#include "server/base/clock.h"

#include "core/base/check.h"

#include <time.h>

static struct timespec read_clock(clockid_t clock)
{
    struct timespec now;

    BF_CHECK(clock_gettime(clock, &now) == 0);
    return now;
}

static int64_t to_ms(struct timespec t)
{
    return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

int64_t clock_monotonic_ms(void)
{
    return to_ms(read_clock(CLOCK_MONOTONIC));
}

static int64_t to_ns(struct timespec t)
{
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

int64_t clock_monotonic_ns(void)
{
    return to_ns(read_clock(CLOCK_MONOTONIC));
}

int64_t clock_thread_cpu_ns(void)
{
    return to_ns(read_clock(CLOCK_THREAD_CPUTIME_ID));
}

double clock_monotonic_s(void)
{
    struct timespec now = read_clock(CLOCK_MONOTONIC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int64_t clock_unix_ms(void)
{
    return to_ms(read_clock(CLOCK_REALTIME));
}
