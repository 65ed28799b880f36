/// The planar microscopic model as core/micro/disk/disk_priv.h states it, by explicit steps: all pairs, one
/// after the other, nothing sorted, nothing stored between steps. Slow on purpose: an oracle for
/// core/micro. Plates must be straight; polygons of belts convex and counter-clockwise.

#pragma once

#include "core/micro/micro.h"

/// A part.
typedef struct disk_part {
    double x;       ///< m
    double y;       ///< m
    double heading; ///< rad
    double vx;      ///< m/s, of the last half step
    double vy;      ///< same
    double spin;    ///< rad/s
    bool is_gone;   ///< left the domain
} disk_part;

/// Parts on their way. The definition given to disk_create() and its arrays must stay.
typedef struct planar planar;

/// A reference solver of the same definition, at its start; NULL: no memory. dt must be given.
planar *disk_create(const micro_def *def);

/// Free it. Always returns NULL.
planar *disk_destroy(planar *p);

/// Advance by one step.
void disk_advance(planar *p);

/// All parts, to be read or changed.
disk_part *disk_parts(planar *p);
