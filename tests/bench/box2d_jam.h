/// Equal disks on a belt in Box2D. In C++ behind an interface in C; SI units.

#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// What all disks have in common. As they are equal, their mass has no effect.
typedef struct box2d_jam_def {
    double radius;           ///< m
    double damping;          ///< 1/s, of velocity and spin
    double friction;         ///< mu of disk on disk, > 0
    double wall_friction;    ///< mu of disk on wall
    double belt_velocity[2]; ///< m/s; the disks start with it
    double
        belt_deceleration; ///< a, m/s2: u' = -a tanh(lambda |u|) u/|u| is the belt's effect on the slip u
    double belt_tanh_linear;  ///< that lambda, s/m
    double spin_deceleration; ///< b, rad/s2: w' = -b tanh(lambda w) is its effect on the spin w
    double belt_tanh_spin;    ///< that lambda, s
} box2d_jam_def;

/// A step of b2World.
typedef struct box2d_step {
    double dt;                 ///< s
    int n_velocity_iterations; ///< see b2World::Step()
    int n_position_iterations; ///< same
} box2d_step;

typedef struct box2d_jam box2d_jam; ///< opaque

/// A belt without disks and walls. The caller owns it: box2d_jam_destroy().
box2d_jam *box2d_jam_create(const box2d_jam_def *def);

/// Free it.
void box2d_jam_destroy(box2d_jam *j);

/// Add a disk with its centre at (x, y), m.
void box2d_jam_add_disk(box2d_jam *j, double x, double y);

/// Add a wall along n >= 2 points, m, which stops disks to the right of its direction.
void box2d_jam_add_wall(box2d_jam *j, size_t n, const double (*points)[2]);

/// Make n steps.
void box2d_jam_advance(box2d_jam *j, size_t n, const box2d_step *step);

/// How many disks have their centres before x, m; those whose place is not a number are not among them.
size_t box2d_jam_count_before(const box2d_jam *j, double x);

/// The largest overlap of disks with each other and with walls now, m.
double box2d_jam_overlap(const box2d_jam *j);

#ifdef __cplusplus
}
#endif
