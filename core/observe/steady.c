#include "core/observe/steady.h"

#include "core/base/statistics.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const double first_length = 0.25; // s

// Deviations that are below this part of the mean are rounding, which is not correlated with anything.
static const double rounding = 1e-9;

// The normal quantile of 0.9: of independent batches a fifth fails the test at one length.
static const double independence = 1.2816;

// Of the half width of what leaves: that of what enters is at least so much, or batches of what leaves are too short.
static const double least_of_both = 0.7;

// Of the half width: by how much the means of what enters and leaves may differ.
static const double agreement = 0.25;

static const double confidence_tail = 0.025;

steady steady_from(const scene_regime *regime, double precision, const steady_levels *at)
{
    const double cycle = regime->cycle;
    const double length = cycle > 0.0 ? cycle * ceil(first_length / cycle) : first_length;

    return (steady){ .precision = precision,
                     .has_chance = regime->has_chance,
                     .is_constant = regime->is_constant,
                     .length = length,
                     .t_start = at->t,
                     .inside = at->entered - at->left,
                     .start = at->t,
                     .t = at->t,
                     .in = { .start_level = at->entered, .level = at->entered },
                     .out = { .start_level = at->left, .level = at->left },
                     .reached_at = (double)NAN };
}

// ---- batches of one flow

// Merge neighbours; their number.
static size_t merge(double *means, size_t n)
{
    for (size_t k = 0; k < n / 2; k++)
        means[k] = 0.5 * (means[2 * k] + means[2 * k + 1]);
    return n / 2;
}

static double mean_of(const double *means, size_t n)
{
    double sum = 0.0;

    for (size_t k = 0; k < n; k++)
        sum += means[k];
    return sum / (double)n;
}

// The sum of squares about the mean; 0 where all are equal but for rounding.
static double squares_of(const double *means, size_t n)
{
    const double mean = mean_of(means, n);
    double squares = 0.0;

    for (size_t k = 0; k < n; k++)
        squares += (means[k] - mean) * (means[k] - mean);
    return squares <= (double)n * (rounding * mean) * (rounding * mean) ? 0.0 : squares;
}

static double correlation_of(const double *means, size_t n)
{
    const double mean = mean_of(means, n), squares = squares_of(means, n);
    double products = 0.0;

    for (size_t k = 0; k + 1 < n; k++)
        products += (means[k] - mean) * (means[k + 1] - mean);
    return squares > 0.0 ? products / squares : 0.0;
}

static double half_width_of(const double *means, size_t n)
{
    const double k = (double)n;

    return statistics_student(confidence_tail, k - 1.0) *
           sqrt(squares_of(means, n) / (k - 1.0) / k);
}

// What one flow says, by its shortest batches that are independent.
typedef struct flow_estimate {
    double independent; // their half width; NAN: there are none
    double
        half_width; // same; NAN: r is too large. Where r is too negative at all lengths: too wide
    double needs;   // where r is too large: batches that will be enough
} flow_estimate;

// How many times longer batches of an AR(1) process are to be so that the test passes, their correlation being r now:
// that of c merged ones is r (1 - r^c)^2/(c (1 - r^2) - 2 r (1 - r^c)).
static double factor_of(double r)
{
    const double wanted = independence / sqrt((double)STEADY_TESTED) - 1.0 / STEADY_TESTED;
    const double most = 1048576.0;
    double factor = 1.0;

    for (double now = r; now > wanted && factor < most;) {
        factor *= 2.0;
        const double power = pow(r, factor), rest = 1.0 - power;
        now = r * rest * rest / (factor * (1.0 - r * r) - 2.0 * r * rest);
    }
    return factor;
}

static flow_estimate flow_estimate_of(const steady_flow *flow, size_t n)
{
    double means[STEADY_BATCHES_MAX];
    flow_estimate e = { (double)NAN, (double)NAN, STEADY_TESTED };

    memcpy(means, flow->means, n * sizeof *means);
    for (double length = 1.0; n >= STEADY_TESTED && isnan(e.independent); length *= 2.0) {
        const double r = correlation_of(means, n), count = (double)n;
        const double score = squares_of(means, n) > 0.0 ? (r + 1.0 / count) * sqrt(count) : 0.0;
        n = merge(means, n);
        const bool is_passed = score <= independence;
        e.half_width = is_passed ? half_width_of(means, n) : (double)NAN;
        e.independent = is_passed && score >= -independence ? e.half_width : (double)NAN;
        e.needs = is_passed ? (double)NAN : STEADY_TESTED * length * factor_of(r);
    }
    return e;
}

