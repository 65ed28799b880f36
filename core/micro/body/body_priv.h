/// Inside of the spatial path: rigid bodies in space.
///
///     step      v+ = (1 - D dt) v + dt F/m, x+ = x + dt v+: (12) with v = (x - x-)/dt, the
///               velocity of the last half step, which contacts see; the first step, forward Euler,
///               applies no forces
///     spin      w+ = (1 - D)^dt w + dt Theta^-1 torque - dt Theta^-1 (w+ x Theta w+) in the axes
///               of the body, the last term by one step of Newton's method, so that it never adds
///               energy, as it would if evaluated at w; q+ = q + dt/2 [w+, 0] q, renormalised
///               (13)
///     points    in each contact point f = weight max(k depth - d v_n, 0), v_n the normal velocity in
///               that point (not clamped at 0 with tension), and friction (7) by the tangential
///               velocity there; weights: manifold.h
///     belt      the same points carry the body, but friction acts once, in their centre of
///               pressure c: (7) with the velocity of the body in c, and (8) about the vertical
///               with r_spin g/g_0, where g is the radius of gyration of the pressure and g_0 that
///               of the body lying flat. An upright cylinder thus loses its spin as on the planar
///               path, and a body on its corner turns freely. (8) is implicit: it never reverses
///               the spin
///     cylinders side by side, near a plate or lying: contact points in closed form, narrow_phase.h
///
/// The body frame is that of the principal axes with its origin in the centre of mass.
///
/// Order    forces on a part are summed over neighbours by id, then plates by id, then walls, then
///          the belt; each pair is evaluated once. Threads work on blocks of BODY_BLOCK parts.

#pragma once

#include "core/base/checkpoint.h"
#include "core/micro/backend.h"
#include "core/micro/body/belt.h"
#include "core/micro/body/narrow_phase.h"
#include "core/micro/body/plates.h"
#include "core/micro/contact_law.h"
#include "core/micro/driver.h"
#include "core/micro/micro.h"
#include "core/micro/neighbours.h"
#include "core/scene/surroundings.h"

enum {
    BODY_BLOCK = 16,         ///< parts that one thread handles together
    BODY_PLATE_MEMORIES = 4, ///< plates whose contact feature is stored for a part
    BODY_WARM_STARTS = 8,    ///< plates, walls and belts whose impulses are stored for a part
};

/// Moments of a face that is in contact with its whole area, weighted by its corners (manifold.h).
typedef struct body_face {
    vec3 centre;   ///< sum of weight p, in the body frame, m
    mat3 spread;   ///< sum of weight r r^T with r = p - centre, m2
    vec3 skew;     ///< sum of weight r |r|^2, m3
    double radius; ///< largest |r|, m
} body_face;

/// A kind of part, ready for the steps.
typedef struct body_kind {
    hull shape;        ///< in the body frame
    quat turn;         ///< body frame in the frame of the shape
    vec3 centre;       ///< of mass, in the frame of the shape, m
    double bottom;     ///< lowest z of the shape in its frame, m
    bool is_cylinder;  ///< a cylinder, about the body's z axis
    double radius;     ///< of a cylinder; else of the disk with the footprint's area, m
    double half_width; ///< of a cylinder its radius; else half the least width of the footprint, m
    double inner_radius;             ///< shape_inner_radius(): what gaps it bridges, m
    double footprint_radius;         ///< of the disk around the footprint, m
    double half_height;              ///< of a cylinder, m
    double mass;                     ///< kg
    vec3 inertia;                    ///< about the principal axes, kg m2
    double compliance;               ///< (1 - nu^2)/E with E divided by modulus_reduction, 1/Pa
    double spin_radius;              ///< r_spin of (8), m
    double flat_gyration;            ///< g_0, m
    micro_law belt_law;              ///< on a belt
    micro_law boundary_law;          ///< against plates and walls
    body_face faces[HULL_FACES_MAX]; ///< of shape
} body_kind;

/// What is stored of a part at a plate from step to step.
typedef struct body_plate_memory {
    uint32_t plate;     ///< its id + 1; 0: the slot is free
    body_memory memory; ///< plate is a, part is b
} body_plate_memory;

/// Which plates are near a point: cell c has the ids plate[first[c]] .. plate[first[c + 1] - 1].
typedef struct body_map {
    double x_min;    ///< m
    double y_min;    ///< m
    double edge;     ///< of a cell, m
    size_t n_x;      ///< cells along x
    size_t n_y;      ///< along y
    size_t *first;   ///< n_x n_y + 1
    uint32_t *plate; ///< ascending in each cell
    size_t capacity; ///< room in plate
} body_map;

