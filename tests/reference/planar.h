/// The planar microscopic model as core/micro/planar_priv.h states it, by explicit steps: all pairs, one
/// after the other, nothing sorted, nothing kept between steps. Slow on purpose: an oracle for
/// core/micro. Plates must be straight; polygons of belts convex and counter-clockwise.

#pragma once

#include "core/micro/micro.h"

/// A part.
typedef struct planar_part {
    double x;       ///< m
    double y;       ///< m
    double heading; ///< rad
    double vx;      ///< m/s, of the last half step
    double vy;      ///< same
    double spin;    ///< rad/s
    bool is_gone;   ///< left the domain
} planar_part;

/// Parts on their way. The definition given to planar_create() and its arrays must stay.
typedef struct planar planar;

/// A reference solver of the same definition, at its start; NULL: no memory. dt must be given.
planar *planar_create(const micro_def *def);

/// Free it. Always returns NULL.
planar *planar_destroy(planar *p);

/// Advance by one step.
void planar_advance(planar *p);

/// All parts, to be read or changed.
planar_part *planar_parts(planar *p);
