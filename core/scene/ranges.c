#include "core/scene/ranges.h"

#include "core/scene/limits.h"

#include <math.h>

const bf_range scene_range_time = { 0.0, INFINITY, true, false, 1e9 };
const bf_range scene_range_instant = { 0.0, INFINITY, false, false, 1e9 };
const bf_range scene_range_length = { 0.0, INFINITY, true, false, SCENE_LENGTH_MAX };
const bf_range scene_range_lever = { 0.0, INFINITY, false, false, SCENE_LENGTH_MAX };
const bf_range scene_range_mass = { 0.0, INFINITY, true, false, 1e9 };
const bf_range scene_range_share = { 0.0, INFINITY, true, false, 1e9 };
const bf_range scene_range_force_limit = { 0.0, INFINITY, true, false, 1e9 };
const bf_range scene_range_acceleration = { 0.0, INFINITY, true, false, 1e9 };
const bf_range scene_range_speed_factor = { -INFINITY, INFINITY, false, false, 1e9 };
const bf_range scene_range_weibull_shape = { 0.2, 100.0, false, false, 0.0 };
const bf_range scene_range_rate = { 0.0, INFINITY, true, false, 1e9 };
const bf_range scene_range_profile = { 0.0, INFINITY, false, false, 1e9 };
const bf_range scene_range_place = { 0.0, 1.0, false, false, 0.0 };
const bf_range scene_range_ratio = { 0.0, 1.0, true, false, 0.0 };
const bf_range scene_range_count = { 1.0, INFINITY, false, false, 0.0 };
const bf_range scene_range_seed = { 0.0, 9007199254740991.0, false, false, 0.0 };
const bf_range scene_range_per_area = { 0.0, INFINITY, true, false, 1e18 };
const bf_range scene_range_heaviside_width = { 0.0, INFINITY, true, false, 1e6 };
const bf_range scene_range_dispersion = { 0.0, INFINITY, false, false, 2.0 * SCENE_SPEED_MAX };
const bf_range scene_range_jam_density = { 0.0, 1.0, true, false, 0.0 };
const bf_range scene_range_modulus_reduction = { 1.0, INFINITY, false, false, 1e15 };
const bf_range scene_range_overlap_limit = { 0.0, 1.0, true, false, 0.0 };
const bf_range scene_range_damping_rate = { 0.0, INFINITY, false, false, 1e9 };
const bf_range scene_range_gravity = { 0.0, INFINITY, false, false, 1e6 };
const bf_range scene_range_young_modulus = { 0.0, INFINITY, true, false, 1e15 };
const bf_range scene_range_poisson_ratio = { 0.0, 0.5, false, true, 0.0 };
const bf_range scene_range_contact_damping = { 0.0, INFINITY, false, false, 1e12 };
const bf_range scene_range_belt_friction = { 0.0, INFINITY, true, false, 1e6 };
const bf_range scene_range_friction = { 0.0, INFINITY, false, false, 1e6 };
const bf_range scene_range_tanh = { 0.0, INFINITY, true, false, 1e12 };
