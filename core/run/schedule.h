/// When results are taken: at the first step at or past each due time.
///
///     Due are 0, the multiples of the output's period and, in each window from <= t < to of it, instead of these
///     from + k times the window's period.
///
/// What is due follows from the number of steps alone, so that there is no state to be saved.

#pragma once

#include "core/scene/types.h"

#include <stddef.h>
#include <stdint.h>

/// The member of scene_output and scene_output_window that holds a period.
typedef enum schedule_of {
    SCHEDULE_CURVE,    ///< curve_every
    SCHEDULE_SNAPSHOT, ///< snapshot_every
} schedule_of;

/// The first step after `step` at which something is due; steps are of dt, s.
uint64_t schedule_next(const scene_output *output, schedule_of of, uint64_t step, double dt);

/// Steps of dt until the first one at or past time t, s; rounding errors do not add a step.
uint64_t schedule_steps_until(double t, double dt);
