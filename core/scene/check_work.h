/// How much work the checks of a scenario are, predicted from its counts before they begin.
///
/// The checks compare every side of a belt's outline with every other one, and look for the belt under many points:
/// of feeds, photo eyes and plates. A document of a megabyte could make that hours.
///
/// Units    steps of a few nanoseconds each.

#pragma once

#include "core/base/faults.h"
#include "core/scene/scene.h"

#include <stdbool.h>

/// Note checks that would take more than SCENE_CHECK_STEPS_MAX steps together, at the list that takes the most. Returns
/// true if they would not. For a resolved scene, checked or not; that the parts at the start are placed and checked
/// within their own limits is placement.h's.
bool check_work(const scene *s, bf_faults *faults);
