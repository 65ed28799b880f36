#include "server/run/run_control.h"

#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <time.h>

static const int64_t ns_per_ms = 1000000;

// Set by a signal's handler, read by every thread that solves.
static atomic_bool is_stop_requested;
_Static_assert(ATOMIC_BOOL_LOCK_FREE == 2, "a handler may set it");

static int64_t read_clock_ns(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

run_control run_control_init(int64_t report_ms, int64_t checkpoint_ms)
{
    int64_t now = read_clock_ns();

    return (run_control){
        .report_ns = report_ms * ns_per_ms,
        .checkpoint_ns = checkpoint_ms * ns_per_ms,
        .next_report_ns = now,
        .next_checkpoint_ns = checkpoint_ms == 0 ? INT64_MAX : now + checkpoint_ms * ns_per_ms,
        .on_stop = RUN_STOP | (checkpoint_ms == 0 ? 0U : RUN_CHECKPOINT),
    };
}

unsigned run_control_requested(void *context)
{
    run_control *p = context;

    if (run_control_is_stopped())
        return p->on_stop;
    int64_t now = read_clock_ns();
    unsigned requested = RUN_GO_ON;
    if (now >= p->next_report_ns) {
        p->next_report_ns = now + p->report_ns;
        requested |= RUN_REPORT;
    }
    if (now >= p->next_checkpoint_ns) {
        p->next_checkpoint_ns = now + p->checkpoint_ns;
        requested |= RUN_CHECKPOINT;
    }
    return requested;
}

static void request_stop(int signal_number)
{
    (void)signal_number;
    atomic_store_explicit(&is_stop_requested, true, memory_order_relaxed);
}

void run_control_catch(int signal_number, run_control_catching catching)
{
    struct sigaction action = { .sa_handler = request_stop, .sa_flags = SA_RESTART };

    if (catching == RUN_CONTROL_CATCH_FIRST)
        action.sa_flags |= (int)SA_RESETHAND;
    sigemptyset(&action.sa_mask);
    sigaction(signal_number, &action, NULL);
}

bool run_control_is_stopped(void)
{
    return atomic_load_explicit(&is_stop_requested, memory_order_relaxed);
}
