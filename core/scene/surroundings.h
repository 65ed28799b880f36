/// The surroundings of the parts: belts, plates, edges of the domain.
///
/// The only implementation, for both models, the placement of parts and the checks, of
///
///     which belt lies under a point, and which one carries what has its centre there (how fast it moves at a
///     time: belt_speeds.h);
///     what a straight piece of a plate is: tangent, length, thickness and upstream side;
///     what a side of the domain is, and whether a point is outside.
///
/// A solver may precompute from these functions the data of its loops.
///
/// Carried  is a point under which a belt lies, and one in a gap that a part of radius r bridges: both the point and the
///          place where the way to it from the nearest belt leaves that belt lie in the convex hull of what of the belts
///          is nearer to them than r. A part whose lower face is a disk of radius r rests there on both sides of its
///          centre; else it tips over. So a gap between two straight borders is bridged where it is narrower than r, and
///          no belt carries anything beyond a border behind which nothing is. Beyond the sides of the domain lie the
///          mirror images of the belts: a gap between a belt and a side is bridged where it is narrower than r/2. In a
///          gap the nearest belt carries, of equally near ones the later one. r of a part is shape_inner_radius(): a
///          cylinder's radius, half the least width of a box.
///          What has its centre off every belt, in the domain, falls; where there is no belt at all, nothing does.
/// Units    SI.
/// Choice   borders of belts are taken with SCENE_TOLERANCE in favour of the belt. A piece that runs along the belt is a
///          guide and has no upstream side. The body of a path lies on one side of it, downstream of the piece at its ends
///          that is no guide: the first of those up to SURROUNDINGS_JOINED from an end, and of the two ends the upstream one,
///          where they differ. Where these are all guides, a guide takes the side of the nearest piece that is none, at most
///          SURROUNDINGS_JOINED away, and any other piece has its body downstream. Without any such piece a guide is centred
///          on its path, and its left side is used, seen from its start.

#pragma once

#include "core/base/status.h"
#include "core/base/vec2.h"
#include "core/scene/belt.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// The surroundings, borrowed from a scene, or with belts of their own after surroundings_copy().
typedef struct surroundings {
    scene_rect domain;                  ///< m
    scene_edge edges[SCENE_SIDE_COUNT]; ///< what its sides are
    size_t n_belts;                     ///< belts
    const scene_belt *belts;            ///< where they overlap the later one wins
    double bridge; ///< r of the part that bridges least, m: what gaps places are carried over
} surroundings;

enum { SURROUNDINGS_JOINED = 8 }; ///< pieces from an end, or a guide, that a side is taken from

/// Sine of the angle between a piece and its belt up to which the piece is a guide, 0.1 degrees: typed coordinates are
/// rounded.
#define SURROUNDINGS_GUIDE_SINE 1.745e-3

/// Narrower slits between belts are none, m.
#define SURROUNDINGS_SLIT 2e-6

/// A straight piece of a plate.
typedef struct surroundings_piece {
    vec2 start;    ///< of its path, m
    vec2 end;      ///< of its path, m
    vec2 along;    ///< unit tangent t from start to end
    vec2 upstream; ///< unit normal n of the upstream side: n . v_T <= 0 for the belt in its middle
    double length; ///< m
    double thickness; ///< of the plate, m
    double lift;      ///< how far its upstream face lies upstream of its path, m: 0; the thickness,
                      ///< where the body does; of a centred guide half of it
} surroundings_piece;

/// The straight line that a side of the domain lies on.
typedef struct surroundings_line {
    vec2 at;     ///< a point of it, m
    vec2 inward; ///< unit normal into the domain
} surroundings_line;

/// The surroundings of a scene, which must outlive them.
surroundings surroundings_of(const scene *s);

/// A copy of *from with belts of its own, without their speed schedules: surroundings_fini(). BF_ENOMEM;
/// *ret_copy is then empty.
BF_MUST_CHECK bf_status surroundings_copy(const surroundings *from, surroundings *ret_copy,
                                          bf_error *err);