// ---- both flows

// What is said of a run with chance: first what is missing.
static steady_estimate estimate_of_chance(const steady *s, bool is_strict)
{
    const flow_estimate in = flow_estimate_of(&s->in, s->n), out = flow_estimate_of(&s->out, s->n);
    const double inside = (s->in.level - s->out.level) - s->inside;
    const double difference = fabs(inside) / (s->t - s->t_start);
    steady_estimate e = { mean_of(s->out.means, s->n), (double)NAN, (double)NAN };

    if (isnan(in.half_width) || isnan(out.half_width)) {
        e.needs = s->length * fmax(isnan(in.half_width) ? in.needs : 0.0,
                                   isnan(out.half_width) ? out.needs : 0.0);
        return e;
    }
    const double half_width = fmax(in.half_width, is_strict ? out.independent : out.half_width);
    const double bound = is_strict ? half_width : fmax(half_width, s->precision * e.mean);
    if (is_strict && (isnan(out.independent) || !(half_width > 0.0) ||
                      in.half_width < least_of_both * out.independent))
        return e;
    if (difference > agreement * bound) {
        // Time until h, which falls with its root, is large enough against what is inside more than at the start.
        const double ratio = difference / (agreement * half_width);
        e.needs = ratio * ratio * (s->t - s->t_start);
    } else {
        e.half_width = half_width;
    }
    return e;
}

steady_estimate steady_estimate_of(const steady *s)
{
    if (s->has_chance && s->is_constant && s->n > 0)
        return estimate_of_chance(s, true);
    return (steady_estimate){ s->n > 0 ? mean_of(s->out.means, s->n) : (double)NAN, (double)NAN,
                              (double)NAN };
}

// ---- the end "steady"

// Without chance: the later half of the batches are near the mean of all.
static bool is_still(const steady *s)
{
    const double mean = mean_of(s->out.means, s->n);
    double means[STEADY_BATCHES_MAX];
    size_t n = s->n;

    memcpy(means, s->out.means, n * sizeof *means);
    while (n >= STEADY_TESTED)
        n = merge(means, n);
    for (size_t k = n / 2; k < n; k++)
        if (!(fabs(means[k] - mean) <= s->precision * mean))
            return false;
    return mean > 0.0;
}

static bool is_known(const steady *s)
{
    if (!s->has_chance || !s->is_constant)
        return is_still(s);
    const steady_estimate e = estimate_of_chance(s, false);
    return e.mean > 0.0 && e.half_width <= s->precision * e.mean;
}

// Quarters of an octave: 32, 40, 48, 56, 64, 80, ...
static bool is_time_to_test(size_t n)
{
    size_t octave = STEADY_TESTED;

    while (2 * octave <= n)
        octave *= 2;
    return n >= STEADY_TESTED && n % (octave / 4) == 0;
}

static void take_batch(steady_flow *flow, size_t k, double length, double level)
{
    flow->means[k] = (level - flow->start_level) / length;
    flow->start_level = level;
}

void steady_sample(steady *s, const steady_levels *at)
{
    const double entered = s->in.level, left = s->out.level;

    for (double end = s->start + s->length; end <= at->t; end = s->start + s->length) {
        const double part = (end - s->t) / (at->t - s->t);
        take_batch(&s->in, s->n, s->length, entered + (at->entered - entered) * part);
        take_batch(&s->out, s->n, s->length, left + (at->left - left) * part);
        s->n++;
        s->start = end;
        if (isnan(s->reached_at) && is_time_to_test(s->n) && is_known(s))
            s->reached_at = end;
        if (s->n == STEADY_BATCHES_MAX) {
            merge(s->in.means, s->n);
            s->n = merge(s->out.means, s->n);
            s->length *= 2.0;
        }
    }
    s->t = at->t;
    s->in.level = at->entered;
    s->out.level = at->left;
}
