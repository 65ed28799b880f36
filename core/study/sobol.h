/// Sobol's sequence: points of [0, 1)^d that fill it evenly, any 2^k consecutive ones from a multiple of 2^k on
/// having one coordinate in each of 2^k equal intervals.
///
/// Source   I. M. Sobol', USSR Comput. Math. Math. Phys. 7 (1967); direction numbers: S. Joe, F. Y. Kuo: Constructing
///          Sobol sequences with better two-dimensional projections, SIAM J. Sci. Comput. 30 (2008), their
///          table new-joe-kuo-6; order of the points: I. A. Antonov, V. M. Saleev (1979), Gray's code.

#pragma once

#include <stdint.h>

enum {
    SOBOL_DIMENSIONS = 20, ///< that the table has
    SOBOL_BITS = 32,       ///< of a coordinate
};

/// Coordinate of point `index` < 2^32 in a dimension, counted from 0, in units of 2^-32.
uint32_t sobol_coordinate(uint64_t index, unsigned dimension);
