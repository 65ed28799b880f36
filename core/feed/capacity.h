/// How many parts belts can take from a feed.
///
/// Units    SI.

#pragma once

#include "core/scene/scene.h"

/// Parts/s that belts can carry away from the line of a checked scene's feed at most: the integral of
/// rho_max |v_T . n| along it, n its normal (scene_packing_density()), with the largest factor of each belt's speed
/// schedule; rho_max |v_T| for a line without length. The line counts as longer by a part's width, 1/sqrt(rho_max),
/// as it is the parts' centres that lie on it. Midpoint rule with CAPACITY_POINTS points.
double feed_capacity(const scene *s, const scene_feed *feed);

enum { CAPACITY_POINTS = 1000 };
