/// The later parts of scene_check(), which need its first part to have found no fault.

#pragma once

#include "core/base/faults.h"
#include "core/scene/scene.h"

/// Note sizes beyond their limits and steps beyond stability. Needs sound domain, belts and numbers.
void scene_check__sizes(const scene *s, bf_faults *faults);

/// Note every fault of belts, obstacles and counters: ids, paths, polygons, rectangles.
void scene_check__items(const scene *s, bf_faults *faults);
