/// What placement.c and placement_check.c share.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/shape.h"

/// How far a part reaches over a side of the domain, m: with its footprint over a wall, with its
/// centre over any side. Negative inside.
double placement__excess(const scene *s, const shape_footprint *footprint, scene_pose pose,
                         scene_side side);