/// The solver.
struct body_state {
    micro_common common; ///< see there
    micro_def def;       ///< without its arrays
    vec3 gravity;        ///< on level belts, m/s2
    bool has_slopes;     ///< a belt is not level
    double spin_damping; ///< (1 - D)^dt
    micro_law cargo;     ///< of two parts; stiffness for compliance 1, see body__law()
    size_t n_kinds;      ///< see there
    body_kind *kinds;    ///< see there
    size_t n;            ///< parts, gone ones included; their ids are the handles of micro.h
    size_t capacity;     ///< parts that there is room for
    body_body *bodies;   ///< by id
    body_plate_memory (*plate_memories)[BODY_PLATE_MEMORIES]; ///< by id; NULL without plates
    body_belt_cache *belt_cache;                              ///< by id
    double *bounding_radius;    ///< radius of the ball around each body, m
    double bounding_radius_max; ///< m
    double bounding_radius_min; ///< m
    neighbours_list list;       ///< neighbours
    bool is_listed;             ///< list, pairs and links hold for the next step
    size_t n_pairs;             ///< pairs in the list
    size_t pairs_capacity;      ///< room
    body_pair *pairs;           ///< sorted by a, then b
    size_t spare_capacity;      ///< room
    body_pair *spare;           ///< storage of the previous pairs
    size_t *first_pair;         ///< n + 1: where the pairs with a = k begin
    size_t *cursor;             ///< n: scratch of the list
    size_t links_capacity;      ///< room
    uint32_t *links;            ///< pair of each entry of list.neighbour
    size_t n_plates;            ///< see there
    body_plate *plates;         ///< see there
    body_moving *moving;        ///< by plate; NULL: none moves
    body_map map;               ///< of plates
    double map_range;           ///< from a part's centre to plates that the map must contain, m
    body_belt *belts;           ///< each belt, and what is off every belt, in this step
    size_t n_blocks;            ///< of parts
    body_report *reports;       ///< one a block
    size_t n_contacts;          ///< see micro_totals
    struct implicit_solver *implicit; ///< of MICRO_IMPLICIT, else NULL
};

/// Square of the displacement of part k in the plane since the list was built, m2.
static inline double body__moved2(const body_state *s, size_t k)
{
    double dx = s->bodies[k].x.x - s->list.x_built[k], dy = s->bodies[k].x.y - s->list.y_built[k];

    return dx * dx + dy * dy;
}

/// The contact law of two parts.
micro_law body__law(const body_state *s, const body_kind *a, const body_kind *b);

/// Normal force in a contact point, N; approach is the velocity of b relative to a along the normal, m/s.
static inline double body__normal_force(const body_state *s, const micro_law *law, double depth,
                                        double weight, double approach)
{
    double force = weight * (law->stiffness * depth - law->damping * approach);

    return s->def.tension || force > 0.0 ? force : 0.0;
}

/// Friction (7) on b for a normal force, N; slip is the tangential velocity of b relative to a, m/s.
vec3 body__friction_force(const micro_law *law, double force, vec3 slip);

/// Force in a contact point: normal force (4a) and friction (7), N. velocity is that of the contact point against
/// what it touches, m/s; the normal points to where the force acts. False, without output: there is no force.
bool body__contact_force(const body_state *s, const micro_law *law, vec3 normal,
                         const manifold_point *point, vec3 velocity, vec3 *ret_force);

/// Prepare a kind. BF_EINPUT: its hull is degenerate.
BF_MUST_CHECK bf_status body__kind_init(const micro_def *def, const micro_kind *from,
                                        body_kind *ret_kind, bf_error *err);

/// Build the list of neighbours and the pairs; pairs that remain keep their memory and warm start.
/// BF_ENOMEM: the next call builds the list again.
BF_MUST_CHECK bf_status body__list(body_state *s, bf_error *err);

/// Called with the contact of part k at a boundary: 0 to 3 are the walls, then come the plates.
typedef void body_visit(void *context, size_t k, const micro_law *law, uint32_t boundary,
                        const body_contact *contact);

/// Call visit for the plates and walls that part k overlaps or is nearer to than `margin`, m.
void body__visit_boundaries(body_state *s, size_t k, double margin, body_visit *visit,
                            void *context);

/// Count the plates and walls within `range`, m, of the ball around part k.
size_t body__count_boundaries(const body_state *s, size_t k, double range);

/// Add the forces of plates and walls on part k.
void body__add_boundary_forces(body_state *s, size_t k, body_load *load, body_report *report);

/// The angular velocity of a body after a step with a torque, N m; rad/s.
vec3 body__integrate_spin(const body_state *s, const body_body *body, vec3 torque);

/// Move part k by its velocities, and record if it has left the domain, has fallen or has become unstable.
void body__move(body_state *s, size_t k, body_report *report);

/// First part of a block, and the one after its last.
size_t body__first_of(size_t block);
size_t body__last_of(const body_state *s, size_t block);

/// BF_ENUMERIC: a part moved too far in a step or is not finite, and the text names the first one; or an overlap is
/// beyond overlap_limit.
BF_MUST_CHECK bf_status body__check(const void *state, bf_error *err);

/// The outcome of a step by the reports of its blocks: DRIVER_SUSPECT, DRIVER_STALE or DRIVER_MADE.
driver_outcome body__find_outcome(const body_state *s);

/// Members of driver_solver for both integrators.
int body__begin(const void *state, driver_progress *ret_progress);
void body__end(void *state, uint64_t n, driver_outcome outcome, const driver_progress *progress);

/// Allocate what only MICRO_IMPLICIT needs, for s->capacity parts. BF_ENOMEM.
BF_MUST_CHECK bf_status body__implicit_init(body_state *s, bf_error *err);

void body__implicit_fini(body_state *s); ///< Free it.

/// MICRO_IMPLICIT for the driver.
extern const driver_solver body__implicit;

/// Largest stable step for a checked definition, s; see kind.c.
double body__dt_stable(const micro_def *def);

/// micro_backend.advance
bf_status body__advance(void *state, uint64_t n, bf_error *err);
