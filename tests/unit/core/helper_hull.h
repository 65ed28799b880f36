/// Hulls that several tests are about, and the distance of two of them by exhaustive search.

#pragma once

#include "core/base/random.h"
#include "core/convex/gjk.h"
#include "core/convex/hull.h"

/// A number from low to high, and a rotation, each as likely as any other.
double helper_hull_number(bf_random *random, double low, double high);
mat3 helper_hull_rotation(bf_random *random);

/// The hull of n random points in a ball of a radius; one without faces if n < 4.
void helper_hull_random(bf_random *random, size_t n, double radius, hull *ret_hull);

/// A cuboid around the origin.
void helper_hull_box(double length, double width, double height, hull *ret_hull);

/// Signed distance of two hulls with faces by trying everything: the largest gap along any normal
/// of a face or of two edges if they overlap, else the least distance of any two features.
double helper_hull_distance(const gjk_pair *pair);
