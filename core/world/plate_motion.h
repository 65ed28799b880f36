/// How obstacles move: the angle by which each is turned about its pivot at a time, the shift by which both are then
/// moved, and whether it is there. A point p of the path as in the document is at
///
///     x(t) = c + R(angle(t)) (p - c) + shift(t),      c the pivot as in the document
///
///     angle(t), shift(t), present(t)    by schedule: core/scene/plate_schedule.h
///     extent(t)     0: it is not there; 1: it is; a plate that comes grows steadily within
///                   PLATE_SCHEDULE_COMING, and goes at once
///     commands      replace the schedule of what they command from then on: a turn goes from the present angle to
///                   another one at a steady rate and ends there, a shift likewise, straight
///     lag           a drive that bears too much falls behind these, see plate_drive.h; it is then moved by ramps
///                   that plate_drive_follow() sets, and has caught up when angle, shift and extent are those told
///
/// In a step of a solver, from t to t + dt, a plate turns about its pivot at its mean angular velocity (angle(t + dt) -
/// angle(t))/dt, and the pivot moves at its own mean velocity, so that it is displaced exactly whatever the step; it is there
/// if it is at t.
///
/// Units    SI, angles in rad.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/base/vec2.h"
#include "core/scene/plate_schedule.h"
#include "core/scene/types.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A value that changes steadily between two times, and not after them. Of one number y is 0.
typedef struct plate_motion_ramp {
    double at;    ///< its beginning, s; INFINITY: there is none
    double until; ///< its end, s, not before
    vec2 from;    ///< value at its beginning
    vec2 to;      ///< at its end
} plate_motion_ramp;

/// What was commanded of an obstacle.
typedef struct plate_motion_command {
    plate_motion_ramp angle; ///< rad
    plate_motion_ramp shift; ///< m
    double presence;         ///< 1 or 0; -1: never commanded
    double came; ///< when it came, if it is commanded to be there, s; -INFINITY: it always was
} plate_motion_command;

/// How a drive is behind what was told; where there is no ramp, it is not.
typedef struct plate_motion_lag {
    plate_motion_ramp angle;  ///< rad
    plate_motion_ramp extent; ///< of a plate that comes, 0 to 1
    plate_motion_ramp shift;  ///< m
} plate_motion_lag;

/// The motion of one obstacle.
typedef struct plate_motion_plate {
    bool moves;                   ///< scene_obstacle_moves(); the rest is unused otherwise
    plate_motion_command command; ///< see there
    plate_motion_lag lag;         ///< see there
} plate_motion_plate;

/// The motions of a number of obstacles.
typedef struct plate_motion {
    size_t n;                        ///< obstacles
    const scene_obstacle *obstacles; ///< borrowed, with their schedules
    plate_motion_plate *plates;      ///< of each
    bool is_any;                     ///< some obstacle moves
} plate_motion;

/// An obstacle in a step of a solver, of dt, before which n_before were made.
typedef struct plate_motion_step {
    plate_pose pose; ///< at its beginning
    double spin;     ///< mean angular velocity, rad/s; exactly 0 where it does not turn
    vec2 velocity;   ///< mean one of its pivot, m/s; likewise
    double recess;   ///< how far its surface is behind its place, m; INFINITY: it is not there
    double growth;   ///< at which that decreases, m/s
} plate_motion_step;

/// The motions of obstacles, which must outlive them. The caller owns them: plate_motion_fini(). BF_ENOMEM: *ret_motion is empty.
BF_MUST_CHECK bf_status plate_motion_init(plate_motion *ret_motion, size_t n,
                                          const scene_obstacle *obstacles, bf_error *err);

/// Free what *motion owns and zero it.
void plate_motion_fini(plate_motion *motion);

/// The displacement of an obstacle at a time t >= 0; zeros of one that does not move.
plate_displacement plate_motion_at(const plate_motion *motion, size_t obstacle, double t);

/// The one that schedule and commands tell it to have.
plate_displacement plate_motion_told(const plate_motion *motion, size_t obstacle, double t);

/// Whether it is there at a time t >= 0; true for one that does not move.
bool plate_motion_is_present(const plate_motion *motion, size_t obstacle, double t);

/// How much of it is there, 0 to 1; see above.
double plate_motion_extent(const plate_motion *motion, size_t obstacle, double t);

/// What schedule and commands tell.
double plate_motion_told_extent(const plate_motion *motion, size_t obstacle, double t);

/// All of it. A plate that comes begins behind its place by `depth`, m: the largest overlap that there could be.
plate_motion_step plate_motion_in_step(const plate_motion *motion, size_t obstacle,
                                       uint64_t n_before, double dt, double depth);

/// Turn an obstacle that moves, from its angle at a time t, s, to another one within `over`, s, > 0.
void plate_motion_command_turn(plate_motion *motion, size_t obstacle, double t, double angle,
                               double over);

/// Shift an obstacle that moves, from where it is at a time t, s, to another shift, m, within `over`, s, > 0.
void plate_motion_command_shift(plate_motion *motion, size_t obstacle, double t, vec2 shift,
                                double over);

/// Let an obstacle that moves come or go at a time t, s.
void plate_motion_command_presence(plate_motion *motion, size_t obstacle, double t,
                                   bool is_present);

/// Write what was commanded, and how drives lag; nothing if no obstacle moves. Take it into the motion of the same
/// obstacles; false: it is damaged, and the motion undefined.
void plate_motion_save(const plate_motion *motion, checkpoint_writer *w);
BF_MUST_CHECK bool plate_motion_load(plate_motion *motion, checkpoint_reader *r);
