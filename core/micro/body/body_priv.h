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
///     cylinders standing side by side or near a plate, or lying, in closed form: narrow_phase.h
///
/// The body frame is that of the principal axes with its origin in the centre of mass.
///
/// Sums     over neighbours by their numbers, then plates by theirs, then walls, then the belt;
///          each pair is worked out once. Blocks of BODY_BLOCK parts are shared out to threads.

#pragma once

#include "core/base/checkpoint.h"
#include "core/micro/body/narrow_phase.h"
#include "core/micro/contact_law.h"
#include "core/micro/driver.h"
#include "core/micro/micro.h"
#include "core/micro/neighbours.h"
#include "core/scene/surroundings.h"

enum {
    BODY_BLOCK = 16,      ///< parts that one thread handles together
    BODY_PLATES_NEAR = 4, ///< plates whose contact a part can remember
    BODY_HOLDS = 8,       ///< solids whose impulses a part can remember
};

/// A face that presses with all of itself, weighted with the shares of its corners.
typedef struct body_face {
    vec3 centre;   ///< sum of share p, in the body frame, m
    mat3 spread;   ///< sum of share r r^T with r = p - centre, m2
    vec3 skew;     ///< sum of share r |r|^2, m3
    double radius; ///< largest |r|, m
} body_face;

/// A kind of part, ready for the steps.
typedef struct body_kind {
    hull shape;           ///< in the body frame
    quat turn;            ///< body frame in the frame of the shape
    vec3 centre;          ///< of mass, in the frame of the shape, m
    double bottom;        ///< lowest z of the shape in its frame, m
    bool is_round;        ///< a cylinder, about the body's z axis
    double radius;        ///< of a cylinder; else of the disk with the footprint's area, m
    double half_height;   ///< of a cylinder, m
    double mass;          ///< kg
    vec3 inertia;         ///< about the principal axes, kg m2
    double softness;      ///< (1 - nu^2)/E with E divided by modulus_reduction, 1/Pa
    double spin_radius;   ///< r_spin of (8), m
    double flat_gyration; ///< g_0, m
    micro_law floor;      ///< on a belt
    micro_law solid;      ///< against plates and walls
    body_face faces[HULL_FACES_MAX]; ///< of shape
} body_kind;

/// Memory of a part and a plate.
typedef struct body_near {
    uint32_t plate;     ///< its number and 1; 0: a free place
    body_memory memory; ///< plate is a, part is b
} body_near;

/// Which plates are near a place: the numbers plate[first[c]] .. of cell c.
typedef struct body_map {
    double x_min;    ///< m
    double y_min;    ///< m
    double edge;     ///< of a cell, m
    size_t n_x;      ///< cells along x
    size_t n_y;      ///< along y
    size_t *first;   ///< n_x n_y + 1
    uint32_t *plate; ///< rising in each cell
    size_t capacity; ///< room in plate
} body_map;

/// Where around a part one belt is under all of it.
typedef struct body_ground {
    vec2 at; ///< m
    double
        clear; ///< nothing changes until the part has moved by so much from there, m; < 0: unknown
    vec3 velocity; ///< of that belt, m/s
} body_ground;

/// The solver.
struct body_state {
    micro_def def;       ///< without its arrays
    vec3 gravity;        ///< m/s2
    double spin_damping; ///< (1 - D)^dt
    micro_law cargo;     ///< of parts; its stiffness is that of softness 1: divide by the sum
    size_t n_kinds;      ///< see there
    body_kind *kinds;    ///< see there
    size_t n;            ///< parts
    body_body *bodies;   ///< by number
    uint8_t *is_gone;    ///< by number
    body_near (*near)[BODY_PLATES_NEAR]; ///< by number; NULL without plates
    body_ground *ground;                 ///< by number
    double *reach;                       ///< radius of the ball around each body, m
    double reach_max;                    ///< m
    double reach_min;                    ///< m
    neighbours_list list;                ///< neighbours
    bool is_listed;                      ///< the list and what goes with it are right
    size_t n_pairs;                      ///< pairs in the list
    size_t pairs_capacity;               ///< room
    body_pair *pairs;                    ///< sorted by a, then b
    size_t spare_capacity;               ///< room
    body_pair *spare;                    ///< storage of the list before
    size_t *first_pair;                  ///< n + 1: where the pairs with a = k begin
    size_t *cursor;                      ///< n: scratch of the list
    size_t links_capacity;               ///< room
    uint32_t *links;                     ///< pair of each place in list.neighbour
    size_t n_plates;                     ///< see there
    body_plate *plates;                  ///< see there
    body_map map;                        ///< of plates
    double map_range;       ///< from a part's centre to plates that the map has to show, m
    surroundings around;    ///< a copy: belts and edges
    size_t n_blocks;        ///< of parts
    body_report *reports;   ///< one a block
    uint64_t steps;         ///< since t = 0
    double largest_overlap; ///< since the start, m
    double overlap_share;   ///< see micro_totals
    size_t n_presses;       ///< see micro_totals
    struct implicit_solver *implicit; ///< of MICRO_IMPLICIT, else NULL
};

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

/// MICRO_IMPLICIT for the driver.
extern const driver_solver body__implicit;

/// Add what the belt does to part k.
void body__floor_push(body_state *s, size_t k, body_load *load);

/// Largest stable step for a checked definition, s; see kind.c.
double body__dt_stable(const micro_def *def);

/// Members of micro_backend.
bf_status body__advance(void *state, uint64_t n, bf_error *err);
micro_part body__part(const void *state, size_t k);
micro_totals body__measure(const void *state);
void body__save(const void *state, checkpoint_writer *w);
bf_status body__load(void *state, checkpoint_reader *r, bf_error *err);
