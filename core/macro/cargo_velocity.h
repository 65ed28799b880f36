/// How fast cargo crosses the faces of a cell: its flux through a face divided by the density that it comes from,
///
///     u = F / rho,    rho of the cell before the face where F > 0, of that behind it where F < 0,
///
/// with F the very flux by which the density moved in a step. Free cargo so has the velocity of its belt, what
/// stands has none, and nothing crosses a closed face.
///
/// `congested`   worked out where it is asked for, from the flux of the correction that the step has left at the faces:
///               F = F_stat + G, and u is the static velocity itself where G is 0.
/// `dispersive`  recorded by the sweeps of a step's first stage where cargo disperses, as its fluxes are nowhere
///               afterwards; elsewhere u is the static velocity.
///
/// Units    m/s, towards rising x.

#pragma once

#include "core/macro/macro_priv.h"

/// Velocities across the faces of a cell.
typedef struct cargo_velocity {
    double west;  ///< along x1
    double east;  ///< same
    double south; ///< along x2
    double north; ///< same
} cargo_velocity;

/// What the sweeps record; nothing with `congested`.
typedef struct cargo_velocity_record {
    double *u1; ///< n2 rows, of the x1-faces, as macro_faces has them
    double *u2; ///< n2 + 1 rows, of the x2-faces
} cargo_velocity_record;

/// Memory of a solver's record; BF_ENOMEM. What is owned is freed by cargo_velocity_fini() in any case.
BF_MUST_CHECK bf_status cargo_velocity_init(const macro_solver *s, cargo_velocity_record *record);
void cargo_velocity_fini(cargo_velocity_record *record);

/// Of the cell in column i of row j, in the last step.
cargo_velocity cargo_velocity_of(const macro_solver *s, ptrdiff_t i, ptrdiff_t j);

/// What leaves the cell in column i of row j over a side: u times the density that it comes from when the step began, or
/// with two stages its second one.
double cargo_velocity_flux(const macro_solver *s, ptrdiff_t i, ptrdiff_t j, scene_side side);

/// How fast cargo leaves each cell of row j: the length of the vector of what leaves it along both axes.
void cargo_velocity_speeds(const macro_solver *s, ptrdiff_t j, double *ret_speeds);

/// What crosses a row of faces, as a sweep has it.
typedef struct cargo_velocity_fluxes {
    const double *flux;     ///< density times m/s
    const double *left;     ///< density before each face
    const double *right;    ///< density behind it
    const uint64_t *blocks; ///< where it may be more than the static velocity's
} cargo_velocity_fluxes;

/// Record a row of u1 or u2.
void cargo_velocity_put(const macro_solver *s, const macro_faces *faces,
                        const cargo_velocity_fluxes *of, ptrdiff_t row, double *rows);
