/// How fast belts move at a time: the factor on a belt's velocity v_T, by its speed schedule.
///
///     velocity(t) = v_T f(t),   f(t) = 1 before the first time of the schedule, f(0) its first factor if that
///     time is 0. From times[k] on the velocity goes to v_T factors[k], at the rate `acceleration` if the speed rises
///     and `deceleration` if it falls, and stays there; a ramp that has not ended at times[k + 1] ends there,
///     and the next one begins with the speed reached. A belt with v_T = 0 stands. Below 0 the belt runs backwards; on the
///     way there it comes to rest first.
///
/// f is piecewise linear, continuous but for jumps where a rate is infinite, and evaluated from its
/// corners ("knots"), which are made once. In a step of a solver a belt moves at its mean speed over the step: so
/// its displacement is exact whatever the step, and depends on the number of the step alone.
///
/// A command has the effect of a time of the schedule, and the schedule has none from then on.
///
/// While failures or breaks stop a belt (belt_stops.h), its target is 0, with the deceleration of any other stop; behind them it is
/// what schedule or commands tell by then.
///
/// Units    SI.
/// Errors   belt_speeds_init() expects schedules that belt_range_check() finds no fault in.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/scene/types.h"
#include "core/world/belt_stops.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A corner of f; two at one time are a jump.
typedef struct belt_speeds_knot {
    double t;      ///< s
    double factor; ///< f from there on, towards the next knot
} belt_speeds_knot;

/// What stops a belt from a time on.
typedef struct belt_speeds_stop {
    double t;     ///< s
    unsigned now; ///< belt_stops_now(), until the next one
} belt_speeds_stop;

/// What a belt is told at a time, and how far its failures and breaks have come.
typedef struct belt_speeds_origin {
    belt_stops_state stops; ///< with the time
    double factor;          ///< f, from which the ramp to the target begins
    double target;          ///< that schedule or commands tell
    uint64_t next; ///< time of the schedule that comes next; its number of times: none does
} belt_speeds_origin;

/// f of a belt.
typedef struct belt_speeds_curve {
    size_t n; ///< >= 1
    belt_speeds_knot
        *knots; ///< the first at t = 0 or at the time of the last command, times not falling;
                ///< constant after the last
    const scene_belt *belt; ///< borrowed, where it has failures or breaks; else NULL
    size_t n_stops;         ///< 0 where there are none
    belt_speeds_stop
        *stops; ///< changes of what stops it, times rising, from the same time on as the knots
    size_t n_segments; ///< between two times at which a target may change: at most as many are kept
    belt_speeds_origin origin; ///< of the knots
    double speed;              ///< |v_T|, m/s
    double acceleration;       ///< m/s2
    double deceleration;       ///< m/s2
    bool is_commandable;       ///< scene_belt.is_commanded
    size_t first_section;      ///< of a path, those that are commanded with it
    size_t n_more;             ///< see scene_belt
    bool was_commanded;        ///< there was a command
} belt_speeds_curve;

/// The speeds of a number of belts.
typedef struct belt_speeds {
    size_t n_belts;            ///< see there
    belt_speeds_curve *curves; ///< of each belt
    bool are_constant;         ///< belt_range_is_constant(); then none is ever commanded
} belt_speeds;

/// Make the speeds of belts; those with failures or breaks must outlive them. The caller owns them: belt_speeds_fini(). BF_ENOMEM: *ret_speeds
/// is empty.
BF_MUST_CHECK bf_status belt_speeds_init(belt_speeds *ret_speeds, size_t n_belts,
                                         const scene_belt *belts, bf_error *err);

/// Free what *speeds owns and zero it.
void belt_speeds_fini(belt_speeds *speeds);

/// f of a belt at a time t >= 0, s; 1 for n_belts, off every belt.
double belt_speeds_at(const belt_speeds *speeds, size_t belt, double t);

/// Whether a belt stands from a time t >= 0 on, s, and until when at least: the next knot of its f.
bool belt_speeds_stands(const belt_speeds *speeds, size_t belt, double t, double *ret_until);

/// What stops a belt from a time t on, belt_stops_now(), and until when at least.
unsigned belt_speeds_stopped_by(const belt_speeds *speeds, size_t belt, double t,
                                double *ret_until);

/// The mean of f of a belt over [from, to], s, 0 <= from < to; the same bits as f where that is constant. 1 for n_belts.
double belt_speeds_mean(const belt_speeds *speeds, size_t belt, double from, double to);

/// The factors of all belts in a step: their means over [step dt, (step + 1) dt]. ret_factors has room for
/// n_belts + 1; the last one, for places off every belt, is 1.
void belt_speeds_in_step(const belt_speeds *speeds, uint64_t step, double dt, double *ret_factors);

/// Let a commandable belt, and its sections, head for a factor from a time t on, s, >= that of the last command. Times before t must not
/// be asked for any more.
void belt_speeds_command(belt_speeds *speeds, size_t belt, double t, double factor);

/// Write the commands to a checkpoint, nothing where no belt is commandable, and take them from one of the same
/// belts into speeds without commands. False: it is damaged, and *speeds undefined.
void belt_speeds_save(const belt_speeds *speeds, checkpoint_writer *w);
BF_MUST_CHECK bool belt_speeds_load(belt_speeds *speeds, checkpoint_reader *r);
