/// When a run that is being solved reports, saves itself and stops: run_request by the clock and by
/// signals.
///
/// Cost  run_control_requested() is called before every step, and a step can take 10 us. It reads the coarse
///       monotonic clock: 4 ns and no system call, for a resolution of some milliseconds.

#pragma once

#include "core/run/run.h"

#include <stdbool.h>
#include <stdint.h>

/// The requests to one run. Begin with run_control_init().
typedef struct run_control {
    int64_t report_ns;          ///< between reports
    int64_t checkpoint_ns;      ///< between checkpoints; 0: none
    int64_t next_report_ns;     ///< when the next report is due
    int64_t next_checkpoint_ns; ///< when the next checkpoint is due
    unsigned on_stop;           ///< run_request flags once a signal has asked to stop
} run_control;

/// A run_control whose first report is due at once. checkpoint_ms 0: no checkpoints, none at a stop either.
run_control run_control_init(int64_t report_ms, int64_t checkpoint_ms);

/// What is due, for run_sink.requested; context is the run_control.
unsigned run_control_requested(void *context);

/// How long a signal is caught.
typedef enum run_control_catching {
    RUN_CONTROL_CATCH_FIRST, ///< a second one ends the process: for interactive use
    RUN_CONTROL_CATCH_ALL,   ///< always: for supervisors, of which there can be several
} run_control_catching;

/// From now on this signal requests a stop instead of ending the process.
void run_control_catch(int signal_number, run_control_catching catching);

/// True if a caught signal has come.
bool run_control_is_stopped(void);
