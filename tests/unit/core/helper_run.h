/// A sink that records what a run emits.

#pragma once

#include "core/run/run.h"

#include <stdbool.h>
#include <stddef.h>

enum { HELPER_RUN_SAMPLES = 2000, HELPER_RUN_COLUMNS = 16, HELPER_RUN_CHANGES = 512 };
enum { HELPER_RUN_FIGURES = 256 };

/// Everything that a run emitted, and the requests to it. Zero-initialise; helper_run_free() if it is on the heap.
typedef struct helper_run_log {
    size_t n_frames[FRAME_TYPE_COUNT];                     ///< frames of each type
    size_t n_samples;                                      ///< samples, in order and without gap
    double t[HELPER_RUN_SAMPLES];                          ///< their times
    double values[HELPER_RUN_SAMPLES][HELPER_RUN_COLUMNS]; ///< their columns
    size_t n_snapshots;                                    ///< snapshots, in order and without gap
    uint64_t snapshot_digest;                              ///< of all their times and grids
    double peaks[HELPER_RUN_SAMPLES];                      ///< of the snapshots
    size_t n_changes;                                      ///< changes, in order and without gap
    frame_change changes[HELPER_RUN_CHANGES];              ///< see there
    frame_begin begin;                                     ///< the last one
    frame_end end;                                         ///< the last one
    bf_buffer checkpoint;                                  ///< the last one
    run_model model;                                       ///< to run with (RUN_MACRO where zeroed)
    uint64_t parts_digest;                                 ///< of all times and rows of parts
    double *parts;                                         ///< rows of the last ones; free()
    size_t n_present;                                      ///< parts in the domain in those
    size_t n_figures;                                      ///< the key figures that came last
    double figures[HELPER_RUN_FIGURES];                    ///< their values
    uint64_t n_askings;                                    ///< calls of requested()
    uint64_t stop_at;      ///< request a checkpoint and a stop in this call; 0: never
    uint64_t report_every; ///< request a report every so many calls; 0: never
} helper_run_log;

/// Run a scenario to its end or stop, on n_threads threads, into *log, from log->checkpoint if resume
/// is not 0.
bf_status helper_run(const scene *s, int n_threads, int resume, helper_run_log *log);

/// Threads of a run that is stopped, and of the one that goes on.
typedef struct helper_run_threads {
    int before, after; ///< a stop
} helper_run_threads;

/// Run a scenario to its end on one thread, and for each k = 1, 1 + step .. < n stop it after k/n of it, and resume it: that is
/// the same to the bit. Returns the whole run: helper_run_free().
helper_run_log *helper_run_check_stops(const scene *s, run_model model, uint64_t n, uint64_t step,
                                       helper_run_threads threads);

/// The sample at time t, which must be there.
const double *helper_run_at(const helper_run_log *log, double t);

/// True if two runs emitted the same bits, checkpoints and askings aside.
bool helper_run_is_same(const helper_run_log *a, const helper_run_log *b);

/// Free a log that is on the heap, and what it owns.
void helper_run_free(helper_run_log *log);
