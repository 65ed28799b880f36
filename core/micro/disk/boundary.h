/// Walls and plates as faces and arcs, and those of plates that move in a step.

#pragma once

#include "core/micro/disk/kernels.h"
#include "core/micro/micro.h"

/// A plate that moves.
typedef struct disk_plate {
    size_t obstacle;   ///< index of it
    size_t face_first; ///< its faces face_first <= k < face_last
    size_t face_last;  ///< see there
    size_t arc_first;  ///< its arcs likewise
    size_t arc_last;   ///< see there
    double radius;     ///< plate_range_radius(), m
    double depth;      ///< largest overlap of a part with it, m
} disk_plate;

/// The plates that move.
typedef struct disk_plates {
    size_t n;               ///< that move; 0: what follows is not used
    disk_plate *of;         ///< see there
    disk_face *faces;       ///< of the boundary, with plates as in the document
    disk_arc *arcs;         ///< same
    disk_surface *surfaces; ///< of each feature in the step that begins now
} disk_plates;

/// Lay out faces and arcs of walls and obstacles; s->common must be there. BF_ENOMEM.
BF_MUST_CHECK bf_status disk__boundary_init(disk_state *s, const micro_def *def, bf_error *err);
void disk__boundary_fini(disk_state *s); ///< Free them.

/// A part's overlap with a face or arc, m; 0 or less, or any value with *ret_counts false, where they
/// are not in contact.
double disk__overlap(const disk_state *s, const disk *part, uint32_t feature, bool *ret_counts);

void disk__plates_fini(disk_state *s); ///< Free the plates that move.

/// Note that the last faces and arcs, from these on, are those of an obstacle that moves.
void disk__add_moving_plate(disk_state *s, const scene_obstacle *obstacle, size_t index,
                            size_t face_first, size_t arc_first);

/// Keep all faces and arcs as they are in the document, if plates move, and place those. BF_ENOMEM.
BF_MUST_CHECK bf_status disk__copy_boundary(disk_state *s, bf_error *err);

/// Place the plates that move for a step, before which n_before were made; by one thread.
void disk__pose_plates(disk_state *s, uint64_t n_before);

/// The same for a team's next step; waits for its members.
void disk__pose_plates_by_team(const driver_member *m);

/// How far a surface of a plate moves at most in a step, before which n_before were made, m.
double disk__plates_travel(const disk_state *s, uint64_t n_before);

/// micro_backend.load_on
plate_load disk__load_on(void *state, size_t obstacle);

/// Velocity, m/s, of the point `at` of a surface with normal n.
vec2 disk__surface_velocity(const disk_surface *surface, vec2 n, vec2 at);
