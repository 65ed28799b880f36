/// The drive of an obstacle that moves: what it can push, and how it falls behind what it is told when it must push more.
///
///     limit     F at the point of the obstacle farthest from its pivot, so a torque of F R, R plate_range_radius();
///               of a plate that is shifted, F against its way; of one that comes, F on its surfaces.
///               scene_obstacle.force_limit, or by default
///
///                   F = mu g M,   M = the mass of close packed cargo on an area of R times the longer side of
///                                 the domain
///
///               mu of cargo on the belt, the largest of all belts. **Choice**: this is twice what it takes to push a full belt before a plate
///               of the length R against the belt's friction, whose resultant acts in its middle; what cargo that is
///               wedged between the plate and a wall or another plate bears is far more. One that is shifted may push
///               as much as lies before it on a path as long as the domain
///     speed     as told up to half the limit, from there to the limit falling steadily to zero: the line of a motor
///               that is loaded up to its stall torque. It is never pushed back, like a worm gear or a closed valve
///     after     once behind, it follows at the fastest rate of its schedule and its actions until it has caught up
///
/// Who knows the load calls plate_drive_follow() at times that the scenario and the number of the step decide, so that a
/// run resumes with the same bits.
///
/// Units    SI, angles in rad.

#pragma once

#include "core/scene/types.h"
#include "core/world/plate_motion.h"

#include <stdbool.h>
#include <stddef.h>

/// The drive of one obstacle.
typedef struct plate_drive {
    double force;  ///< F, N; INFINITY: it pushes whatever there is
    double torque; ///< F R, N m
    double rate;   ///< fastest turn by schedule and actions, rad/s
    double speed;  ///< fastest shift, m/s
} plate_drive;

/// What cargo does to an obstacle.
typedef struct plate_load {
    double torque;  ///< about its pivot, counter-clockwise, N m
    double force;   ///< on its surfaces, N
    vec2 resultant; ///< of these forces, N
} plate_load;

/// How an obstacle follows what it is told.
typedef enum plate_drive_state {
    PLATE_DRIVE_AS_TOLD, ///< it is where it should be
    PLATE_DRIVE_BEHIND,  ///< it is not, but moves
    PLATE_DRIVE_STALLED, ///< the load stops it
    PLATE_DRIVE_STATE_COUNT
} plate_drive_state;

/// The drive of obstacle k of a resolved scene.
plate_drive plate_drive_of(const scene *s, size_t k);

/// True if the obstacle moves between the times t and `until`, or is behind, so that its load matters.
bool plate_drive_is_needed(const plate_motion *motion, size_t obstacle, double t, double until);

/// Let an obstacle go under this load from a time t to a later one, s; at rest after that unless it is as told.
void plate_drive_follow(plate_motion *motion, size_t obstacle, const plate_drive *drive,
                        const plate_load *load, double t, double until);

/// How an obstacle follows what it is told at a time t.
plate_drive_state plate_drive_state_of(const plate_motion *motion, size_t obstacle, double t);
