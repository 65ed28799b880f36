/// The belts under bodies: the plane z = 0 that bears them, and its friction.
///
/// Units    SI.

#pragma once

#include "core/micro/body/narrow_phase.h"
#include "core/micro/micro.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A belt in a step: the velocity that its friction leads to is (vx - turn y, vy + turn x).
typedef struct body_belt {
    double vx;   ///< at the origin, with the hold of a slope (core/scene/belt_slope.h), m/s
    double vy;   ///< same
    double turn; ///< angular velocity, rad/s
    double friction_ratio; ///< belt_friction_ratio()
    vec3 gravity;          ///< along the belt, and onto it, m/s2
} body_belt;

/// The neighbourhood in which one belt, or none, lies under all of a part.
typedef struct body_belt_cache {
    vec2 at;          ///< centre of the part when this was computed, m
    double clearance; ///< distance from there within which it holds, m; < 0: not computed
    size_t belt;      ///< index of that belt
} body_belt_cache;

/// Copy the belts. BF_ENOMEM.
BF_MUST_CHECK bf_status body__belt_init(body_state *s, const micro_def *def, bf_error *err);
void body__belt_fini(body_state *s); ///< Free them.

/// Set the velocities of the belts for a step, before which n_before were made; by one thread.
void body__update_belts(body_state *s, uint64_t n_before);

/// The belt under a point of part k, else the one that carries the part; at rest where it falls.
const body_belt *body__belt_at(body_state *s, size_t k, vec3 at);

/// The velocity of a belt at a place, m/s.
static inline vec3 body__belt_velocity(const body_belt *belt, vec3 at)
{
    return (vec3){ belt->vx - belt->turn * at.y, belt->vy + belt->turn * at.x, 0.0 };
}

/// Gravity on part k: that of the belt that carries it, m/s2.
vec3 body__gravity(body_state *s, size_t k);

/// True if no belt carries part k.
bool body__falls(body_state *s, size_t k);

/// The belt that is under all of part k; NULL: there are several.
const body_belt *body__whole_belt(body_state *s, size_t k);

/// Add the forces of the belt on part k.
void body__add_belt_forces(body_state *s, size_t k, body_load *load);
