/// What a belt may do at any time, by its speed schedule, actions, failures and breaks; core/world/belt_speeds.h has what it does.

#pragma once

#include "core/base/faults.h"
#include "core/scene/types.h"

#include <stdbool.h>
#include <stddef.h>

/// True if a belt has failures or breaks.
bool belt_range_may_stop(const scene_belt *belt);

/// True if some of its failures are left to chance.
bool belt_range_stops_by_chance(const scene_belt *belt);

/// True if a belt has a speed schedule, failures or breaks, or can be commanded.
bool belt_range_may_change(const scene_belt *belt);

/// True if no belt_range_may_change(): every f is 1 at all times.
bool belt_range_is_constant(size_t n_belts, const scene_belt *belts);

/// The largest |f| of a belt that its schedule and actions allow at any time.
double belt_range_largest(const scene_belt *belt);

/// True if a belt may run backwards: a factor of its schedule or of an action on it is below 0.
bool belt_range_may_reverse(const scene_belt *belt);

/// True if any of these belts may.
bool belt_range_may_reverse_any(size_t n_belts, const scene_belt *belts);

/// Note faults of a belt's accelerations, schedule, failures and breaks; pointer is that of the belt.
void belt_range_check(const scene_belt *belt, const char *pointer, bf_faults *faults);
