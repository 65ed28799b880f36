/// Contact constraints in batches, which are solved in the lanes of registers (core/base/simd.h).
///
/// implicit_kernels.c is compiled once per instruction set (core/CMakeLists.txt); all builds give the same bits.

#pragma once

#include "core/base/cpu.h"
#include "core/base/simd_rows.h"
#include "core/base/vec3.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    BODY_BATCH = 8,            ///< constraints in a batch, a multiple of SIMD_LANES
    BODY_CONSTRAINT_POINTS = 8 ///< most points of a constraint
};

/// Velocities of a body within a step, and its inverse masses: a row of four quads (core/base/simd_rows.h).
typedef struct body_solver_body {
    vec3 v;           ///< m/s
    double inv_mass;  ///< 1/m, 1/kg
    vec3 w;           ///< rad/s
    mat3 inv_inertia; ///< inverse inertia in the world's frame, 1/(kg m2)
} body_solver_body;

enum { BODY_SOLVER_ROW = 4 * SIMD_QUAD }; ///< doubles in a row

_Static_assert(sizeof(body_solver_body) == BODY_SOLVER_ROW * sizeof(double), "a row of quads");

/// A number of each constraint.
typedef double body_lanes[BODY_BATCH] __attribute__((aligned(64)));

/// A contact point of each constraint, in its axes; one that a constraint does not have has no bias and no gain.
typedef struct body_batch_point {
    body_lanes x;              ///< from the middle along the first tangent, m
    body_lanes y;              ///< along the second
    body_lanes normal[3];      ///< of length 1
    body_lanes bias;           ///< J = bias - gain u
    body_lanes gain;           ///< N s per m/s
    body_lanes lower_bound;    ///< J is 0 unless greater: 0, or -infinity where it may be negative
    body_lanes normal_impulse; ///< J by the last solution, N s
    body_lanes
        belt_velocity[2]; ///< in the middle, of the belt under the point: along the tangents, m/s
} body_batch_point;

/// Constraints of different parts, all with boundaries, or all with belts, or all of pairs. Lanes from n on repeat lane
/// n - 1, so that they write what it writes.
typedef struct body_batch {
    struct body_constraint *constraint[BODY_BATCH]; ///< n of them
    uint32_t n;                                     ///< at least 1
    uint32_t n_points;                              ///< most of any of them
    bool is_pair;                                   ///< of pairs
    bool is_belt;                                   ///< with belts
    bool is_flat;                                   ///< all normals of the points are axis[2]
    bool has_inertia; ///< inertia is set; of pairs by the first solution in the step that needs it
    uint32_t row[2]
                [BODY_BATCH];  ///< where a (of pairs) and b begin among the solver bodies, doubles
    body_lanes axis[3][3];     ///< tangents and normal; the normal points from a to b, or to b
    body_lanes lever[2][3];    ///< from the centres of a (of pairs) and b to the middle, m
    body_lanes surface[4];     ///< velocity of the boundary, m/s, and its spin, rad/s
    body_lanes friction;       ///< mu
    body_lanes rate;           ///< lambda, s/m
    body_lanes spin_friction;  ///< with a belt: mu r_spin of (8), m
    body_lanes spin_rate;      ///< same: its lambda, s
    body_lanes gyration;       ///< same: g_0, m
    body_lanes belt_turn;      ///< same: its angular velocity, rad/s
    body_lanes impulse[6];     ///< so far, on b, in the axes: N s and N m s
    body_lanes normal_impulse; ///< sum of |J| over the points, N s
    body_lanes inertia[21];    ///< M by body_entry(); only where has_inertia
    body_batch_point point[BODY_CONSTRAINT_POINTS]; ///< n_points of them
} body_batch;

/// Where the entry of a symmetric matrix in row i and column j <= i is in its lower triangle.
static inline int body_entry(int i, int j)
{
    return i * (i + 1) / 2 + j;
}

/// The solver for one instruction set.
typedef struct body_kernels {
    /// Apply the impulses of the last step.
    void (*warm_start)(body_solver_body *bodies, const body_batch *batch);

    /// Solve each constraint while the impulses of all others are fixed.
    void (*solve)(body_solver_body *bodies, body_batch *batch);
} body_kernels;

/// The build for an instruction set.
const body_kernels *body__implicit_kernels(cpu_level level);
