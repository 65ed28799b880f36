/// Inside of the spatial path: rigid bodies in space.
///
///     step      v+ = (1 - D dt) v + dt F/m, x+ = x + dt v+: (12) with v = (x - x-)/dt, the
///               velocity of the last half step, which contacts see; the first step, forward Euler,
///               is the one without forces
///     spin      w+ = (1 - D)^dt w + dt Theta^-1 torque - dt Theta^-1 (w+ x Theta w+) in the axes
///               of the body, the last term by one step of Newton's method: so it never adds
///               energy, as it would if it were taken at w; q+ = q + dt/2 [w+, 0] q, renormalised
///               (13)
///     points    in each contact point f = share max(k depth - d v_n, 0), v_n of the point itself
///               (no clamp with tension), and friction (7) of its own velocity; shares: manifold.h
///     belt      the same points carry the weight, but friction acts once, in their centre of
///               pressure c: (7) with the velocity of the body in c, and (8) about the vertical
///               with r_spin g/g_0, where g is the radius of gyration of the pressure and g_0 that
///               of the body lying flat. So an upright cylinder is braked as on the planar path,
///               and a body on its corner turns freely. (8) is implicit: it never turns the spin
///               around
///     cylinders standing side by side or near a plate, or lying, in closed form: body_round.c
///
/// The body frame is that of the principal axes with its origin in the centre of mass.
///
/// Memory   the direction that separates two bodies, or the feature that carries their contact, is
///          kept from step to step while the balls around them touch, and forgotten when they do
///          not, so that it does not depend on when the list of neighbours was made. A feature is
///          kept as long as no other one close by has less depth: contacts do not jump through thin
///          bodies.
/// Sums     over neighbours by their numbers, then plates by theirs, then walls, then the belt;
///          each pair is worked out once. Blocks of BODY_BLOCK parts are shared out to threads.

#pragma once

#include "core/base/checkpoint.h"
#include "core/micro/body/body_types_priv.h"

/// What acts on a body: sums about its centre of mass.
typedef struct body_load {
    vec3 force;  ///< N
    vec3 torque; ///< N m
} body_load;

/// Velocity of the point `at` of a body.
static inline vec3 body__velocity(const body_body *body, vec3 at)
{
    return vec3_add(body->v, vec3_cross(body->w, vec3_sub(at, body->x)));
}

/// Add a force that acts in a point.
static inline void body__push(body_load *load, const body_body *body, vec3 at, vec3 force)
{
    load->force = vec3_add(load->force, force);
    load->torque = vec3_add(load->torque, vec3_cross(vec3_sub(at, body->x), force));
}

/// Square of how far part k has moved in the plane since the list was made, m2.
static inline double body__moved2(const body_state *s, size_t k)
{
    double dx = s->bodies[k].x.x - s->list.x_built[k], dy = s->bodies[k].x.y - s->list.y_built[k];

    return dx * dx + dy * dy;
}

/// The law of two parts.
static inline micro_law body__law(const body_state *s, const body_kind *a, const body_kind *b)
{
    micro_law law = s->cargo;

    law.stiffness /= a->softness + b->softness;
    return law;
}

/// Normal force in a contact point, N; approach is the velocity of b against a along the normal.
static inline double body__press(const body_state *s, const micro_law *law, double depth,
                                 double share, double approach)
{
    double force = share * (law->stiffness * depth - law->damping * approach);

    return s->def.tension || force > 0.0 ? force : 0.0;
}

/// Friction (7) on b for a normal force, by the velocity of b against a at right angles to the
/// normal.
vec3 body__rub(const micro_law *law, double force, vec3 slip);

/// Fill in a kind. BF_EINPUT: its hull is degenerate.
BF_MUST_CHECK bf_status body__kind_init(const micro_def *def, const micro_kind *from,
                                        body_kind *ret_kind, bf_error *err);

/// Copy plates and belts and map them. BF_ENOMEM.
BF_MUST_CHECK bf_status body__plates_init(body_state *s, const micro_def *def, bf_error *err);
BF_MUST_CHECK bf_status body__floor_init(body_state *s, const micro_def *def, bf_error *err);

/// Free them.
void body__plates_fini(body_state *s);
void body__floor_fini(body_state *s);

/// Velocity of the belt under a point; 0 off every belt. True if there is one.
bool body__belt_at(const body_state *s, double x, double y, vec3 *ret_velocity);

/// True if one belt is under all of part k, and its velocity.
bool body__is_on_one_belt(body_state *s, size_t k, vec3 *ret_velocity);

