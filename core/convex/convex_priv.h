/// Points and simplices of the Minkowski difference a - b, used by gjk.c, epa.c and features.c.

#pragma once

#include "core/convex/gjk.h"

/// A point of the difference.
typedef struct minkowski__point {
    vec3 at;      ///< vertex of a minus vertex of b, m
    uint8_t of_a; ///< which vertex of a
    uint8_t of_b; ///< which vertex of b
} minkowski__point;

/// A simplex and the point of it that is nearest to the origin.
typedef struct gjk__simplex {
    int n;                     ///< corners, 0 to 4
    minkowski__point point[4]; ///< see there
    double weight[4];          ///< the nearest point is the sum of weight * corner
} gjk__simplex;

/// The farthest point of the difference in direction d.
minkowski__point minkowski__support(const gjk_pair *pair, vec3 d);

/// Size of the difference, m: rounding is measured by it.
double minkowski__size(const gjk_pair *pair);

/// The contact at the weighted mean of n points of the difference.
gjk_result minkowski__witnesses(const gjk_pair *pair, const minkowski__point *points,
                                const double *weights, int n);

/// Depth of two hulls that overlap or touch, from the simplex where the search for their distance
/// ended.
gjk_result epa__penetrate(const gjk_pair *pair, const gjk__simplex *start, vec3 axis);

/// Replace a touch by one along the normal of a face or of two edges if the hulls are farther apart, or less
/// deep in each other, along it. touch->distance is the gap along touch->normal.
void features__search(const gjk_pair *pair, gjk_result *touch);
