/// Where an obstacle is: turned about its pivot, and both then shifted. A point p of the path as in the document is at
///
///     x = c + R(angle) (p - c) + shift,      c the pivot as in the document

#pragma once

#include "core/base/vec2.h"
#include "core/scene/types.h"

#include <math.h>
#include <stdbool.h>

/// How far an obstacle is from where its path is in the document.
typedef struct plate_displacement {
    double angle; ///< rad
    vec2 shift;   ///< m
} plate_displacement;

/// A rotation about a point, then a shift.
typedef struct plate_pose {
    vec2 pivot; ///< as in the document, m
    vec2 shift; ///< m
    double cos; ///< of the angle
    double sin; ///< same
} plate_pose;

/// True if two displacements are the same, bit by bit.
static inline bool plate_displacement_is_same(plate_displacement a, plate_displacement b)
{
    return a.angle == b.angle && a.shift.x == b.shift.x && a.shift.y == b.shift.y;
}

/// The pose of an obstacle with a displacement; at zeros it changes no bit of what it moves.
static inline plate_pose plate_pose_of(const scene_obstacle *obstacle,
                                       plate_displacement displacement)
{
    return (plate_pose){ obstacle->pivot, displacement.shift, cos(displacement.angle),
                         sin(displacement.angle) };
}

/// A vector turned by a pose.
static inline vec2 plate_pose_turn(const plate_pose *pose, vec2 a)
{
    return (vec2){ pose->cos * a.x - pose->sin * a.y, pose->sin * a.x + pose->cos * a.y };
}

/// Where a point of the obstacle is in a pose.
static inline vec2 plate_pose_move(const plate_pose *pose, vec2 at)
{
    const vec2 to = vec2_sub(at, pose->pivot);

    return vec2_add(vec2_add(at, vec2_sub(plate_pose_turn(pose, to), to)), pose->shift);
}

/// Where its pivot is.
static inline vec2 plate_pose_pivot(const plate_pose *pose)
{
    return vec2_add(pose->pivot, pose->shift);
}

/// The pose that moves back what a pose has moved.
static inline plate_pose plate_pose_inverse(const plate_pose *pose)
{
    return (plate_pose){ plate_pose_pivot(pose), vec2_scale(pose->shift, -1.0), pose->cos,
                         -pose->sin };
}

/// Velocity, m/s, of the point `at` of a body that turns about `pivot` at angular velocity w, rad/s, while that moves at v, m/s.
static inline vec2 plate_pose_velocity(vec2 pivot, double w, vec2 v, vec2 at)
{
    return vec2_add(vec2_scale(vec2_turn_left(vec2_sub(at, pivot)), w), v);
}
