/// Plane geometry of points, segments and polygons.
///
/// Polygons are lists of corners; the last is joined to the first. Lengths are m throughout.

#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// Sum, difference, multiple, inner product and cross product (z component) of vectors.
scene_point geometry_add(scene_point a, scene_point b);
scene_point geometry_subtract(scene_point a, scene_point b);
scene_point geometry_scale(scene_point a, double factor);
double geometry_dot(scene_point a, scene_point b);
double geometry_cross(scene_point a, scene_point b);

/// Length of a vector, by sqrt alone: the same bits everywhere, and |(x, 0)| = |x| exactly.
double geometry_length(scene_point a);

/// a turned left by a right angle.
scene_point geometry_turn_left(scene_point a);

/// True if both coordinates are finite.
bool geometry_is_finite(scene_point a);

/// Distance from a point to the segment from start to end.
double geometry_distance(scene_point at, scene_point start, scene_point end);

/// True if the segments a and b cross or come as near as tolerance. Never wrongly false: what
/// rounding leaves open counts as touching.
bool geometry_segments_touch(scene_point a_start, scene_point a_end, scene_point b_start,
                             scene_point b_end, double tolerance);

/// True if the point lies in the polygon or within tolerance of its border.
bool geometry_polygon_holds(const scene_point *polygon, size_t n, scene_point at, double tolerance);

/// Signed area, positive for counter-clockwise corners, m2.
double geometry_polygon_area(const scene_point *polygon, size_t n);

/// True if no two sides of the polygon cross or touch, and none has no length.
bool geometry_polygon_is_simple(const scene_point *polygon, size_t n, double tolerance);

/// True if every corner lies left of every side, or as near as tolerance to it: the polygon is
/// convex and runs counter-clockwise, once.
bool geometry_polygon_is_convex(const scene_point *polygon, size_t n, double tolerance);

/// Corners of the convex hull of n points, counter-clockwise, into ret_hull, which has room for n + 1.
/// Returns how many: at least 1 (all points equal) for n >= 1. Sorts points.
size_t geometry_convex_hull(scene_point *points, size_t n, scene_point *ret_hull);

/// True if a disk overlaps a convex counter-clockwise polygon by more than tolerance: its centre lies
/// inside, or nearer to a side than radius - tolerance.
bool geometry_disk_overlaps(scene_point centre, double radius, const scene_point *polygon, size_t n,
                            double tolerance);

/// True if two convex counter-clockwise polygons overlap by more than tolerance: no side of either
/// has the other one beyond it (separating axes).
bool geometry_convex_overlap(const scene_point *a, size_t n_a, const scene_point *b, size_t n_b,
                             double tolerance);
