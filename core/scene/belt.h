/// How the surface of a belt moves: its velocity as a function of place.
///
///     v_T(x) = velocity                    of a straight belt
///     v_T(x) = turn e_z x (x - centre)     of one that turns about a point, turn not 0
///
/// Either is affine in x, v_T(x) = v_T(0) + turn e_z x x, which loops over many places evaluate. At a time the belt moves at
/// f(t) v_T(x): belt_speeds.h.
///
/// An arc has for its borders a polygon within it, with corners BELT_ARC_STEP apart at most, which is off by 1.5e-4 of the radius.
/// What lies on it is exact.
///
/// Units    SI.

#pragma once

#include "core/base/status.h"
#include "core/scene/types.h"

/// Angle between two corners of an arc's polygon, rad: 2 degrees.
#define BELT_ARC_STEP (M_PI / 90.0)

/// Least angle of an arc, rad: 1 degree.
#define BELT_ARC_LEAST (M_PI / 180.0)

/// Greatest angle of an arc, rad: a whole turn, and what rounding adds to it.
#define BELT_ARC_MOST (2.0 * M_PI + 1e-9)

/// v_T of a belt at a place, m/s.
static inline vec2 belt_velocity(const scene_belt *belt, vec2 at)
{
    return belt->turn == 0.0 ? belt->velocity
                             : vec2_scale(vec2_turn_left(vec2_sub(at, belt->centre)), belt->turn);
}

/// The friction of cargo on a belt over that of contacts, by which what the latter does is multiplied; 1 where that is 0.
static inline double belt_friction_ratio(const scene_belt *belt, const scene_contact *conveyor)
{
    return belt->friction > 0.0 && conveyor->friction > 0.0 ? belt->friction / conveyor->friction
                                                            : 1.0;
}

/// True if every belt is level and runs along +x1 at all times: then the congested closure has a law for each direction by itself.
bool belt_are_forward(size_t n_belts, const scene_belt *belts);

/// The largest |v_T| on a belt, m/s: that at a corner, as it is convex in x; of one without corners that of `velocity`.
double belt_largest_speed(const scene_belt *belt);

/// True if a place is on a belt, with SCENE_TOLERANCE.
bool belt_holds(const scene_belt *belt, vec2 at);

/// Distance from a place to the nearest border of a belt, of an arc to its circles and ends, m; DBL_MAX if it has none.
double belt_border_distance(const scene_belt *belt, vec2 at);

/// True if no border of an arc's polygon is as near to a place as a distance, m; false of other belts.
bool belt_arc_is_far(const scene_belt *belt, vec2 at, double distance);

/// The angle over which an arc extends, rad.
static inline double belt_arc_angle(const scene_arc *arc)
{
    return fabs(arc->to - arc->from);
}

/// True if a belt's borders are stairs on a grid that its velocity crosses: of arcs, and of straight sections of paths aslant. Such a
/// belt is described by lanes along it, of a stream function of the place q across it,
///
///     arc       q the distance to the centre,                          psi = turn q^2/2
///     straight  q to the right of the centre line, seen along it,      psi = (velocity . along) q
static inline bool belt_has_lanes(const scene_belt *belt)
{
    return belt->arc.is_given ||
           (belt->leg.is_given && belt->leg.along.x != 0.0 && belt->leg.along.y != 0.0);
}

/// q of a place, m.
static inline double belt_lane_at(const scene_belt *belt, vec2 at)
{
    const scene_leg *leg = &belt->leg;

    return belt->arc.is_given ? vec2_length(vec2_sub(at, belt->centre))
                              : vec2_cross(vec2_sub(at, leg->start), leg->along);
}

/// q of the border where it is least, and where it is largest, m.
static inline double belt_lane_low(const scene_belt *belt)
{
    return belt->arc.is_given ? belt->arc.inner_radius : -0.5 * belt->leg.width;
}

static inline double belt_lane_high(const scene_belt *belt)
{
    return belt->arc.is_given ? belt->arc.outer_radius : 0.5 * belt->leg.width;
}

/// By how much psi rises from one q to another, m2/s.
static inline double belt_lane_rise(const scene_belt *belt, double from, double to)
{
    return belt->arc.is_given ? 0.5 * belt->turn * (to - from) * (to + from)
                              : vec2_dot(belt->velocity, belt->leg.along) * (to - from);
}

/// True if a place beside a belt with lanes lies between its ends; those of sections of paths are looked for a margin further, m:
/// their borders go on there.
bool belt_lanes_span(const scene_belt *belt, vec2 at, double margin);

/// True if a place, seen from the centre of a resolved arc, is between its ends, or beyond them by at most a margin, m.
bool belt_arc_spans(const scene_arc *arc, vec2 from_centre, double margin);

/// Derive of an arc that is sound: reference radius, angular velocity, rays, polygon. Nothing of other belts. BF_ENOMEM.
BF_MUST_CHECK bf_status belt_resolve_arc(scene_belt *belt, bf_error *err);
