/// The distance of two convex hulls, by Gilbert, Johnson and Keerthi's algorithm, or the depth of
/// their penetration, by the expanding polytope on their Minkowski difference. Where rounding leaves
/// these without a normal along which the hulls are as far apart as they say, all faces and edges are tried.
///
/// All vectors are in the frame of hull a. The normal is the unit vector from a to b: the shortest
/// move of b that brings them just into touch is (depth) * normal. Both algorithms end after
/// finitely many steps with the exact feature of the polytopes, to rounding.

#pragma once

#include "core/base/vec3.h"
#include "core/convex/hull.h"

#include <stdbool.h>

/// Two hulls, the second as seen from the first.
typedef struct gjk_pair {
    const hull *a;    ///< borrowed
    const hull *b;    ///< borrowed
    mat3 rotation;    ///< from b's frame into a's
    vec3 translation; ///< origin of b in a's frame, m
} gjk_pair;

/// The result.
typedef struct gjk_result {
    double distance; ///< m; below 0: minus the depth of penetration
    vec3 normal;     ///< see above
    vec3 on_a;      ///< witnesses: the points of a and b that are nearest to each other, or deepest
    vec3 on_b;      ///< inside each other
    int n_vertices; ///< 1 to 3: they are weighted means of these vertices
    uint8_t of_a[3]; ///< numbers of vertices of a
    uint8_t of_b[3]; ///< same of b
} gjk_result;

/// The pair of two hulls at places x with rotations r.
gjk_pair gjk_pair_of(const hull *a, vec3 x_a, const mat3 *r_a, const hull *b, vec3 x_b,
                     const mat3 *r_b);

/// A distance, m, that the hulls are apart by at least; 0 if they touch. *axis is where the search
/// starts, a guess of the direction from a to b, not 0, and is left as one that separates them, if
/// they are apart. Ends as soon as it has found any such direction.
double gjk_find_gap(const gjk_pair *pair, vec3 *axis);

/// Distance or depth. axis as above. Where more than one direction has the least depth, one of
/// them.
gjk_result gjk_measure(const gjk_pair *pair, vec3 axis);
