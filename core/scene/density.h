/// Density from parts (18) and its integrals.
///
///     rho0(x) = sigma0 / (2 pi rho_max) * sum_i exp(-sigma0 |x - x_i|^2 / 2)
///
/// evaluated at cell centres. The term of a part is left out where it is less than 2^-53 of its peak:
/// below the rounding of the sum, and it leaves cells without cargo exactly zero.

#pragma once

#include "core/base/grid.h"
#include "core/scene/scene.h"

/// Cells over which a part is spread: those up to where its Gaussian has fallen to 2^-53, at most all n_cells. cell_area: m2.
double density_cells(double sigma0, double cell_area, double n_cells);

/// Fill rho (n1 * n2, layout of grid.h, normalised by packing, parts/m2) from n parts.
/// BF_ENOMEM; rho is then as before.
BF_MUST_CHECK bf_status density_from_parts(const bf_grid *grid, double packing, double sigma0,
                                           const scene_pose *poses, size_t n, double *rho,
                                           bf_error *err);
