/// Points, segments and polygons in the plane.
///
/// Polygons are lists of corners; the last is joined to the first. Lengths are m throughout.

#pragma once

#include "core/base/vec2.h"

#include <stdbool.h>
#include <stddef.h>

/// Distance from a point to the segment from start to end.
double polygon_segment_distance(vec2 at, vec2 start, vec2 end);

/// True if along x or y a point is beyond both ends of a segment by more than distance: a quick test which parts of a polygon
/// need a closer look. False says nothing.
static inline bool polygon_segment_is_far(vec2 at, vec2 start, vec2 end, double distance)
{
    return (at.x > start.x + distance && at.x > end.x + distance) ||
           (at.x + distance < start.x && at.x + distance < end.x) ||
           (at.y > start.y + distance && at.y > end.y + distance) ||
           (at.y + distance < start.y && at.y + distance < end.y);
}

/// The point of the segment from start to end that is nearest to a point.
vec2 polygon_segment_nearest(vec2 at, vec2 start, vec2 end);

/// Cut the segment from *start to *end at a rectangle, which keeps its border. False: nothing of it lies
/// inside, and both are as before.
bool polygon_clip_segment(vec2 *start, vec2 *end, vec2 lower, vec2 upper);

/// True if the segments a and b cross or come as near as tolerance. Conservative: cases
/// that rounding leaves undecided count as touching.
bool polygon_segments_touch(vec2 a_start, vec2 a_end, vec2 b_start, vec2 b_end, double tolerance);

/// True if the point lies in the polygon or within tolerance of its border.
bool polygon_holds(const vec2 *polygon, size_t n, vec2 at, double tolerance);

/// Signed area, positive for counter-clockwise corners, m2.
double polygon_area(const vec2 *polygon, size_t n);

/// True if no two sides of the polygon cross or touch, and all have a positive length.
bool polygon_is_simple(const vec2 *polygon, size_t n, double tolerance);

/// True if every corner lies left of every side, or as near as tolerance to it: the polygon is
/// convex and runs counter-clockwise, once.
bool polygon_is_convex(const vec2 *polygon, size_t n, double tolerance);

/// Corners of the convex hull of n points, counter-clockwise, into ret_hull, which has room for n + 1.
/// Returns how many: at least 1 (all points equal) for n >= 1. Sorts points.
size_t polygon_convex_hull(vec2 *points, size_t n, vec2 *ret_hull);

/// True if a disk overlaps a convex counter-clockwise polygon by more than tolerance: its centre lies
/// inside, or nearer to a side than radius - tolerance.
bool polygon_overlaps_disk(vec2 centre, double radius, const vec2 *polygon, size_t n,
                           double tolerance);

/// True if two convex counter-clockwise polygons overlap by more than tolerance: no side of either
/// separates them (separating axis theorem).
bool polygon_overlaps(const vec2 *a, size_t n_a, const vec2 *b, size_t n_b, double tolerance);

/// Distance of two convex counter-clockwise polygons, and the nearest points of each; 0 if they overlap
/// (the points are then not set). Two that touch may be apart by the rounding of their coordinates.
double polygon_distance(const vec2 *a, size_t n_a, const vec2 *b, size_t n_b, vec2 *ret_on_a,
                        vec2 *ret_on_b);
