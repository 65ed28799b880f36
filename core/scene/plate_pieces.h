/// The straight pieces of plates as they stand at t = 0.

#pragma once

#include "core/scene/plate_pose.h"
#include "core/scene/surroundings.h"

#include <stdbool.h>
#include <stddef.h>

/// The corners of piece k of an obstacle's plate, counter-clockwise. False: the obstacle is not there.
bool plate_pieces_get(const surroundings *around, const scene_obstacle *o, size_t k,
                      vec2 ret_corners[4]);

/// Same of an obstacle with a displacement, whether it is there or not.
void plate_pieces_placed(const surroundings *around, const scene_obstacle *o, size_t k,
                         plate_displacement displacement, vec2 ret_corners[4]);
