/// Scenes that several tests are about.

#pragma once

#include "core/base/random.h"
#include "core/scene/scene.h"

#include <math.h>

/// cmocka's own comparison of numbers is one of floats.
#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

/// A belt of length x width, m, without obstacles, with n parts at the places; cells of cell, m. Not
/// resolved yet; scene_fini().
void helper_scene_belt(scene *s, double length, double width, double cell, const scene_pose *poses,
                       size_t n);

/// The paper's Examples 1 (60 degrees) and 2 (90 degrees), as core/scene/README.md lays them out; resolved.
void helper_scene_example(scene *s, double angle_deg, scene_treatment treatment);

/// Append an obstacle with default widths along a path of n points; borrowed until the next one.
scene_obstacle *helper_scene_add_obstacle(scene *s, const vec2 *path, size_t n,
                                          scene_treatment treatment);

/// Append a belt over a polygon of n corners, 0 for the whole domain; borrowed until the next one.
scene_belt *helper_scene_add_belt(scene *s, vec2 velocity, const vec2 *polygon, size_t n);

/// Append an arc about the origin between two radii, m, and two angles, degrees, with this speed in its middle.
scene_belt *helper_scene_add_arc(scene *s, double speed, double inner, double outer, double from,
                                 double to);

/// Append a belt of this speed and width, m, along a path of n points, with the same radius at each corner.
scene_belt *helper_scene_add_path(scene *s, double speed, double width, double radius,
                                  const vec2 *points, size_t n);

/// Append a feed over all of a side of the domain at a steady rate, 1/s; borrowed until the next one.
scene_feed *helper_scene_add_feed(scene *s, scene_side edge, scene_arrivals arrivals, double rate);

/// Let the speed of a belt follow a schedule of n times, with copies of both arrays.
void helper_scene_schedule(scene_belt *belt, size_t n, const double *times, const double *factors);

/// scene_resolve() that must succeed.
void helper_scene_resolve(scene *s);

/// Turn the cargo into a prism or a hull of n vertices.
void helper_scene_set_vertices(scene *s, scene_shape_type type, const double (*vertices)[3],
                               size_t n);

/// A series of n times, with copies of both arrays.
scene_series helper_scene_series(size_t n, const double *times, const double *values,
                                 double repeat);

/// A number from low to high; now and then one of the places of a grid of cells, which are the hard cases.
double helper_scene_draw(bf_random *random, double low, double high, double cell);

/// A belt of 0.3 m/s to the east and 0.4 m/s to the north, 0.5 m/s, and a schedule of its speed; it borrows both arrays.
scene_belt helper_scene_oblique_belt(double acceleration, double deceleration, size_t n,
                                     double *times, double *factors);

/// Failures at drawn times, and a time that is always the same.
scene_failure helper_scene_failure(const char *id, scene_drawn_time between,
                                   scene_drawn_time repair);
scene_drawn_time helper_scene_fixed_time(double mean);
