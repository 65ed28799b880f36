/// Geometry of the shape of a part: its footprint on the belt and its volume.

#pragma once

#include "core/base/faults.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// The outline of a part seen from above, in its own frame.
typedef struct shape_footprint {
    size_t n_corners;                     ///< 0: a disk
    vec2 corners[SCENE_VERTICES_MAX + 1]; ///< of a convex polygon, counter-clockwise, m
    double bounding_radius;               ///< from the origin to the farthest point, m
    double area;                          ///< m2
} shape_footprint;

/// The footprint of a checked shape.
shape_footprint shape_footprint_of(const scene_shape *shape);

/// Distance from the centre of the area of a checked shape's footprint to its border, m: of a cylinder its radius, of a
/// box half its least width.
double shape_inner_radius(const scene_shape *shape);

/// Volume of a checked shape, m3; of a hull by its facets.
double shape_volume(const scene_shape *shape);

/// Density of close packing of one shape, see scene_packing_density().
double shape_packing_density(const scene_shape *shape);

/// Note every fault of a shape; pointers begin with that of the shape ("/cargo/shape").
void shape_check(const scene_shape *shape, const char *pointer, bf_faults *faults);

/// True if shape_check() has nothing to note.
bool shape_is_sound(const scene_shape *shape);

/// True if two parts, or a part and a convex counter-clockwise polygon, overlap by more than SCENE_TOLERANCE.
bool shape_overlaps(const shape_footprint *of_a, scene_pose a, const shape_footprint *of_b,
                    scene_pose b);
bool shape_overlaps_polygon(const shape_footprint *footprint, scene_pose pose, const vec2 *corners,
                            size_t n);

/// How far a footprint at a heading, rad, extends from its origin in a direction of length 1, m.
double shape_extent(const shape_footprint *footprint, double heading, vec2 direction);

/// The direction of a part's own x axis at a heading, rad.
vec2 shape_direction(double heading);

/// Corners of the footprint of a part in its place, into ret_corners; with the direction of its heading the same
/// without a sine.
void shape_place_along(const shape_footprint *footprint, vec2 centre, vec2 direction,
                       vec2 *ret_corners);
void shape_place(const shape_footprint *footprint, scene_pose pose, vec2 *ret_corners);
