/// Plates: where those that move are in a step, and the velocity of their surfaces.

#pragma once

#include "core/micro/body/narrow_phase.h"
#include "core/micro/micro.h"
#include "core/scene/plate_range.h"

/// How a plate moves. The velocity of its surface in p is spin x (p - pivot) + v + growth n, n the normal
/// there.
typedef struct body_moving {
    bool moves;        ///< the rest is not used otherwise
    size_t obstacle;   ///< index of the obstacle that it belongs to
    body_plate rest;   ///< as in the document
    plate_range range; ///< of its places
    vec2 rest_pivot;   ///< its pivot as in the document, m
    vec3 pivot;        ///< in this step, z = 0, m
    vec3 velocity;     ///< of the pivot in this step, m/s
    double radius;     ///< that no point of it leaves about the pivot, m
    double depth;      ///< largest overlap of a part with it, m
    double spin;       ///< in this step, rad/s, counter-clockwise
    double recess;     ///< how far its surface is behind its place, m; INFINITY: it is not there
    double growth;     ///< at which that decreases, m/s
} body_moving;

/// Make the plates of the obstacles and map them. BF_ENOMEM.
BF_MUST_CHECK bf_status body__plates_init(body_state *s, const micro_def *def, bf_error *err);
void body__plates_fini(body_state *s); ///< Free them.

/// Note that the plates from `first` on are those of an obstacle of a definition, which moves.
void body__add_moving_plates(body_state *s, const micro_def *def, size_t obstacle, size_t first);

/// Place the plates that move for a step, before which n_before were made; by one thread.
void body__pose_plates(body_state *s, uint64_t n_before);

/// The fastest that a surface of a plate moves in this step, m/s.
double body__plates_speed(const body_state *s);

/// How a boundary (body_visit) moves; NULL: it does not.
const body_moving *body__moving_plate(const body_state *s, uint32_t boundary);

/// True if a plate is not there in this step.
bool body__is_absent(const body_state *s, uint32_t plate);

/// Reduce a contact with a plate, of points within `margin`, m, to what there is of the plate.
void body__recess_contact(const body_state *s, uint32_t plate, double margin,
                          body_contact *contact);

/// micro_backend.load_on
plate_load body__load_on(void *state, size_t obstacle);

/// Velocity of a surface with normal n at `to` from the pivot, m/s.
vec3 body__surface_velocity(const body_moving *moving, vec3 n, vec3 to);
