#include "core/base/statistics.h"

#include <float.h>
#include <math.h>

void statistics_add(statistics_sample *s, double value)
{
    const double distance = value - s->mean;

    s->n++;
    s->mean += distance / (double)s->n;
    s->squares += distance * (value - s->mean);
}

double statistics_deviation(const statistics_sample *s)
{
    return s->n < 2 ? (double)NAN : sqrt(s->squares / (double)(s->n - 1));
}

double statistics_half_width(const statistics_sample *s, double confidence)
{
    if (s->n < 2)
        return (double)NAN;
    return statistics_student(0.5 * (1.0 - confidence), (double)(s->n - 1)) *
           statistics_deviation(s) / sqrt((double)s->n);
}

statistics_range statistics_wilson(uint64_t hits, uint64_t n, double confidence)
{
    if (n == 0)
        return (statistics_range){ 0.0, 1.0 };
    const double z = statistics_normal(0.5 * (1.0 - confidence));
    const double all = (double)n, p = (double)hits / all, scale = 1.0 + z * z / all;
    const double centre = (p + 0.5 * z * z / all) / scale;
    const double half = z / scale * sqrt(p * (1.0 - p) / all + 0.25 * z * z / (all * all));
    // Exact at the ends, where the difference would only be near 0.
    return (statistics_range){ hits == 0 ? 0.0 : fmax(centre - half, 0.0),
                               hits == n ? 1.0 : fmin(centre + half, 1.0) };
}

// The continued fraction of the incomplete beta function, DLMF 8.17.22, by Lentz's method; it converges quickly for
// x < (a + 1)/(a + b + 2).
static double beta_fraction(double x, double a, double b)
{
    enum { TERMS_MAX = 10000 };
    const double tiny = DBL_MIN / DBL_EPSILON;
    double c = 1.0, d = 1.0 / (1.0 - (a + b) / (a + 1.0) * x), f = d;

    for (int m = 1; m <= TERMS_MAX; m++) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double change = 0.0;
        for (int k = 0; k < 2; k++) {
            const double term = k == 0 ? even : odd;
            d = 1.0 + term * d;
            d = 1.0 / (fabs(d) < tiny ? tiny : d);
            c = 1.0 + term / c;
            c = fabs(c) < tiny ? tiny : c;
            f *= c * d;
            change = fmax(change, fabs(c * d - 1.0));
        }
        if (change <= DBL_EPSILON)
            break;
    }
    return f;
}

// The regularised incomplete beta function I_x(a, b), for x and y = 1 - x, each to its own rounding.
static double beta_ratio(double x, double y, double a, double b)
{
    int sign;

    if (x <= 0.0 || y <= 0.0)
        return x <= 0.0 ? 0.0 : 1.0;
    const double front = exp(lgamma_r(a + b, &sign) - lgamma_r(a, &sign) - lgamma_r(b, &sign) +
                             a * log(x) + b * log(y));
    if (x < (a + 1.0) / (a + b + 2.0))
        return front * beta_fraction(x, a, b) / a;
    return 1.0 - front * beta_fraction(y, b, a) / b;
}

// P(T > t) = 1/2 I_x(freedom/2, 1/2), x = freedom/(freedom + t^2), t >= 0.
static double student_tail(double t, double freedom)
{
    const double all = freedom + t * t;

    return 0.5 * beta_ratio(freedom / all, t * t / all, 0.5 * freedom, 0.5);
}

static double normal_tail(double z, double unused)
{
    (void)unused;
    return 0.5 * erfc(z * M_SQRT1_2);
}

// The x >= 0 with f(x) = tail for an f that falls from 1/2 to 0, by bisection.
static double invert(double (*f)(double x, double freedom), double tail, double freedom)
{
    double low = 0.0, high = 1.0;

    for (; f(high, freedom) > tail && high < 0x1p500; high *= 2.0)
        low = high;
    while (high - low > 1e-12 * high) {
        const double middle = 0.5 * (low + high);
        if (f(middle, freedom) > tail)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

double statistics_student(double tail, double freedom)
{
    return tail >= 0.5 ? 0.0 : invert(student_tail, tail, freedom);
}

double statistics_normal(double tail)
{
    return tail >= 0.5 ? 0.0 : invert(normal_tail, tail, 0.0);
}
