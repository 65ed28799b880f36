/// How much faster than its belt a density may be on the cells of an arc.
///
/// On a grid the borders and guides of an arc are stairs, at most cell/sqrt(2) beside them. Radii that the stream function of
/// core/macro/arc_faces.h takes at corners differ by at most ARC_LANES_SPREAD times the distance of the corners, but where the
/// stairs of two lines come nearer to each other than that, with W the width of the lane between them in cells:
///
///     speedup = max(ARC_LANES_SPREAD, min(W/sqrt(2), W/(W - sqrt(2))))     of the lane for which it is largest, at most 2
///
/// A velocity across a face is at most speedup times the largest |v_T| of the arc, and what a cell loses through all its faces
/// sqrt(2) times that, its diagonal. Guides at less than a cell from each other or from a border are one line.

#pragma once

#include "core/scene/types.h"

/// Largest ratio of the difference of two corners' radii to their distance in wide lanes.
#define ARC_LANES_SPREAD 1.25

/// The speedup on an arc of a resolved scene with cells of this edge, m.
double arc_lanes_speedup(const scene *s, const scene_belt *belt, double cell);
