/// The frictions (7) and (8), and tanh, of which both are made.
///
///     sliding   f_s = -mu |f_c| tanh(lambda_lin |u|) u/|u|         u the slip                      (7)
///     spin      t_s = -mu r_s |f_c| tanh(lambda_ang |w|) sgn(w)    w the spin about the normal     (8)
///
/// Written with theta(z) = tanh(z)/z neither divides by a slip that may be 0: f_s = -g u with
/// the secant coefficient
///
///     g = mu |f_c| lambda theta(lambda |u|)                        N s/m, or N m s
///
/// which implicit steps take at the velocity known so far and multiply by that at the end of the step.
///
/// tanh is made of +, -, * and / alone, by a continued fraction and the doubling
/// tanh 2y = 2 tanh y / (1 + tanh^2 y), so that every processor gives the same bits. There are three
/// fractions: results depend on the last bit of each, so one cannot stand for another.
///
///     friction_tanh, friction_theta         lanes, within 1e-12: explicit steps in the plane
///     friction_theta_quick                  lanes, within 2e-4: the secants of implicit steps in the plane,
///                                           which are approximations anyway
///     friction_theta_close                  lanes, within 1e-12: bodies in space

#pragma once

#include "core/base/simd.h"
#include "core/base/simd_compare.h"

#include <math.h>

/// A quotient that is not yet divided.
typedef struct friction_quotient {
    simd up;   ///< numerator
    simd down; ///< denominator
} friction_quotient;

/// Where tanh is 1 to the last bit.
#define FRICTION_TANH_END 18.0

/// Compiled into the loop that calls it.
#define FRICTION_INLINED static inline __attribute__((always_inline))

/// tanh(y)/y for y^2, by Lambert's continued fraction.
FRICTION_INLINED friction_quotient friction_lambert(simd y2)
{
    return (friction_quotient){ (y2 + 105.0) * y2 + 945.0, (y2 * 15.0 + 420.0) * y2 + 945.0 };
}

/// tanh(8 y). Doubling raises the error of the fraction less than the way to 1 lowers it; the relative
/// error is largest at 8 y = 5.5.
FRICTION_INLINED friction_quotient friction_tanh(simd y)
{
    const double end = FRICTION_TANH_END / 8.0;
    simd within = simd_min(simd_max(y, simd_all(-end)), simd_all(end));
    friction_quotient t = friction_lambert(within * within);

    t.up *= within;
    for (int k = 0; k < 3; k++)
        t = (friction_quotient){ (t.up + t.up) * t.down, t.up * t.up + t.down * t.down };
    return t;
}

/// theta(8 y) for y^2, likewise; beyond the end 1/(8 y).
FRICTION_INLINED friction_quotient friction_theta(simd y2)
{
    const double end2 = FRICTION_TANH_END * FRICTION_TANH_END / 64.0;
    simd end = simd_all(end2), square = simd_min(y2, end);
    friction_quotient t = friction_lambert(square);

    for (int k = 0; k < 3; k++, square *= 4.0)
        t = (friction_quotient){ t.up * t.down, square * (t.up * t.up) + t.down * t.down };
    // The factor is 1 for lanes within the end.
    if (simd_less(end, y2) != 0)
        t.down *= simd_sqrt(simd_max(y2, end) / end);
    return t;
}

/// theta(z) for z >= 0: Lambert's fraction up to 4.9, where it is 1/z to that accuracy, and c/z from
/// there on.
FRICTION_INLINED friction_quotient friction_theta_quick(simd z)
{
    simd low = simd_min(z, simd_all(4.9)), beyond = z - low, q = low * low;

    return (friction_quotient){ ((q + 378.0) * q + 17325.0) * q + 135135.0,
                                (((q * 28.0 + 3150.0) * q + 62370.0) * q + 135135.0) *
                                    (beyond * (1.0 / 4.9) + 1.0) };
}

/// theta(z) for z >= 0: the fraction at z/8, doubled three times.
FRICTION_INLINED friction_quotient friction_theta_close(simd z)
{
    const simd end = simd_all(FRICTION_TANH_END), low = simd_min(z, end);
    simd y2 = low * low / 64.0;
    simd up = (y2 * 21.0 + 1260.0) * y2 + 10395.0;
    simd down = ((y2 + 210.0) * y2 + 4725.0) * y2 + 10395.0;

    for (int k = 0; k < 3; k++, y2 *= 4.0) {
        simd twice = up * down;
        down = y2 * (up * up) + down * down;
        up = twice;
    }
    return (friction_quotient){ simd_select_less(z, end, up, simd_all(1.0)),
                                simd_select_less(z, end, down, z) };
}

/// Secant coefficients of (7), N s/m, for mu, normal forces or impulses, lambda and |u|; of (8), N m s, with mu r_s for mu
/// and |w| for |u|.
FRICTION_INLINED simd friction_secants(simd mu, simd normal, simd lambda, simd speed)
{
    const friction_quotient theta = friction_theta_close(lambda * speed);

    return mu * simd_max(normal, -normal) * lambda * (theta.up / theta.down);
}

/// A secant coefficient, as friction_secants().
static inline double friction_secant(double mu, double normal, double lambda, double speed)
{
    return friction_secants(simd_all(mu), simd_all(normal), simd_all(lambda), simd_all(speed))[0];
}
