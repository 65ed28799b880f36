/// Contacts of two bodies, or of a body with a plane or a plate, and the forces in them.
///
/// Contact points of cylinders that stand side by side or near a plate, or lie, are computed in closed form; all
/// others from the convex hulls of the bodies (core/convex/).
///
/// Memory   the separating direction of two bodies, or the feature (face or edges) that carries
///          their contact, is stored from step to step while their bounding spheres overlap, and
///          cleared when they do not, so that it does not depend on when the list of neighbours
///          was built. A feature stays in use as long as no adjacent one has less depth, so that
///          contacts do not jump to the far side of thin bodies.

#pragma once

#include "core/convex/manifold.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BODY_CLOSED_FORM_POINTS = 2 }; ///< contact points of cylinders in closed form

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

/// What is stored of a pair of bodies from step to step; zero: nothing.
typedef struct body_memory {
    vec3 axis;                ///< direction of the last search, from a to b in a's frame
    manifold_feature feature; ///< MANIFOLD_NONE: they did not overlap
    double gap;               ///< lower bound of their distance, m
} body_memory;

/// The impulse of a contact in the last step of MICRO_IMPLICIT, from which the next one starts.
typedef struct body_warm_start {
    uint32_t key;         ///< which contact of a part, see implicit_contact.c; 0: none
    vec3 impulse;         ///< on b, N s
    vec3 angular_impulse; ///< same about the middle of the contact, N m s
} body_warm_start;

/// Two neighbouring parts, a < b, and the force between them.
typedef struct body_pair {
    uint32_t a;                 ///< part
    uint32_t b;                 ///< part
    body_memory memory;         ///< see there
    bool has_force;             ///< a force acts in this step
    vec3 force;                 ///< on b; minus that on a, N
    vec3 torque_a;              ///< on a about its centre, N m
    vec3 torque_b;              ///< on b
    body_warm_start warm_start; ///< MICRO_IMPLICIT
} body_pair;

/// A contact point that has a normal of its own.
typedef struct body_contact_point {
    vec3 at;       ///< in the middle of the overlap, m
    vec3 normal;   ///< from a to b, or out of the boundary
    double depth;  ///< m; < 0: apart
    double weight; ///< of stiffness and dashpot
} body_contact_point;

/// The contact points of a part with another one or with a boundary, in the world's frame.
typedef struct body_contact {
    bool is_closed_form;                                ///< points are used, else hull
    size_t n_points;                                    ///< see there
    body_contact_point points[BODY_CLOSED_FORM_POINTS]; ///< see there
    manifold hull;                                      ///< see there
} body_contact;

enum { BODY_NO_PLATE = -1 };

/// A straight plate on the belt, of infinite height.
typedef struct body_plate {
    vec3 middle;           ///< z = 0
    vec3 along;            ///< unit vector along it
    vec3 across;           ///< unit vector to the upstream side
    double half_length;    ///< m
    double half_thickness; ///< m
    double lift;           ///< of surroundings_piece, m
    int32_t joined[2];     ///< the plates of the same obstacle at its start and at its end;
                           ///< BODY_NO_PLATE: it ends there
    double bend[2];        ///< sine of the angle by which the path turns left there
    bool has_step[2]; ///< on the outer side of that bend one surface is higher than the other, as
                      ///< they have their bodies on different sides of the path
} body_plate;

/// Extremes and events of a block of parts.
typedef struct body_report {
    double overlap;       ///< largest of a part with a part, plate or wall since the start, m
    double overlap_share; ///< same, divided by the smaller part's radius
    uint32_t pressed[2];  ///< the parts of that; the second is UINT32_MAX if it is a plate or wall
    size_t n_contacts;    ///< such contacts in the last step
    size_t
        bad_part;  ///< the first one that moved too far in a step or is not finite; SIZE_MAX: none
    bool is_stale; ///< a part moved too far for the list
} body_report;

/// Force and torque on a body, about its centre of mass.
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
static inline void body__add_force(body_load *load, const body_body *body, vec3 at, vec3 force)
{
    load->force = vec3_add(load->force, force);
    load->torque = vec3_add(load->torque, vec3_cross(vec3_sub(at, body->x), force));
}

/// Find the contact of a pair that overlaps or is nearer than `margin`, m. Returns false if there is none.
bool body__find_pair(const body_state *s, double margin, body_pair *pair,
                     body_contact *ret_contact);

/// Compute the force between the parts of a pair.
void body__find_pair_force(const body_state *s, body_pair *pair, body_report *report);

/// Record a contact of part k with another one, or UINT32_MAX, with a normal force.
void body__note(body_report *report, uint32_t k, uint32_t other, double overlap, double radius);

/// Find the manifold of two hulls, in the frame of a, starting from their memory. Returns false if they are
/// farther apart than `margin`, m.
bool body__find_manifold(const gjk_pair *pair, double margin, body_memory *memory,
                         manifold *ret_manifold);

/// Find the contact of a body with a plane, in closed form or by its hull.
void body__find_at_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                         double margin, body_contact *ret_contact);

/// Find the 0 to 2 contact points of an upright cylinder at a plate, those within `margin`, m. Returns false,
/// without output, if the body is no upright cylinder.
bool body__find_cylinder_at_plate(const body_state *s, const body_body *body,
                                  const body_plate *plate, double margin,
                                  body_contact_point *ret_points, size_t *ret_n);

/// Horizontal distance from a point to a plate, m; 0 inside.
double body__plate_distance(const body_plate *plate, double x, double y);

/// A lower bound of that distance at any time, also where the plate moves.
double body__plate_distance_ever(const body_state *s, size_t plate, double x, double y);

/// True if a point on the outer side of a bend is nearer to the plate beyond the joint: between the ends of that
/// one, or at the corner, which belongs to the earlier plate.
bool body__is_felt_beyond_joint(const body_state *s, const body_plate *plate, double x, double y);

/// True if a point on the outer side of a bend is nearer to the plate beyond the joint, and the surfaces do not meet there. A
/// body with its centre there is felt by that plate alone, so that it is not caught by the step.
bool body__is_behind_step(const body_state *s, const body_plate *plate, vec3 x);

/// The plate beyond the joint at the start (end = 0) or the end (1) of a plate, if a point x is on the outer side of the bend and
/// the surfaces meet there; NULL: not so, or there is no joint. *ret_side is the side of both that x is on, 1: left, -1: right.
const body_plate *body__next_around(const body_state *s, const body_plate *plate, int end, vec3 x,
                                    double *ret_side);

/// Which plate a contact normal on the outer side of a joint belongs to.
typedef enum body_joint_contact {
    BODY_AT_PLATE,       ///< to this plate: to its side, a free end, or a corner that is its own
    BODY_AT_OTHER_PLATE, ///< to the corner, which is of the plate that the centre is nearer to
    BODY_INSIDE_JOINT,   ///< to the end, which is inside the next plate: no contact has it
} body_joint_contact;

/// Say it for a body with its centre at x, of which the contact with the plate as a cuboid has this normal.
body_joint_contact body__feel_at_joints(const body_state *s, const body_plate *plate, vec3 x,
                                        vec3 normal);

/// Ids, ascending, of the plates that a part with its centre at a point may be in contact with until the list
/// of neighbours is built again. NULL without plates.
const uint32_t *body__plates_near(const body_state *s, double x, double y, size_t *ret_n);
