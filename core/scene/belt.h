/// How the surface of a belt moves: its velocity as a function of place.
///
///     v_T(x) = velocity                    of a straight belt
///     v_T(x) = turn e_z x (x - centre)     of one that turns about a point, turn not 0
///
/// Either is affine in x, v_T(x) = v_T(0) + turn e_z x x, which loops over many places evaluate. At a time the belt moves at
/// f(t) v_T(x): belt_speeds.h.
///
/// Units    SI.

#pragma once

#include "core/scene/types.h"

/// v_T of a belt at a place, m/s.
static inline vec2 belt_velocity(const scene_belt *belt, vec2 at)
{
    return belt->turn == 0.0 ? belt->velocity
                             : vec2_scale(vec2_turn_left(vec2_sub(at, belt->centre)), belt->turn);
}

/// The largest |v_T| on a belt, m/s: that at a corner, as it is convex in x; of one without corners that of `velocity`.
double belt_largest_speed(const scene_belt *belt);
