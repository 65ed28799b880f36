/// How many parts belts can take from a feed.
///
/// Units    SI.

#pragma once

#include "core/scene/scene.h"

/// Parts/s that belts can carry away from the line of a checked scene's feed at most: rho_max times the area that the
/// line, as wide as a part, w = 1/sqrt(rho_max), sweeps in a second,
///
///     rho_max ( integral of |v_T . n| along it  +  w times the mean of |v_T| on it ),
///
/// n its normal, rho_max scene_packing_density(), v_T with the largest factor of each belt's speed schedule. Midpoint
/// rule with CAPACITY_POINTS points.
double feed_capacity(const scene *s, const scene_feed *feed);

enum { CAPACITY_POINTS = 1000 };
