/// Small test cases for the spatial path, whose state tests may change: gravity, positions, velocities.

#pragma once

#include "core/base/random.h"
#include "core/micro/backend.h"
#include "core/micro/body/parts.h"

enum { HELPER_BODY_PARTS = 64, HELPER_BODY_KINDS = 4 };

/// A definition with what it points to. Do not move it once it was made.
typedef struct helper_body {
    micro_def def;                          ///< to be changed at will
    scene_belt belts[2];                    ///< see def.n_belts
    scene_obstacle obstacle;                ///< see def.n_obstacles
    vec2 path[3];                           ///< of the obstacle
    micro_kind kinds[HELPER_BODY_KINDS];    ///< see def.n_kinds
    scene_pose poses[HELPER_BODY_PARTS];    ///< see def.n_parts
    uint32_t part_kinds[HELPER_BODY_PARTS]; ///< all 0
} helper_body;

/// A world of 2 m x 2 m about the origin, open on all sides, without belts, with one part of a
/// shape and of steel's stiffness and 0.03 kg at the origin; moduli are divided by 1e4, steps are
/// 1e-5 s, D = 0.
void helper_body_init(helper_body *h, scene_shape shape);

/// Shapes.
scene_shape helper_body_box(double length, double width, double height);
scene_shape helper_body_cylinder(double radius, double height);

/// Boxes, cylinders and wedges in 4 rows of 9, driven into the corner of a plate and a wall.
void helper_body_jam(helper_body *h);

/// 60 parts of a shape, which fits into 24 mm x 21 mm, before a passage of 8 cm that a plate of 60
/// degrees leaves open at x = 0.2 m.
void helper_body_passage(helper_body *h, scene_shape shape);

/// Parts with x < 0.2 m, n_samples times, every so many seconds. Asserts that all goes well.
void helper_body_curve(const micro_def *def, double every, int n_samples, double *ret_count);

/// Mean over time of the difference of two curves, in parts.
double helper_body_gap(const double *a, const double *b, int n_samples);

/// The solver of the world; free it with micro__body.destroy(). Asserts that all goes well.
body_state *helper_body_start(const helper_body *h);

/// Steps for a time. Asserts that all goes well.
void helper_body_run(body_state *s, double time);

/// Turn a part about an axis by an angle, and lift it so that its lowest point is at a height.
void helper_body_tilt(body_state *s, size_t k, vec3 axis, double angle, double height);

/// Kinetic energy and that of height, J; momentum, N s; angular momentum about the origin, N m s.
double helper_body_energy(const body_state *s);
vec3 helper_body_momentum(const body_state *s);
vec3 helper_body_angular_momentum(const body_state *s);

/// Elastic energy of part 0 on the belt plane, J.
double helper_body_stored(const body_state *s);

/// Assert that a part which falls on its corners with spin never gains energy, beside the elastic one, and loses a fifth of it.
void helper_body_check_fall(const helper_body *h, bf_random *random);

/// Assert that two parts that collide off centre, without a belt, turn, lose energy and keep their momentum; their angular
/// momentum up to this fraction, the error of the steps.
void helper_body_check_pair(helper_body *h, double tolerance);

/// Assert that a plate of half a millimetre, or a wall, stops a part that the belt drives on.
void helper_body_check_barrier(helper_body *h, bool is_wall);

/// Digest of all parts.
uint64_t helper_body_digest(const body_state *s);
