/// Where obstacles may come to: what schedule and actions tell them, and how fast they are at most.
///
/// Between what it is told a plate may have any angle, and any shift of the box that its shifts span: a command
/// acts from wherever it is, and a drive that is behind goes straight to where it is told.
///
/// Units    SI, angles in rad.

#pragma once

#include "core/base/vec2.h"
#include "core/scene/types.h"

#include <stdbool.h>
#include <stddef.h>

/// What an obstacle is told.
typedef struct plate_range {
    bool moves;      ///< a schedule or an action turns or shifts it
    bool is_shifted; ///< it shifts it
    double least;    ///< angle, rad
    double most;     ///< same
    vec2 low;        ///< corner of the box of its shifts, m
    vec2 high;       ///< the other one
    vec2 ends[2];    ///< shifts that are far from each other, m
    bool is_line;    ///< all lie on the line between these two
} plate_range;

/// That of obstacle k.
plate_range plate_range_of(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                           const scene_action *actions);

/// The largest distance of an obstacle's path, thickness included, from its pivot, m.
double plate_range_radius(const scene_obstacle *obstacle);

/// How far a place is from the nearest one that the pivot may have, m.
double plate_range_distance(const plate_range *range, vec2 pivot, vec2 at);

/// The fastest that an obstacle ever moves.
typedef struct plate_range_speed {
    double turning;  ///< angular velocity times plate_range_radius(), m/s; INFINITY: it jumps
    double shifting; ///< m/s; likewise
} plate_range_speed;

/// That of obstacle k, by its schedule or by an action from any place that it may have.
plate_range_speed plate_range_fastest(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                                      const scene_action *actions);

/// Both together: the fastest that a point of it ever moves, m/s.
double plate_range_largest_speed(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                                 const scene_action *actions);
