/// What placement.c and placement_check*.c share.

#pragma once

#include "core/scene/placement.h"
#include "core/scene/shape.h"

/// How far a part reaches over a side of the domain, m: with its footprint over a wall, with its
/// centre over any side. Negative inside.
double placement__excess(const scene *s, const shape_footprint *footprint, scene_pose pose,
                         scene_side side);

/// Faults of one kind after which a check ends: a pattern is at fault as a whole, once.
size_t placement__limit_told(const scene *s);

/// The pointer of part k, in room of BF_POINTER_SIZE bytes where it must be made.
const char *placement__point_at(const scene *s, size_t k, char *room);
