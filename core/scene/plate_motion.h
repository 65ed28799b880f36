/// How obstacles move: the angle by which each is turned about its pivot at a time, the displacement by which both are then
/// shifted, and whether it is there. A point p of the path as in the document is at
///
///     x(t) = c + R(angle(t)) (p - c) + shift(t),      c the pivot as in the document
///
///     angle(t)      linear between the times of scene_obstacle.turn, constant before the first and after the
///                   last; counter-clockwise, rad; 0 without a turn at all times
///     shift(t)      the same of scene_obstacle.shifts, m
///     present(t)    that of scene_obstacle.presence from each time to the next, true before the first
///     extent(t)     0: it is not there; 1: it is; a plate that comes grows steadily within
///                   PLATE_MOTION_COMING, and goes at once
///     repeat        the round from 0 to scene_series.repeat is made again and again: t counts from its
///                   beginning. From the last time of a round to the first one of the next the plate moves
///                   steadily between their places, and is present as at the last time
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
/// Errors   series are expected to be sound: times that rise, as many values, repeat at least the last time.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/base/vec2.h"
#include "core/scene/types.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Within which a plate that comes is there in full, s. **Choice**: as long as a pneumatic stop takes. What it comes
/// upon is pushed aside by that time, so that no contact begins with an overlap, whatever its stiffness.
#define PLATE_MOTION_COMING 0.2

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
    vec2 pivot;                   ///< m
    scene_series turn;            ///< a copy
    size_t n_shifts;              ///< 0, or as many as turn has times
    vec2 *shifts;                 ///< a copy, m
    scene_series presence;        ///< a copy
    plate_motion_command command; ///< see there
    plate_motion_lag lag;         ///< see there
} plate_motion_plate;

/// The motions of a number of obstacles.
typedef struct plate_motion {
    size_t n;                   ///< obstacles
    plate_motion_plate *plates; ///< of each
    bool is_any;                ///< some obstacle moves
} plate_motion;

/// How far an obstacle is from where its path is in the document.
typedef struct plate_motion_place {
    double angle; ///< rad
    vec2 shift;   ///< m
} plate_motion_place;

/// A rotation about a point and a displacement.
typedef struct plate_motion_pose {
    vec2 pivot; ///< as in the document, m
    vec2 shift; ///< m
    double cos; ///< of the angle
    double sin; ///< same
} plate_motion_pose;

/// An obstacle in a step of a solver, of dt, before which n_before were made.
typedef struct plate_motion_step {
    plate_motion_pose pose; ///< at its beginning
    double spin;            ///< mean angular velocity, rad/s; exactly 0 where it does not turn
    vec2 velocity;          ///< mean one of its pivot, m/s; likewise
    double recess; ///< how far its surface is behind its place, m; INFINITY: it is not there
    double growth; ///< at which that decreases, m/s
} plate_motion_step;

/// Copy the motions of obstacles. The caller owns them: plate_motion_fini(). BF_ENOMEM: *ret_motion is empty.
BF_MUST_CHECK bf_status plate_motion_init(plate_motion *ret_motion, size_t n,
                                          const scene_obstacle *obstacles, bf_error *err);

/// Free what *motion owns and zero it.
void plate_motion_fini(plate_motion *motion);

/// The place of an obstacle at a time t >= 0; zeros of one that does not move.
plate_motion_place plate_motion_at(const plate_motion *motion, size_t obstacle, double t);

/// The one that schedule and commands tell it to have.
plate_motion_place plate_motion_told(const plate_motion *motion, size_t obstacle, double t);

/// True if two places are the same, bit by bit.
static inline bool plate_motion_is_same(plate_motion_place a, plate_motion_place b)
{
    return a.angle == b.angle && a.shift.x == b.shift.x && a.shift.y == b.shift.y;
}

/// Whether it is there at a time t >= 0; true for one that does not move.
bool plate_motion_is_present(const plate_motion *motion, size_t obstacle, double t);

/// How much of it is there, 0 to 1; see above.
double plate_motion_extent(const plate_motion *motion, size_t obstacle, double t);

/// What schedule and commands tell.
double plate_motion_told_extent(const plate_motion *motion, size_t obstacle, double t);

/// The pose of the obstacle at a place; at zeros it changes no bit of what it moves.
plate_motion_pose plate_motion_pose_at(const plate_motion *motion, size_t obstacle,
                                       plate_motion_place place);

/// All of it. A plate that comes begins behind its place by `depth`, m: the largest overlap that there could be.
plate_motion_step plate_motion_in_step(const plate_motion *motion, size_t obstacle,
                                       uint64_t n_before, double dt, double depth);

/// A vector turned by a pose.
static inline vec2 plate_motion_turn(const plate_motion_pose *pose, vec2 a)
{
    return (vec2){ pose->cos * a.x - pose->sin * a.y, pose->sin * a.x + pose->cos * a.y };
}

/// Where a point of the obstacle is in a pose.
static inline vec2 plate_motion_move(const plate_motion_pose *pose, vec2 at)
{
    const vec2 to = vec2_sub(at, pose->pivot);

    return vec2_add(vec2_add(at, vec2_sub(plate_motion_turn(pose, to), to)), pose->shift);
}

/// Where its pivot is.
static inline vec2 plate_motion_pivot(const plate_motion_pose *pose)
{
    return vec2_add(pose->pivot, pose->shift);
}

/// The pose that moves back what a pose has moved.
static inline plate_motion_pose plate_motion_inverse(const plate_motion_pose *pose)
{
    return (plate_motion_pose){ plate_motion_pivot(pose), vec2_scale(pose->shift, -1.0), pose->cos,
                                -pose->sin };
}

/// Velocity, m/s, of the point `at` of a body that turns about `pivot` at angular velocity w, rad/s, while that moves at v, m/s.
static inline vec2 plate_motion_velocity(vec2 pivot, double w, vec2 v, vec2 at)
{
    return vec2_add(vec2_scale(vec2_turn_left(vec2_sub(at, pivot)), w), v);
}

/// Turn an obstacle that moves, from its angle at a time t, s, to another one within `over`, s, > 0.
void plate_motion_command_turn(plate_motion *motion, size_t obstacle, double t, double angle,
                               double over);

/// Shift an obstacle that moves, from where it is at a time t, s, to another displacement, m, within `over`, s, > 0.
void plate_motion_command_shift(plate_motion *motion, size_t obstacle, double t, vec2 shift,
                                double over);

/// Let an obstacle that moves come or go at a time t, s.
void plate_motion_command_presence(plate_motion *motion, size_t obstacle, double t,
                                   bool is_present);

/// Write what was commanded, and how drives lag; nothing if no obstacle moves. Take it into the motion of the same
/// obstacles; false: it is damaged, and the motion undefined.
void plate_motion_save(const plate_motion *motion, checkpoint_writer *w);
BF_MUST_CHECK bool plate_motion_load(plate_motion *motion, checkpoint_reader *r);
