/// What leaves the counters and the outlets of a density.
///
/// Of a counter of one kind of cargo all this is of that kind: its fraction in the cell that a flow comes from.
///
/// Over a side of a cell flows what the solver says of its last step (macro_flux()), with `congested` each fourth step for all
/// four. These flows are only nearly those by which the density moved; so at each sample they are made to agree with what is
/// known exactly:
///
///     of a counter    out - in = what it held before + what feeds put into it - what fell in it and what sinks
///                     took in it - what it holds, the difference being shared by out and in as they are large;
///     of the outlets  their sum is what left the domain over its sides: all are scaled alike.
///
/// What a sink takes in a counter has left it.
///
/// Units    parts.

#pragma once

#include "core/base/checkpoint.h"
#include "core/macro/macro.h"
#include "core/scene/counter.h"
#include "core/scene/scene.h"

/// The flows; opaque, on the heap.
typedef struct macro_flows macro_flows;

/// Begin with a solver at t = 0. belt_of: of each cell. All must outlive them. The caller owns *ret_flows:
/// macro_flows_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status macro_flows_create(const scene *s, const macro_solver *solver,
                                           const uint16_t *belt_of, macro_flows **ret_flows,
                                           bf_error *err);

/// Free them. NULL is fine. Always returns NULL.
macro_flows *macro_flows_destroy(macro_flows *f);

/// A step was made.
void macro_flows_follow(macro_flows *f);

/// A feed put parts into a cell, of these fractions of the kinds of cargo; NULL: they are not told apart.
void macro_flows_add(macro_flows *f, size_t cell, double parts, const double *fractions);

/// Integral over some cells of the density of a kind of cargo, or of all (SCENE_KIND_ANY), and of what of it fell there since
/// t = 0, m2.
double macro_flows_mass_in(const macro_solver *solver, uint32_t kind, const counter_cells *c);
double macro_flows_fallen_in(const macro_solver *solver, uint32_t kind, const counter_cells *c);

/// A sink took parts out of a cell.
void macro_flows_take(macro_flows *f, size_t cell, double parts, const double *fractions);

/// A sample: what the counters hold and what has left the domain over its sides since t = 0. Fills what has left each counter, then each outlet,
/// since then.
void macro_flows_settle(macro_flows *f, const double *contents, double left, double *ret_flows);

/// Append the state to a checkpoint, and take it from one. False: it is damaged.
void macro_flows_save(const macro_flows *f, checkpoint_writer *w);
BF_MUST_CHECK bool macro_flows_load(macro_flows *f, checkpoint_reader *r);
