/// The contact region of two convex hulls: a polygon, a line or a point, as contact
/// points with depths and weights.
///
/// The face with the least depth of penetration (gjk.h) is the reference. The face of the
/// other hull whose normal is most opposed to it is clipped by the planes through the reference's sides and
/// by its own plane; what is left are the contact points, so that a box rests on a box on up to
/// eight of them. Where two edges cross there is one point.
///
/// Weights   the fraction of stiffness and dashpot of the contact that acts in a point: half the two sides
///          of the polygon that meet there, divided by its outline. They sum to 1, however many
///          points there are and however close some are together, and change smoothly as the bodies
///          move. A flat contact thus has stiffness k, an edge that lies in a face k/2, as half of
///          its outline is in depth 0, a corner k/4 to 0.3 k; crossing edges have k/4.
/// Near     where hulls are apart, but by less than a distance `near`, the corners of the face that
///          are above the reference by less than that are points too, of depth <= 0: they may come
///          into touch. They follow those that are below, as if nothing were below; near = 0: none.

#pragma once

#include "core/convex/gjk.h"

enum { MANIFOLD_POINTS_MAX = 2 * HULL_POINTS_MAX + 2 }; ///< two faces clipped, and once more

/// The kind of feature with the least depth.
typedef enum manifold_kind {
    MANIFOLD_NONE,   ///< nothing known
    MANIFOLD_FACE_A, ///< a face of a
    MANIFOLD_FACE_B, ///< a face of b
    MANIFOLD_EDGES,  ///< an edge of each
} manifold_kind;

/// The same with its number.
typedef struct manifold_feature {
    uint16_t kind; ///< manifold_kind
    uint16_t of_a; ///< face or edge of a
    uint16_t of_b; ///< face or edge of b
} manifold_feature;

/// A contact point.
typedef struct manifold_point {
    vec3 at;       ///< in the middle of the overlap, m
    double depth;  ///< along the normal, m; < 0: apart
    double weight; ///< see above
} manifold_point;

/// The region.
typedef struct manifold {
    vec3 normal;    ///< of length 1, from a to b
    double depth;   ///< by which the hulls overlap along the normal, m; <= 0: they do not
    bool is_least;  ///< no other direction close by has less depth
    size_t n;       ///< points; 0 if depth <= -near, or where the feature misses the other hull
    size_t n_below; ///< the first ones, which overlap
    manifold_point point[MANIFOLD_POINTS_MAX]; ///< see there
} manifold;

/// The surface of a solid: the points p with normal . p = offset, or a strip of it.
typedef struct manifold_plane {
    vec3 normal;        ///< of length 1, out of the solid
    double offset;      ///< m
    double half_length; ///< of the strip along `along` about `middle`, m; 0: the whole plane
    vec3 along;         ///< of length 1, at right angles to normal
    vec3 middle;        ///< m
} manifold_plane;

/// The feature that carries a touch which gjk_measure() found to overlap.
manifold_feature manifold_feature_of(const gjk_pair *pair, const gjk_result *touch);

/// The region at a feature, in a's frame. While is_least holds the feature still carries the
/// (locally) least depth, and no search is needed. kind is not MANIFOLD_NONE.
void manifold_find(const gjk_pair *pair, manifold_feature feature, double near,
                   manifold *ret_manifold);

/// The single point of a touch, in a's frame.
void manifold_from_result(const gjk_result *touch, manifold *ret_manifold);

/// Where a region is a single point, of edges that cross or of corners, and a face of either hull is nearly parallel to
/// the contact: all points of these faces that are nearer than `near`, with their depths along the same normal. The point
/// itself is about the deepest of them.
void manifold_widen(const gjk_pair *pair, double near, manifold *m);

/// The region of a hull at x with rotation r below the surface of a solid; its normal is the
/// plane's. All in the world's frame.
void manifold_on_plane(const hull *h, vec3 x, const mat3 *r, const manifold_plane *plane,
                       double near, manifold *ret_manifold);
