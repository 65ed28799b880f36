/// Belts as plain data.
///
/// Units    SI: m, s, m/s. Angles are radians.

#pragma once

#include "core/base/vec2.h"
#include "core/scene/equipment_types.h"
#include "core/scene/limits.h"

#include <stdbool.h>
#include <stddef.h>

/// How the speed of a belt changes in time: it moves at factor times its velocity. The factor is 1 before the
/// first time; see belt_speeds.h.
typedef struct scene_speed_schedule {
    size_t n_times;   ///< 0: the factor is 1 at all times (default)
    double *times;    ///< from which on a target applies, s, >= 0, rising
    size_t n_factors; ///< as many as there are times
    double *factors;  ///< the targets; below 0: the belt runs backwards
} scene_speed_schedule;

/// The outline of a belt that turns about its centre, a curve: a sector of a ring. It moves from `from` to `to`.
typedef struct scene_arc {
    bool is_given;           ///< the belt is one (default false)
    double inner_radius;     ///< m, > 0
    double outer_radius;     ///< m, > inner_radius
    double from;             ///< angle from the x axis, counter-clockwise, rad
    double to;               ///< same; by at most a whole turn from `from`: above it the belt turns
                             ///< counter-clockwise, below it clockwise
    double reference_radius; ///< with the size of its velocity, m (default: the mean of both)
    vec2 rays[2]; ///< unit vectors from the centre to both ends, counter-clockwise from the first
                  ///< one to the second; set by scene_resolve()
} scene_arc;

/// The outline of a belt along a line: straights joined by arcs. It moves from the first point to the last one.
typedef struct scene_belt_path {
    size_t n_points; ///< 0: the belt is none (default); else >= 2
    vec2 *points;    ///< corners of its centre line, m
    size_t n_radii;  ///< n_points - 2
    double *radii;   ///< of the centre line at each inner corner, m, > half the width
    double width;    ///< m, > 0 (no default)
} scene_belt_path;

/// A straight section of a path.
typedef struct scene_leg {
    bool is_given; ///< the belt is one; set by scene_resolve()
    vec2 start;    ///< of its centre line, m
    vec2 along;    ///< unit vector
    double length; ///< m
    double width;  ///< m
} scene_leg;

/// A conveyor: a polygon that carries what lies on it. Where belts overlap the later one applies.
typedef struct scene_belt {
    char id[SCENE_ID_SIZE]; ///< unique among belts (default "main", then "belt-<n>", n from 2)
    vec2 velocity;          ///< v_T, m/s (default 0.395, 0); of one that turns only its size counts
    double turn; ///< angular velocity about the centre, rad/s; 0: it is straight (default 0); of an
                 ///< arc set by scene_resolve()
    vec2 centre; ///< see turn, m
    scene_arc arc;        ///< see there; of a section of a path set by scene_resolve()
    scene_belt_path path; ///< see there; of the belt alone, which is the first of its sections
    scene_leg leg;        ///< see there
    size_t
        of; ///< of a section behind the belts of the document: whose it is; set by scene_resolve()
    size_t
        first_section; ///< of its sections but itself, which follow each other; set by scene_resolve()
    size_t n_more;     ///< how many those are; 0: the belt is no path, or has one section
    double incline;    ///< of its rise along its velocity, rad: belt_slope.h (default 0)
    double friction;     ///< mu of cargo on it, > 0; 0: that of contacts (default 0)
    double acceleration; ///< with which its speed rises, m/s2, > 0 (default INFINITY: at once)
    double deceleration; ///< with which it falls, m/s2, > 0 (default INFINITY: at once)
    scene_speed_schedule speed_schedule; ///< see there
    scene_stops stops;                   ///< see there
    bool is_commanded;     ///< there is an action that changes its speed; set by scene_resolve()
    double command_factor; ///< the largest size of a factor of these; set by scene_resolve()
    bool command_reverses; ///< one of these factors is below 0; set by scene_resolve()
    bool
        is_outlet; ///< it lies along some of a side over which cargo leaves; set by scene_resolve()
    size_t n_points; ///< 0: the belt covers the domain
    vec2 *polygon;   ///< simple polygon, n_points >= 3 corners, m; of an arc set by scene_resolve()
} scene_belt;
