/// Where two bodies touch each other, or a body touches a plane or a plate, and what acts there.
///
/// Cylinders that stand side by side, or near a plate, or lie, touch in closed form; everything else by the
/// convex hulls of the bodies (core/convex/).
///
/// Memory   the direction that separates two bodies, or the feature that carries their contact, is
///          kept from step to step while the balls around them touch, and forgotten when they do
///          not, so that it does not depend on when the list of neighbours was made. A feature is
///          kept as long as no other one close by has less depth: contacts do not jump through thin
///          bodies.

#pragma once

#include "core/convex/manifold.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BODY_SPOTS_MAX = 2 }; ///< contact points of cylinders in closed form

typedef struct body_state body_state; ///< core/micro/body/body_priv.h

/// A part.
typedef struct body_body {
    vec3 x;        ///< centre of mass, m
    quat q;        ///< from the body frame to the world
    vec3 v;        ///< of the last half step, m/s
    vec3 w;        ///< same, rad/s
    mat3 r;        ///< rotation of q
    uint32_t kind; ///< see there
} body_body;

/// What a pair of bodies is remembered by; zero: by nothing.
typedef struct body_memory {
    vec3 axis;                ///< of the last search, from a to b in a's frame
    manifold_feature feature; ///< MANIFOLD_NONE: they were apart
    double gap;               ///< m; no contact until they have moved by so much
} body_memory;

/// The impulse of a contact in the last step of MICRO_IMPLICIT.
typedef struct body_hold {
    uint32_t key; ///< which contact of a part with a solid, and 1; 0: none
    vec3 push;    ///< on b, N s
    vec3 twist;   ///< same about the middle of the contact, N m s
} body_hold;

/// What acts between two parts, a < b.
typedef struct body_pair {
    uint32_t a;         ///< part
    uint32_t b;         ///< part
    body_memory memory; ///< see there
    bool is_pressing;   ///< a force acts in this step
    vec3 force;         ///< on b; minus that on a, N
    vec3 torque_a;      ///< on a about its centre, N m
    vec3 torque_b;      ///< on b
    body_hold hold;     ///< MICRO_IMPLICIT
} body_pair;

/// A contact point that has a normal of its own.
typedef struct body_spot {
    vec3 at;      ///< in the middle of the overlap, m
    vec3 normal;  ///< from a to b, or out of the solid
    double depth; ///< m; < 0: apart
    double share; ///< of stiffness and dashpot
} body_spot;

/// Where a part touches another one or something at rest, in the world's frame: in closed form or
/// by hulls.
typedef struct body_region {
    bool is_round;                   ///< spots count, else hull
    size_t n_spots;                  ///< see there
    body_spot spots[BODY_SPOTS_MAX]; ///< see there
    manifold hull;                   ///< see there
} body_region;

enum { BODY_NO_PLATE = -1 };

/// A straight plate that stands on the belt without end upwards.
typedef struct body_plate {
    vec3 middle;           ///< z = 0
    vec3 along;            ///< unit vector along it
    vec3 across;           ///< unit vector to the upstream side
    double half_length;    ///< m
    double half_thickness; ///< m
    int32_t joined[2];     ///< the plates of the same obstacle at its start and at its end;
                           ///< BODY_NO_PLATE: it ends there
    double bend[2];        ///< sine of the angle by which the path turns left there
} body_plate;

/// What a block of parts found in a step.
typedef struct body_report {
    double overlap;   ///< largest of part with part, plate or wall since the start, m
    double share;     ///< same, by the smaller part's radius
    size_t n_presses; ///< such contacts in the last step
    size_t bad_part;  ///< the first one that flew off or is not finite; SIZE_MAX: none
    bool is_stale;    ///< a part moved too far for the list
} body_report;

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

/// The region of a pair if it touches, or comes nearer than `near`, m. Returns false if not.
bool body__find_pair(const body_state *s, double near, body_pair *pair, body_region *ret_region);

/// Work out what acts in a pair.
void body__meet(const body_state *s, body_pair *pair, body_report *report);

/// Note a contact that presses.
void body__note(body_report *report, double overlap, double radius);

/// The contact of two hulls from what is remembered of them, in the frame of a. Returns false if
/// they are apart by more than `near`, m.
bool body__find_manifold(const gjk_pair *pair, double near, body_memory *memory,
                         manifold *ret_manifold);

/// The region of a body at a plane, in closed form or by its hull.
void body__find_at_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                         double near, body_region *ret_region);

/// The contact points of a cylinder that stands against a plate, 0 to 2, where they are not apart by more than
/// `near`. Returns false, with no output, if it stands otherwise or is none.
bool body__round_plate(const body_state *s, const body_body *body, const body_plate *plate,
                       double near, body_spot *ret_spots, size_t *ret_n);
