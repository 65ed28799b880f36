/// Exact cell integrals of the Gaussian mollifier's gradient (15)-(16), separated by direction.
///
/// With g the 1-D normal density of standard deviation 1/sqrt(sigma), Phi its distribution function
/// and d the cell edge,
///
///     gradient_p = g((p + 1) d) - g(p d)              weight along the derivative, face at p + 1/2
///     integral_p = Phi((p + 1/2) d) - Phi((p - 1/2) d)   weight across it
///     c1_{p,q} = gradient1_p integral2_q,   c2_{p,q} = integral1_p gradient2_q,   -S <= p, q <= S
///
/// so that D1_{i,j} = sum_{p,q} rho_{i-p,j-q} c1_{p,q} at face (i + 1/2, j), and D2 likewise.

#pragma once

#include <stddef.h>

enum { MOLLIFIER_REACH_MAX = 64 }; ///< largest S

/// The weights of one direction.
typedef struct mollifier {
    int reach; ///< S
    double gradient[2 * MOLLIFIER_REACH_MAX +
                    1]; ///< element m is gradient_p for p = S - m: the weight of
                        ///< cell i - S + m for the face i + 1/2
    double integral[2 * MOLLIFIER_REACH_MAX + 1]; ///< integral_p in the same order
} mollifier;

/// S = ceil(4 / (sqrt(sigma) d)): the mollifier is cut off at four standard deviations.
int mollifier_reach(double sigma, double d);

/// The weights for cells of edge d, m, and sigma, 1/m2. S must be at most
/// MOLLIFIER_REACH_MAX.
void mollifier_init(mollifier *m, double sigma, double d);
