/// The bodies of a batch in lanes, for implicit_kernels.c: SIMD_LANES constraints at a time. Operations on vectors are those
/// of core/base/vec3.h, in the same order.

#pragma once

#include "core/base/simd_compare.h"
#include "core/micro/body/batch.h"

/// Vectors.
typedef struct lanes3 {
    simd x; ///< of all lanes
    simd y; ///< same
    simd z; ///< same
} lanes3;

/// The vectors of constraints lane .. lane + SIMD_LANES - 1.
static inline lanes3 load3(const body_lanes *a, size_t lane)
{
    return (lanes3){ simd_load(a[0] + lane), simd_load(a[1] + lane), simd_load(a[2] + lane) };
}

/// Sum, difference, a + factor b, inner product and cross product of vectors.
static inline lanes3 add3(lanes3 a, lanes3 b)
{
    return (lanes3){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline lanes3 sub3(lanes3 a, lanes3 b)
{
    return (lanes3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline lanes3 along3(lanes3 a, simd factor, lanes3 b)
{
    return (lanes3){ a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z };
}

static inline simd dot3(lanes3 a, lanes3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline lanes3 cross3(lanes3 a, lanes3 b)
{
    return (lanes3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/// |x|.
static inline simd size_of(simd x)
{
    return simd_max(x, -x);
}

/// The axes of constraints.
typedef struct lanes_axes {
    lanes3 axis[3]; ///< tangents and normal
} lanes_axes;

/// Load them.
static inline lanes_axes load_axes(const body_batch *p, size_t lane)
{
    return (lanes_axes){ { load3(p->axis[0], lane), load3(p->axis[1], lane),
                           load3(p->axis[2], lane) } };
}

/// A vector in the axes, and one by its components in them.
static inline lanes3 to_axes(const lanes_axes *axes, lanes3 a)
{
    return (lanes3){ dot3(axes->axis[0], a), dot3(axes->axis[1], a), dot3(axes->axis[2], a) };
}

static inline lanes3 to_world(const lanes_axes *axes, const simd a[3])
{
    const lanes3 *axis = axes->axis;
    const lanes3 first = { axis[0].x * a[0], axis[0].y * a[0], axis[0].z * a[0] };

    return along3(along3(first, a[1], axis[1]), a[2], axis[2]);
}

/// The bodies at one end.
typedef struct lanes_body {
    lanes3 v;              ///< see body_solver_body
    lanes3 w;              ///< same
    lanes3 inv_inertia[3]; ///< same, by rows
    simd inv_mass;         ///< same
} lanes_body;

/// Load them from their rows.
static inline lanes_body load_bodies(const body_solver_body *bodies, const uint32_t *row)
{
    const double *table = &bodies->v.x;
    const simd_quad q0 = simd_quad_load(table, row), q1 = simd_quad_load(table + SIMD_QUAD, row),
                    q2 = simd_quad_load(table + 2 * SIMD_QUAD, row),
                    q3 = simd_quad_load(table + 3 * SIMD_QUAD, row);

    return (lanes_body){
        .v = { q0.column[0], q0.column[1], q0.column[2] },
        .inv_mass = q0.column[3],
        .w = { q1.column[0], q1.column[1], q1.column[2] },
        .inv_inertia = { { q1.column[3], q2.column[0], q2.column[1] },
                         { q2.column[2], q2.column[3], q3.column[0] },
                         { q3.column[1], q3.column[2], q3.column[3] } },
    };
}

/// The inverse inertia times a.
static inline lanes3 apply_inv_inertia(const lanes_body *body, lanes3 a)
{
    const lanes3 *row = body->inv_inertia;

    return (lanes3){ dot3(row[0], a), dot3(row[1], a), dot3(row[2], a) };
}

/// x in lanes that are on, else y.
static inline simd choose(simd on, simd x, simd y)
{
    return simd_select_less(simd_all(0.0), on, x, y);
}

/// Apply sign times an impulse to the bodies in lanes that are on.
static inline void apply_to_bodies(body_solver_body *bodies, const uint32_t *row, lanes_body *body,
                                   simd on, double sign, lanes3 lever, lanes3 force, lanes3 torque)
{
    double *table = &bodies->v.x;
    const lanes3 turn = apply_inv_inertia(body, add3(cross3(lever, force), torque));
    const lanes3 v = along3(body->v, sign * body->inv_mass, force);
    const lanes3 w = along3(body->w, simd_all(sign), turn);
    const simd_quad moved = { { choose(on, v.x, body->v.x), choose(on, v.y, body->v.y),
                                choose(on, v.z, body->v.z), body->inv_mass } };
    const simd_quad turned = { { choose(on, w.x, body->w.x), choose(on, w.y, body->w.y),
                                 choose(on, w.z, body->w.z), body->inv_inertia[0].x } };

    simd_quad_scatter(table, row, &moved);
    simd_quad_scatter(table + SIMD_QUAD, row, &turned);
}

/// Where the impulses of constraints act.
typedef struct lanes_ends {
    lanes_axes axes; ///< see there
    lanes3 lever[2]; ///< see body_batch
    lanes_body a;    ///< of pairs
    lanes_body b;    ///< see there
} lanes_ends;

/// Load them.
static inline lanes_ends load_ends(const body_solver_body *bodies, const body_batch *p, size_t lane)
{
    lanes_ends e = { .axes = load_axes(p, lane),
                     .lever[1] = load3(p->lever[1], lane),
                     .b = load_bodies(bodies, p->row[1] + lane) };

    if (p->is_pair) {
        e.lever[0] = load3(p->lever[0], lane);
        e.a = load_bodies(bodies, p->row[0] + lane);
    }
    return e;
}

/// Apply an impulse, in the axes, to the bodies of both ends in lanes that are on.
static inline void apply_impulse(body_solver_body *bodies, const body_batch *p, size_t lane,
                                 lanes_ends *e, simd on, const simd impulse[6])
{
    const lanes3 force = to_world(&e->axes, impulse), torque = to_world(&e->axes, impulse + 3);

    apply_to_bodies(bodies, p->row[1] + lane, &e->b, on, 1.0, e->lever[1], force, torque);
    if (p->is_pair)
        apply_to_bodies(bodies, p->row[0] + lane, &e->a, on, -1.0, e->lever[0], force, torque);
}
