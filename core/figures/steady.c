#include "core/figures/steady.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

static const double first_length = 1.0; // s

// Deviations that are below this part of the mean are rounding, which is not correlated with anything.
static const double rounding = 1e-9;

// Student's t(0.975; n - 1) for n = 20, 25, ..., 40.
static const double student[] = { 2.0930240544, 2.0638985616, 2.0452296421, 2.0322445093,
                                  2.0226909117 };

_Static_assert(sizeof student / sizeof *student ==
                   (STEADY_BATCHES_MAX - STEADY_BATCHES_MIN) / STEADY_BATCHES_A_TEST + 1,
               "a quantile for each test");

steady steady_from(double precision, double t, double exited)
{
    return (steady){ .precision = precision,
                     .start = t,
                     .start_level = exited,
                     .length = first_length,
                     .t = t,
                     .level = exited,
                     .estimate = { (double)NAN, (double)NAN, (double)NAN },
                     .reached_at = (double)NAN };
}

static steady_estimate estimate_of(const steady *s)
{
    const double n = (double)s->n;
    double sum = 0.0, squares = 0.0, products = 0.0;

    for (size_t k = 0; k < s->n; k++)
        sum += s->means[k];
    const double mean = sum / n;
    for (size_t k = 0; k < s->n; k++) {
        const double deviation = s->means[k] - mean;
        squares += deviation * deviation;
        products += k + 1 < s->n ? deviation * (s->means[k + 1] - mean) : 0.0;
    }
    const double quantile = student[(s->n - STEADY_BATCHES_MIN) / STEADY_BATCHES_A_TEST];
    const bool are_equal = squares <= n * (rounding * mean) * (rounding * mean);
    return (steady_estimate){ .mean = mean,
                              .half_width = quantile * sqrt(squares / (n - 1.0) / n),
                              .correlation = are_equal ? 0.0 : products / squares };
}

static void test(steady *s, double t)
{
    s->estimate = estimate_of(s);
    if (isnan(s->reached_at) && s->estimate.mean > 0.0 &&
        s->estimate.half_width <= s->precision * s->estimate.mean &&
        s->estimate.correlation <= STEADY_CORRELATION_MAX)
        s->reached_at = t;
}

static void merge(steady *s)
{
    s->n /= 2;
    s->length *= 2.0;
    for (size_t k = 0; k < s->n; k++)
        s->means[k] = 0.5 * (s->means[2 * k] + s->means[2 * k + 1]);
}

static void close_batch(steady *s, double end, double level)
{
    s->means[s->n++] = (level - s->start_level) / s->length;
    s->start = end;
    s->start_level = level;
    if (s->n >= STEADY_BATCHES_MIN && s->n % STEADY_BATCHES_A_TEST == 0)
        test(s, end);
    if (s->n == STEADY_BATCHES_MAX)
        merge(s);
}

void steady_sample(steady *s, double t, double exited)
{
    for (double end = s->start + s->length; end <= t; end = s->start + s->length) {
        const double part = (end - s->t) / (t - s->t);
        close_batch(s, end, s->level + (exited - s->level) * part);
    }
    s->t = t;
    s->level = exited;
}
