/// Sinks of the macroscopic model (core/scene/sink.h): what they take off their cells (sink_cells.h).
///
/// After each step a sink takes all that is in its cells, or with a rate at most its credit, the same share of each cell. The credit
/// grows by the rate up to one part, or to what the rate is in a step: as a part that comes to a sink which has been idle for 1/rate is
/// taken at once. Of some kinds it takes the same share of each.
///
/// Units    parts.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/faults.h"
#include "core/macro/macro.h"
#include "core/run/macro_flows.h"
#include "core/scene/scene.h"

#include <stddef.h>

/// The sinks of a run; opaque, on the heap.
typedef struct macro_sinks macro_sinks;

/// Note sinks of no cell, which a density cannot have; or, at /sinks, more steps to find the cells than SCENE_CHECK_STEPS_MAX.
void macro_sinks_check(const scene *s, bf_faults *faults);

/// Begin with a solver at t = 0, which must outlive them, as the flows, NULL without feeds. The caller owns *ret_sinks:
/// macro_sinks_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status macro_sinks_create(const scene *s, macro_solver *solver, macro_flows *flows,
                                           macro_sinks **ret_sinks, bf_error *err);

/// Free them. NULL is fine. Always returns NULL.
macro_sinks *macro_sinks_destroy(macro_sinks *m);

/// A step was made, or none yet: take what is due.
void macro_sinks_take(macro_sinks *m);

/// Fill what each took since t = 0.
void macro_sinks_taken(const macro_sinks *m, double *ret_parts);

/// Append the state to a checkpoint, and take it from one. False: it is damaged.
void macro_sinks_save(const macro_sinks *m, checkpoint_writer *w);
BF_MUST_CHECK bool macro_sinks_load(macro_sinks *m, checkpoint_reader *r);
