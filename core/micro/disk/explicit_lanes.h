/// What the inner loops of explicit steps have in common: contacts of SIMD_LANES parts, or pairs of them.
///
/// Functions with a flag `uniform` are inlined with a constant, once for scenes of one kind on one belt and once
/// for all others.

#pragma once

#include "core/base/simd_compare.h"
#include "core/base/simd_rows.h"
#include "core/micro/disk/disk_priv.h"
#include "core/micro/friction.h"

#include <math.h>

/// The forces of the boundary, see explicit_kernels.
void CPU_NAME(explicit_boundary_forces)(const explicit_step *step, size_t first, size_t last,
                                        driver_extremes *extremes);

#define INLINED static inline __attribute__((always_inline))

/// SIMD_LANES parts.
typedef struct parts {
    simd x, y, vx, vy;                       ///< m, m/s
    simd spin, radius, compliance, inv_mass; ///< all but spin only if not uniform
} parts;

INLINED parts load_parts(const disk *rows, const uint32_t *at, bool uniform)
{
    simd_quad low = simd_quad_load(&rows->x, at);
    simd_quad high = simd_quad_load(&rows->spin, at);
    parts p = { low.column[0],  low.column[1], low.column[2], low.column[3],
                high.column[0], simd_all(0.0), simd_all(0.0), simd_all(0.0) };

    if (!uniform) {
        p.radius = high.column[1];
        p.compliance = high.column[2];
        p.inv_mass = high.column[3];
    }
    return p;
}

/// The largest overlaps so far.
typedef struct overlaps {
    simd overlap; ///< m
    simd ratio;   ///< of the smaller part's radius; only if not uniform
} overlaps;

/// A law, ready for lanes.
typedef struct pair_law {
    simd damping, friction;           ///< d, mu
    simd rate;                        ///< lambda / 8
    simd lower_bound;                 ///< of the normal force
    simd line;                        ///< k times the sum of compliances
    simd contact_distance, stiffness; ///< sum of radii and k, if uniform
} pair_law;

INLINED pair_law make_law(const disk_state *s, const disk_law *law, double other_compliance)
{
    const disk *kind = &s->kinds[0].part;

    return (pair_law){ .damping = simd_all(law->damping),
                       .friction = simd_all(law->friction),
                       .rate = simd_all(law->tanh_linear / 8.0),
                       .lower_bound = simd_all(s->def.tension ? -INFINITY : 0.0),
                       .line = simd_all(law->line),
                       .contact_distance = simd_all(kind->radius + kind->radius),
                       .stiffness = simd_all(law->line / (kind->compliance + other_compliance)) };
}

/// A contact of a part with something in direction n, before its friction is known.
typedef struct contact {
    simd nx, ny;  ///< unit, from the part to what it touches
    simd force;   ///< (4a), N; 0 where there is no contact
    simd sliding; ///< lambda/8 times the speed along the tangent, n turned left
    simd lever;   ///< from the part's centre to the contact point, m
} contact;

/// The force on the part, and the part of it along the tangent, whose torque is -friction lever.
typedef struct contact_force {
    simd x, y;     ///< N
    simd friction; ///< (7)
} contact_force;

/// tanh is that of 8 times the sliding.
INLINED contact_force add_friction(const contact *c, simd friction, const friction_quotient *tanh,
                                   bool uniform)
{
    simd size = uniform ? c->force : simd_max(c->force, -c->force);
    simd along = friction * size * (tanh->up / tanh->down);

    return (contact_force){ .x = along * c->ny - c->force * c->nx,
                            .y = -(along * c->nx + c->force * c->ny),
                            .friction = along };
}

/// The normal force of an overlap, where low < high.
INLINED simd normal_force(const pair_law *law, simd stiffness, simd overlap, simd parting, simd low,
                          simd high)
{
    simd force = simd_max(stiffness * overlap - law->damping * parting, law->lower_bound);

    return simd_where_less(low, high, force);
}

static inline void raise(double *largest, double to)
{
    *largest = to > *largest ? to : *largest;
}

INLINED void raise_overlaps(const disk_state *s, const overlaps *of, bool uniform,
                            driver_extremes *extremes)
{
    raise(&extremes->overlap, simd_peak(of->overlap));
    raise(&extremes->overlap_share,
          uniform ? simd_peak(of->overlap) / s->kinds[0].part.radius : simd_peak(of->ratio));
}
