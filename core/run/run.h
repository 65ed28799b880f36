/// The run of one scenario: steps the solver and emits results as frames.
///
/// Samples of the curve and snapshots (of density and, where the model has them, parts) are taken at the
/// first step at or past each multiple of their period, at t = 0 and at the end. The same scenario gives the
/// same samples, snapshots and final digest for any number of threads, and also when the run was stopped and
/// resumed in between. Only how samples are grouped into frames, and when progress and checkpoints come,
/// follows the caller's requests.
///
/// Threads  a run belongs to one thread at a time.

#pragma once

#include "core/base/faults.h"
#include "core/base/status.h"
#include "core/observe/frame.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// The models. The values are stored in frames and databases: never renumber.
typedef enum run_model {
    RUN_MACRO, ///< density
    RUN_MICRO, ///< parts
    RUN_MODEL_COUNT
} run_model;

/// Version of what the solvers compute: incremented with every change by which a scenario's results get other
/// bytes, so that results of different versions are never reused for each other.
enum { RUN_VERSION = 40 };

/// What the caller requests at the moment; flags.
typedef enum run_request {
    RUN_GO_ON = 0,
    RUN_REPORT = 1,     ///< emit the samples so far and progress now
    RUN_CHECKPOINT = 2, ///< emit a checkpoint now
    RUN_STOP = 4,       ///< emit the samples so far and the end now, and return
} run_request;

/// Where frames go and requests come from.
typedef struct run_sink {
    void *context; ///< given to both functions
    /// Called with each frame; pointers in it are valid during the call. A failure ends the run with it.
    bf_status (*on_frame)(void *context, const frame *f, bf_error *err);
    /// Called every few milliseconds of work or more often, so it should be cheap. Returns
    /// run_request flags. NULL: no requests.
    unsigned (*requested)(void *context);
} run_sink;

/// A run; opaque, on the heap.
typedef struct run run;

/// The words of the models, "macro" and "micro"; NULL-terminated.
extern const char *const run_model_words[];

/// Parts that left the domain, of those that came: less those inside and those that fell. Where all that went fell, 0 and
/// not what rounding makes of it.
double run_left(double came, double inside, double fallen);

/// True if this build can solve scenarios with the model.
bool run_model_is_available(run_model model);

/// Add the faults for which a resolved and checked scenario cannot be solved with one of the available
/// models, beyond those that scene_check() finds for both: steps that would be unstable or too
/// many, parts inside obstacles, results too large. No memory is noted like a fault, with BF_ENOMEM.
void run_check(const scene *s, run_model model, bf_faults *faults);

/// Digest of everything that the results of a resolved scenario depend on, with a model.
uint64_t run_definition(const scene *s, run_model model);

/// Prepare a run of a resolved and checked scenario, which must outlive it.
/// BF_EINPUT, BF_ELIMIT: the scenario is at fault, see run_check(); BF_ENOMEM.
BF_MUST_CHECK bf_status run_create(const scene *s, run_model model, int n_threads, run **ret_run,
                                   bf_error *err);

/// Prepare a run like run_create() that goes on from a checkpoint's bytes instead of t = 0. BF_ECORRUPT: damaged, of another
/// version, or of a scenario that differs in any number; there is no run then.
BF_MUST_CHECK bf_status run_resume(const scene *s, run_model model, int n_threads,
                                   const void *bytes, size_t n, run **ret_run, bf_error *err);

/// Step to the end. Emits begin first, and end last unless it fails. Failures of the solver and of
/// sink->on_frame are returned; emitting FRAME_ERROR for them is the caller's part.
BF_MUST_CHECK bf_status run_execute(run *r, const run_sink *sink, bf_error *err);

/// What a run had to do so far beside its steps; zeros of the microscopic model.
typedef struct run_work {
    double relaxed;   ///< cells whose pressure was relaxed, each time that one was
    double n_fields;  ///< fields that plates and belts have made anew
    double n_tracers; ///< tracers of cargo's time that there are
    double swept;     ///< cells that sweeps went over (core/macro/macro.h, macro_swept)
    double varied;    ///< same
    double dispersed; ///< same
} run_work;

run_work run_work_of(const run *r);

/// Free a run. NULL is fine. Always returns NULL.
run *run_destroy(run *r);
