/// The data of the spatial path: kinds of parts, parts, pairs, plates, belts.

#pragma once

#include "core/convex/manifold.h"
#include "core/micro/contact_law.h"
#include "core/micro/driver.h"
#include "core/micro/micro.h"
#include "core/micro/neighbours.h"
#include "core/scene/surroundings.h"

enum {
    BODY_BLOCK = 16,      ///< parts that one thread handles together
    BODY_PLATES_NEAR = 4, ///< plates whose contact a part can remember
    BODY_SPOTS_MAX = 2,   ///< contact points of cylinders in closed form
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

/// The impulse of a contact in the last step of MICRO_IMPLICIT; see body_implicit_priv.h.
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

/// Memory of a part and a plate.
typedef struct body_near {
    uint32_t plate;     ///< its number and 1; 0: a free place
    body_memory memory; ///< plate is a, part is b
} body_near;

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

/// What a block of parts found in a step.
typedef struct body_report {
    double overlap;   ///< largest of part with part, plate or wall since the start, m
    double share;     ///< same, by the smaller part's radius
    size_t n_presses; ///< such contacts in the last step
    size_t bad_part;  ///< the first one that flew off or is not finite; SIZE_MAX: none
    bool is_stale;    ///< a part moved too far for the list
} body_report;

/// The solver.
typedef struct body_state {
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
} body_state;
