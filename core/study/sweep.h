/// Sweeps: points of the unit cube that are all known before the first one is tried.
///
///     grid    the product of the steps of each parameter; the last parameter changes fastest
///     lhs     a Latin hypercube of n points: each of the n strata of each parameter has one point, at a random place
///     sobol   points 0, 1, ... of Sobol's sequence, their bits exchanged at random by the seed (a digital shift), which
///             leaves their evenness as it is
///
/// Source   M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979), Latin hypercubes; P. L'Ecuyer, C.
///          Lemieux: Recent advances in randomized quasi-Monte Carlo methods (2002), digital shifts.

#pragma once

#include <stddef.h>
#include <stdint.h>

/// Points of a grid of steps[d] >= 1 values for each of d parameters: the product of the steps, or SIZE_MAX where it is
/// larger.
size_t sweep_grid_points(const size_t *steps, size_t d);

/// Point `index` of a grid. A parameter with n steps has the values 0, 1/(n - 1), ..., 1, and 1/2 where n is 1.
void sweep_grid(const size_t *steps, size_t d, size_t index, double *ret_point);

/// All n points of a Latin hypercube in d dimensions, point by point.
void sweep_lhs(uint64_t seed, size_t n, size_t d, double *ret_points);

/// Point `index` of Sobol's sequence in d <= SOBOL_DIMENSIONS dimensions, each coordinate inside (0, 1).
void sweep_sobol(uint64_t seed, size_t index, size_t d, double *ret_point);
