/// CMA-ES: the evolution strategy with adaptation of the covariance matrix, for the least value of a function on the
/// unit cube of up to CMAES_DIMENSIONS parameters. Each generation draws lambda points from a normal distribution
/// N(m, sigma^2 C), and moves m, sigma and C by the order of their values.
///
/// All constants are the defaults of the source's table 1, with negative weights: lambda = 4 + floor(3 ln d), and so on.
/// m begins in the middle of the cube and sigma with 0.3. The cube is continued by reflection at its faces, so that every
/// point of space stands for one of the cube.
///
/// Source   N. Hansen: The CMA Evolution Strategy: A Tutorial, arXiv:1604.00772 (2016).
/// State    plain numbers, to be copied, saved and restored; it depends on the seed and the values alone.

#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    CMAES_DIMENSIONS = 20, ///< most parameters
    CMAES_POPULATION = 12, ///< largest lambda, that of CMAES_DIMENSIONS
};

/// The distribution of a generation. Begin with cmaes_begin().
typedef struct cmaes {
    uint64_t seed;                                   ///< of the draws
    uint64_t d;                                      ///< parameters
    uint64_t generation;                             ///< from 0
    double sigma;                                    ///< step length
    double mean[CMAES_DIMENSIONS];                   ///< m
    double sigma_path[CMAES_DIMENSIONS];             ///< p_sigma
    double path[CMAES_DIMENSIONS];                   ///< p_c
    double c[CMAES_DIMENSIONS][CMAES_DIMENSIONS];    ///< C
    double axes[CMAES_DIMENSIONS][CMAES_DIMENSIONS]; ///< B: column k is an eigenvector of C
    double lengths[CMAES_DIMENSIONS];                ///< D: roots of the eigenvalues
} cmaes;

/// The distribution of the first generation of 1 <= d <= CMAES_DIMENSIONS parameters.
cmaes cmaes_begin(uint64_t seed, size_t d);

/// lambda: points of each generation in d parameters.
size_t cmaes_population(size_t d);

/// The points of the present generation, d coordinates each, all in the unit cube.
void cmaes_points(const cmaes *s, double *ret_points);

/// Go on to the next generation with the values of the points; INFINITY: a point has none.
void cmaes_update(cmaes *s, const double *values);

/// True when the deviation along every parameter is below the tolerance, or C is so badly conditioned (1e14) that
/// rounding decides.
bool cmaes_is_converged(const cmaes *s, double tolerance);
