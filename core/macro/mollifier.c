#include "core/macro/mollifier.h"

#include "core/base/check.h"

#include <math.h>

static const double one_over_sqrt_2pi = 0.398942280401432677939946059934;

static double density(double sigma, double x)
{
    return sqrt(sigma) * one_over_sqrt_2pi * exp(-0.5 * sigma * x * x);
}

// Phi(b) - Phi(a) without the cancellation of two values near 1.
static double interval_integral(double sigma, double a, double b)
{
    double scale = sqrt(0.5 * sigma);
    if (a > 0.0)
        return 0.5 * (erfc(a * scale) - erfc(b * scale));
    if (b < 0.0)
        return 0.5 * (erfc(-b * scale) - erfc(-a * scale));
    return 0.5 * (erf(b * scale) - erf(a * scale));
}

int mollifier_reach(double sigma, double d)
{
    // 4/(0.01 * 0.005) must give 8 in spite of rounding, so a small tolerance is subtracted.
    double cells = ceil(4.0 / (sqrt(sigma) * d) * (1.0 - 1e-12));
    return cells < 1.0 ? 1 : cells > 1e9 ? 1000000000 : (int)cells;
}

void mollifier_init(mollifier *m, double sigma, double d)
{
    int reach = mollifier_reach(sigma, d);

    BF_CHECK(reach <= MOLLIFIER_REACH_MAX);
    *m = (mollifier){ .reach = reach };
    for (int p = -reach; p <= reach; p++) {
        m->gradient[reach - p] = density(sigma, (p + 1) * d) - density(sigma, p * d);
        m->integral[reach - p] = interval_integral(sigma, (p - 0.5) * d, (p + 0.5) * d);
    }
}
