/// Where the schedule of an obstacle has it, and whether it is there.
///
///     angle(t)      linear between the times of scene_obstacle.turn, constant before the first and after the
///                   last; counter-clockwise, rad; 0 without a turn at all times
///     shift(t)      the same of scene_obstacle.shifts, m
///     present(t)    that of scene_obstacle.presence from each time to the next, true before the first
///     repeat        the round from 0 to scene_series.repeat is made again and again: t counts from its
///                   beginning. From the last time of a round to the first one of the next the plate moves
///                   steadily between their places, and is present as at the last time
///
/// Units    SI, angles in rad.
/// Errors   series are expected to be sound: times that rise, as many values, repeat at least the last time.

#pragma once

#include "core/scene/plate_pose.h"
#include "core/scene/types.h"

#include <stdbool.h>

/// Within which a plate that comes is there in full, s. **Choice**: as long as a pneumatic stop takes. What it comes
/// upon is pushed aside by that time, so that no contact begins with an overlap, whatever its stiffness.
#define PLATE_SCHEDULE_COMING 0.2

/// The displacement of an obstacle at a time t >= 0; zeros without a schedule.
plate_displacement plate_schedule_displacement(const scene_obstacle *o, double t);

/// Whether it is there at a time t >= 0. *ret_came: since when, or a time more than PLATE_SCHEDULE_COMING before t; -INFINITY: always.
bool plate_schedule_is_present(const scene_obstacle *o, double t, double *ret_came);
