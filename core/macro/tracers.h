/// Cargo that is followed through the density: points that stand for portions of what enters, and move with it.
///
/// A tracer is placed where cargo enters as soon as that adds up to a portion. It leaves over a border of the grid and then
/// tells when it entered: the share of tracers with a time of residence is that of the cargo. Lanes, corners that stand and
/// queues that come and go so show as they do with parts. The density knows nothing of tracers.
///
/// Within a cell a tracer moves in one of two ways, by the velocities u of the cargo across its faces (cargo_velocity.h):
///
///     carried   where all are those of the belts: along each axis linear between both faces (Pollock 1988), so that what
///               flows evenly leaves at the very time of travel, and nothing crosses a closed face;
///     pushed    else: in a step it stays, or goes over a face with the probability u dt/dx for those over which cargo leaves,
///               to any place along the face. Just so the scheme deals with the mass of a cell, which has no place in it;
///               of a steady flow the mean time in a cell is its mass by what flows through. Cargo that circles behind a
///               plate is exchanged so as the density is, where streamlines would hold it for ever.
///
/// With the closure congested tracers move once in some steps, by the velocities of the last one.
///
/// Which cargo becomes a tracer: with S the sum of all that has entered, in the order in which it is told, the k-th
/// one stands for the k-th portion and is placed where S passes a share w_k of it, with w_k = k times the golden ratio
/// modulo 1, so that no rhythm of feeds and steps chooses a lane. The portion is doubled, and every second tracer dropped, where more than
/// TRACERS_MOST would be inside.
///
/// Threads  one moves them all. The bits depend on the density alone.
/// Units    s; portions in densities of a cell.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/random.h"
#include "core/macro/cargo_velocity.h"
#include "core/macro/macro_priv.h"

enum { TRACERS_MOST = 2048 }; ///< inside at once

/// Tracers and the sum of what has entered; what is saved.
typedef struct tracers_state {
    double portion;   ///< of a tracer
    double sum;       ///< S
    double begin;     ///< S up to which all portions have their tracer
    uint64_t n_made;  ///< k
    uint64_t n;       ///< inside
    bf_random random; ///< what they do where cargo is pushed
} tracers_state;

/// The tracers of a solver.
typedef struct tracers {
    tracers_state state;          ///< see there
    macro_tracer *inside;         ///< state.n of TRACERS_MOST
    size_t n_exits;               ///< that left in the last step
    macro_exit *exits;            ///< TRACERS_MOST
    cargo_velocity_record record; ///< see there
} tracers;

/// Begin with none, with the definition's portion. The caller owns *ret_tracers: tracers_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status tracers_create(const macro_solver *s, tracers **ret_tracers);

/// Free them. NULL is fine. Always returns NULL.
tracers *tracers_destroy(tracers *t);

/// All cargo of the present density entered at t = 0, and nothing has left.
void tracers_reset(macro_solver *s);

/// A step was made: move them if it is their turn, and note which left. What is in a cell off every belt is dropped.
void tracers_follow(macro_solver *s);

/// Append the tracers to a checkpoint, and take them from one; false: it ends before, or is damaged.
void tracers_save(const macro_solver *s, checkpoint_writer *w);
BF_MUST_CHECK bool tracers_load(macro_solver *s, checkpoint_reader *r);
