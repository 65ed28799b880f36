/// The displacement of a belt whose speed changes, by recursion over its schedule: an oracle for
/// core/world/belt_speeds.h.

#pragma once

#include "core/scene/types.h"

/// The integral of the belt's factor from 0 to t, s.
double schedule_integral(const scene_belt *belt, double t);

/// Its mean over a step of dt, before which n were made.
double schedule_mean(const scene_belt *belt, unsigned long n, double dt);
