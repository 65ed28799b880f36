/// The ranges of a scenario's numbers. scene_check() enforces them; the document's description states them.

#pragma once

#include "core/base/range.h"

extern const bf_range scene_range_time;          ///< duration and intervals of output, s
extern const bf_range scene_range_instant;       ///< times of a schedule, s
extern const bf_range scene_range_length;        ///< lengths, m
extern const bf_range scene_range_lever;         ///< levers of friction, m
extern const bf_range scene_range_mass;          ///< kg
extern const bf_range scene_range_share;         ///< proportions of a mix
extern const bf_range scene_range_force_limit;   ///< of drives, N
extern const bf_range scene_range_acceleration;  ///< of belts, m/s2
extern const bf_range scene_range_speed_factor;  ///< of a belt's velocity
extern const bf_range scene_range_weibull_shape; ///< of times between failures and of repairs
extern const bf_range scene_range_rate;          ///< of feeds and sinks, parts/s
extern const bf_range scene_range_profile;       ///< rates of a profile, parts/s
extern const bf_range scene_range_place;         ///< places along a line, 0 to 1
extern const bf_range scene_range_ratio;         ///< densities relative to a packed one, precisions
extern const bf_range
    scene_range_count; ///< rows, columns and parts; how many parts is limited separately
extern const bf_range
    scene_range_seed; ///< seeds of generators, below 2^53: whole numbers that doubles hold
extern const bf_range scene_range_per_area;          ///< mollifiers and packing density, 1/m2
extern const bf_range scene_range_heaviside_width;   ///< xi
extern const bf_range scene_range_dispersion;        ///< epsilon, m/s
extern const bf_range scene_range_jam_density;       ///< rho_j
extern const bf_range scene_range_modulus_reduction; ///< divisor of the moduli; 0: "auto"
extern const bf_range scene_range_overlap_limit;     ///< share of a radius
extern const bf_range scene_range_damping_rate;      ///< D, 1/s
extern const bf_range scene_range_gravity;           ///< m/s2
extern const bf_range scene_range_young_modulus;     ///< E, Pa
extern const bf_range scene_range_poisson_ratio;     ///< nu
extern const bf_range scene_range_contact_damping;   ///< d, N s/m
extern const bf_range scene_range_belt_friction;     ///< mu of one belt
extern const bf_range scene_range_friction;          ///< mu
extern const bf_range scene_range_tanh;              ///< lambda_lin, s/m, and lambda_ang, s