/// Make the list of neighbours and the pairs, which keep their memories. BF_ENOMEM: the list is
/// made anew by the next call.
BF_MUST_CHECK bf_status body__list(body_state *s, bf_error *err);

/// The region of a pair if it touches, or comes nearer than `near`, m. Returns false if not.
bool body__find_pair(const body_state *s, double near, body_pair *pair, body_region *ret_region);

/// Work out what acts in a pair.
void body__meet(const body_state *s, body_pair *pair, body_report *report);

/// The contact of two hulls from what is remembered of them, in the frame of a. Returns false if
/// they are apart by more than `near`, m.
bool body__find_manifold(const gjk_pair *pair, double near, body_memory *memory,
                         manifold *ret_manifold);

/// Contact points of two cylinders that stand side by side, where they are not apart by more than
/// `near`; *ret_n is how many, 0 to 2. Returns false, with no output, if they stand otherwise.
bool body__round_pair(const body_state *s, const body_body *a, const body_body *b, double near,
                      body_spot *ret_spots, size_t *ret_n);

/// The same of a cylinder on its side against a plane, and of one that stands against a plate.
bool body__round_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                       double near, body_spot *ret_spots, size_t *ret_n);
bool body__round_plate(const body_state *s, const body_body *body, const body_plate *plate,
                       double near, body_spot *ret_spots, size_t *ret_n);

/// The region of a body at a plane, in closed form or by its hull.
void body__find_at_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                         double near, body_region *ret_region);

/// What is done with the region of part k at a solid: 0 to 3 for the walls, then the plates.
typedef void body_visit(void *context, size_t k, const micro_law *law, uint32_t solid,
                        const body_region *region);

/// Visit the plates and walls that part k touches, or comes nearer to than `near`, m.
void body__solids_visit(body_state *s, size_t k, double near, body_visit *visit, void *context);

/// How many of them are within `range`, m, of the ball around part k.
size_t body__solids_count(const body_state *s, size_t k, double range);

/// Add what plates and walls do to part k.
void body__solids_push(body_state *s, size_t k, body_load *load, body_report *report);

/// The spin of a body after a step in which a torque acts, N m; rad/s.
vec3 body__turn(const body_state *s, const body_body *body, vec3 torque);

/// Move part k by its velocities, and note if it is gone or flies off.
void body__drift(body_state *s, size_t k, body_report *report);

/// First part of a block, and the one after its last.
size_t body__first_of(size_t block);
size_t body__last_of(const body_state *s, size_t block);

/// BF_ENUMERIC: a part flew off or is not finite; the text names the first one.
BF_MUST_CHECK bf_status body__check(const void *state, bf_error *err);

/// What the reports of a step come to: DRIVER_SUSPECT, DRIVER_STALE or DRIVER_MADE.
driver_outcome body__judge(const body_state *s);

/// Members of driver_solver for both integrators.
int body__begin(const void *state, driver_progress *ret_progress);
void body__end(void *state, uint64_t n, driver_outcome outcome, const driver_progress *progress);

/// What MICRO_IMPLICIT needs beside the rest. BF_ENOMEM.
BF_MUST_CHECK bf_status body__implicit_init(body_state *s, bf_error *err);

/// Free it.
void body__implicit_fini(body_state *s);

/// Write the impulses of the last step. Returns how many there are.
uint64_t body__implicit_save(const body_state *s, checkpoint_writer *w);

/// Take n of them back, into the listed pairs and into the places of the parts with solids, which are empty.
/// Returns false if they are not of these.
bool body__implicit_load(const body_state *s, checkpoint_reader *r, uint64_t n, body_pair *listed,
                         size_t n_pairs, body_hold (*holds)[BODY_HOLDS]);

/// MICRO_IMPLICIT for the driver.
extern const driver_solver body__implicit;

/// Note a contact that presses.
void body__note(body_report *report, double overlap, double radius);

/// Add what the belt does to part k.
void body__floor_push(body_state *s, size_t k, body_load *load);

/// Largest stable step for a checked definition, s; see body_kind.c.
double body__dt_stable(const micro_def *def);

/// The table's functions that are not in spatial.c.
bf_status body__advance(void *state, uint64_t n, bf_error *err);
micro_part body__part(const void *state, size_t k);
micro_totals body__measure(const void *state);
void body__save(const void *state, checkpoint_writer *w);
bf_status body__load(void *state, checkpoint_reader *r, bf_error *err);
