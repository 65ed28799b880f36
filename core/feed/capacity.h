/// How many parts belts can take from a feed.
///
/// Units    SI.

#pragma once

#include "core/scene/scene.h"

/// The line of a checked scene's feed, about its middle as long as the smallest kind of parts is wide at least: parts of a lane in
/// single file have their centres on a line that is shorter than they are wide. It ends at the domain's sides, and at plates that stand
/// there at t = 0.
void feed_wide_line(const scene *s, const scene_feed *feed, vec2 ret_line[2]);

/// Parts/s that belts can carry away from the line of a checked scene's feed at most: rho_max times the area that the
/// line, as wide as a part, w = 1/sqrt(rho_max), sweeps in a second,
///
///     rho_max ( integral of |v_T . n| along it  +  w times the mean of |v_T| on it ),
///
/// n its normal, rho_max scene_packing_density(), v_T with the largest factor of each belt's speed schedule. Midpoint
/// rule with CAPACITY_POINTS points.
double feed_capacity(const scene *s, const scene_feed *feed);

enum { CAPACITY_POINTS = 1000 };