/// Free what a copy owns and zero it.
void surroundings_fini(surroundings *copy);

/// Index of the belt that lies under a point; n_belts: none does.
size_t surroundings_belt_below(const surroundings *around, vec2 at);

/// Index of the belt that carries a part of radius r, m, whose centre is there; n_belts off every belt.
size_t surroundings_belt_under(const surroundings *around, vec2 at, double radius);

/// The same for the part that bridges least: a place where this is n_belts is off the belts.
size_t surroundings_belt_at(const surroundings *around, vec2 at);

/// True if what `belt`, one of the above for a place in the domain, does not carry falls there.
static inline bool surroundings_falls(const surroundings *around, size_t belt)
{
    return around->n_belts > 0 && belt == around->n_belts;
}

/// True if there are belts, and a place in the domain, wider than SURROUNDINGS_SLIT, is under none: parts may fall. Exact
/// unless it takes more than some 10 ms: then true.
bool surroundings_may_drop(const surroundings *around);

/// True if cargo can leave the domain from a belt: it covers the domain, or some of a side that is an outflow lies along it.
bool surroundings_is_outlet(const surroundings *around, size_t belt);

/// v_T of a belt at a place, m/s, at which it moves when its factor (belt_speeds.h) is 1; zero for n_belts, off every belt.
static inline vec2 surroundings_velocity_at(const surroundings *around, size_t belt, vec2 at)
{
    return belt < around->n_belts ? belt_velocity(&around->belts[belt], at) : (vec2){ 0.0, 0.0 };
}

/// v_T under a point, of surroundings_belt_at(), m/s.
vec2 surroundings_velocity_under(const surroundings *around, vec2 at);

/// Distance from a point to the nearest border of a belt, m; DBL_MAX if no belt has one.
double surroundings_border_distance(const surroundings *around, vec2 at);

/// True if a piece with unit tangent `along` runs along a belt, or the belt stands.
bool surroundings_is_guide(vec2 along, vec2 belt);

/// The upstream normal of a piece with unit tangent `along` on a belt; of a guide the left one.
vec2 surroundings_upstream(vec2 along, vec2 belt);

/// Piece k, 0 <= k < n_points - 1, of an obstacle's plate. Its upstream side is that of v_T, whatever the
/// belt's speed at a time.
surroundings_piece surroundings_piece_of(const surroundings *around, const scene_obstacle *obstacle,
                                         size_t k);

/// The same for the points first < last of the path, where it is straight in between.
surroundings_piece surroundings_span_of(const surroundings *around, const scene_obstacle *obstacle,
                                        size_t first, size_t last);

/// The corners of a piece with its thickness, counter-clockwise.
void surroundings_piece_corners(const surroundings_piece *piece, vec2 ret_corners[4]);

/// The line of a side of the domain.
surroundings_line surroundings_side(const surroundings *around, scene_side side);

/// True if a point lies in the domain or on its border.
static inline bool surroundings_is_inside(const scene_rect *domain, vec2 at)
{
    return at.x >= domain->x_min && at.x <= domain->x_max && at.y >= domain->y_min &&
           at.y <= domain->y_max;
}

/// How far a point lies beyond a side of the domain, m; negative inside.
static inline double surroundings_excess(const surroundings *around, scene_side side, vec2 at)
{
    const scene_rect *d = &around->domain;

    switch (side) {
    case SCENE_WEST:
        return d->x_min - at.x;
    case SCENE_EAST:
        return at.x - d->x_max;
    case SCENE_SOUTH:
        return d->y_min - at.y;
    default:
        return at.y - d->y_max;
    }
}

/// True if a point has left the domain: it lies beyond a side that is not a wall.
static inline bool surroundings_is_outside(const surroundings *around, vec2 at)
{
    bool is_outside = false;

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        is_outside |= around->edges[side] != SCENE_EDGE_WALL &&
                      surroundings_excess(around, (scene_side)side, at) > 0.0;
    return is_outside;
}
