/// MICRO_IMPLICIT in space: implicit Euler for contacts and friction, solved by impulses.
///
/// All contact points of two bodies in a step, up to BODY_CONSTRAINT_POINTS around their middle o, make one
/// contact constraint. With q = (V, W) the velocity and spin of b relative to a in o, in the axes of the
/// constraint (two tangents and the normal), n_p the normal in point p and u_p the speed along it,
///
///     normal     J_p = weight_p max(0, E (depth_p - h u_p+) - d max(depth_p, 0)), E = h k + d: for
///                depth > 0 h times (4a) at the end of the step; for a gap, depth < 0, zero until
///                it closes, and then the dashpot acts on the overlap
///     sliding    -mu |J_p| lambda theta(lambda |s_p|) s_p+, s_p the slip: (7), with an implicit secant
///     belt       the same in the centre of pressure, and (8) about the normal, both implicit
///     step       x+ = x + h v+, q+ as in (13)
///
/// For given active points (J_p != 0) and secants the impulse is -D q+ + c with a symmetric D >= 0. With M
/// the effective mass matrix in o, it follows from (M + D) q+ = M q0 + c, six equations, where q0 is q
/// without the constraint. Active points and secants are updated from q+ a few times. Each constraint is
/// thus solved exactly, normal forces, tilting and sliding coupled; constraints are solved one after the
/// other (Gauss-Seidel), starting from the impulses of the previous step. Every impulse acts on both parts,
/// so that momentum is conserved for any number of iterations.
///
/// Margin   Contacts are found up to a distance that parts could close in the step, see manifold.h. It is
///          the same for all parts, so that results do not depend on when the list was built.
/// Order    An iteration solves first all constraints with boundaries, part by part; then those of pairs
///          by colours, in none of which a part occurs twice; last those for which no colour was left.
///          Colours are assigned in each step, by the ids of the parts, and need not be saved. Constraints without a
///          part in common are solved together in batches (batch.h), which does not change a bit.
/// State    Warm starts, of pairs and parts, outlive a step and are saved; the rest is scratch.

#pragma once

#include "core/micro/body/batch.h"
#include "core/micro/body/body_priv.h"

enum {
    BODY_COLOURS = 64, ///< of constraints of pairs
    BODY_SLICE = 2,    ///< batches of a colour that a thread takes at a time
};

/// A contact point, in the axes of its constraint; more in body_batch_point.
typedef struct body_constraint_point {
    double x;      ///< from the middle along the first tangent, m
    double y;      ///< along the second
    double depth;  ///< m; < 0: apart
    double weight; ///< of stiffness and dashpot
} body_constraint_point;

/// The contact constraint of two bodies, see above.
typedef struct body_constraint {
    uint32_t a;                  ///< part; BODY_STATIC: a boundary or the belt
    uint32_t b;                  ///< part
    body_warm_start *warm_start; ///< where its impulse is stored; NULL: nowhere
    uint32_t key;                ///< of the warm start
    uint32_t colour;             ///< of a pair; of a boundary: how many come before it at its part
    body_batch *batch;           ///< that solves it
    uint32_t lane;               ///< in that
    const body_kind *belt_kind;  ///< the part's kind if a is the belt, else NULL
    vec3 axis[3];                ///< tangents and normal; the normal points from a to b, or to b
    const body_moving *moving;   ///< the plate if a is one that moves, else NULL
    vec3 lever[2];               ///< from the centres of a, or its pivot, and b to the middle, m
    double impulse[6];           ///< of the last step, on b, in the axes: N s and N m s
    micro_law law;               ///< of the contact
    double depth;                ///< largest of the points, m
    uint32_t n;                  ///< points
    bool is_flat;                ///< all normals of the points are axis[2]
    body_constraint_point point[BODY_CONSTRAINT_POINTS]; ///< see there; n of them
    vec3 normal[BODY_CLOSED_FORM_POINTS]; ///< of the points, in the axes; unless is_flat
    vec2 belt_velocity
        [BODY_CONSTRAINT_POINTS]; ///< in the middle, of the belts under the points, if a is
                                  ///< the belt, m/s
    double belt_turn;             ///< mean angular velocity of these, rad/s
} body_constraint;

#define BODY_STATIC UINT32_MAX ///< in place of the id of a part: a body that does not move

/// The constraints and extremes of a block of parts.
typedef struct body_block_buffer {
    size_t first;    ///< index of its first constraint
    size_t n_pairs;  ///< constraints with other parts
    size_t n;        ///< of all constraints; those with boundaries and belts are last, part by part
    size_t capacity; ///< constraints that it has room for
    size_t n_boundaries;    ///< of these most with boundaries and belts
    size_t most_boundaries; ///< most of them of one part
    size_t first_batch;     ///< of those with boundaries and belts
    size_t n_batches;       ///< same
    double speed;  ///< largest of any point of a part, before the step or without contacts, m/s
    double moved2; ///< largest squared displacement since the list was built, m2
} body_block_buffer;

/// What body_state.implicit points to.
typedef struct implicit_solver {
    int iterations;        ///< Gauss-Seidel iterations in a step
    double damping_factor; ///< by which damping reduces a velocity in a step
    body_warm_start (
        *warm_starts)[BODY_WARM_STARTS]; ///< by part: of its contacts with boundaries and belts
    body_solver_body *solver_bodies;     ///< scratch, by part
    uint64_t *used_colours;              ///< scratch, by part: colours taken
    body_block_buffer *buffers;          ///< by block of parts
    size_t constraints_capacity;         ///< room
    body_constraint *constraints;        ///< scratch, by blocks
    size_t batches_capacity;             ///< room
    body_batch *batches;                 ///< scratch: of pairs by colours, then by blocks
    size_t colour[BODY_COLOURS + 2];     ///< first batch of each; the last one is the rest
    const body_kernels *kernels;         ///< those of this processor
} body_solver;

/// Make the constraints of a block of parts for all contacts within `margin`, m.
void body_implicit__find_contacts(body_state *s, size_t block, double margin);

/// A vector in the axes of a constraint.
static inline vec3 body_implicit__to_axes(const body_constraint *p, vec3 a)
{
    return (vec3){ vec3_dot(p->axis[0], a), vec3_dot(p->axis[1], a), vec3_dot(p->axis[2], a) };
}

/// Most batches that the constraints until the list is stale can need.
size_t body_implicit__count_batches(const body_state *s);

/// Divide the constraints of all blocks into batches. By one thread.
void body_implicit__make_batches(const body_state *s);

/// Set the lanes of a batch from its constraints.
void body_implicit__fill_batch(const body_state *s, body_batch *batch);

/// Store the impulse of a constraint for the next step.
void body_implicit__store_warm_start(const body_constraint *constraint);
