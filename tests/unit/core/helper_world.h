/// Worlds (core/world/world.h) of belts and obstacles, for tests of solvers.

#pragma once

#include "core/micro/micro.h"
#include "core/world/world.h"

/// The world of belts and obstacles; drives whose force_limit is 0 push whatever there is. It stays until the program
/// ends; what it is made of may change.
bf_world *helper_world(size_t n_belts, const scene_belt *belts, size_t n_obstacles,
                       const scene_obstacle *obstacles);

/// That of a definition, which is its own one if it has one.
bf_world *helper_world_of(const micro_def *def);

/// Give commands at a time t, s.
void helper_world_turn(bf_world *w, double t, double angle, double over);
void helper_world_shift(bf_world *w, double t, vec2 shift, double over);
void helper_world_presence(bf_world *w, double t, bool is_present);

/// Let a world have the commands and drives of another one of the same scene, by its checkpoint.
void helper_world_copy(const bf_world *from, bf_world *to);
