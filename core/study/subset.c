#include "core/study/subset.h"

#include "core/base/statistics.h"

#include <math.h>

static const double prior_freedom = 4.0; // f_0, at most

static double mean_of(const subset_system *a)
{
    double sum = 0.0;

    for (size_t r = 0; r < a->n; r++)
        sum += a->values[r];
    return sum / (double)a->n;
}

static statistics_sample differences_of(const subset_system *a, const subset_system *b)
{
    statistics_sample sample = { 0 };

    for (size_t r = 0; r < a->n && r < b->n; r++)
        statistics_add(&sample, a->values[r] - b->values[r]);
    return sample;
}

static double variance_of(const statistics_sample *d)
{
    return d->n < 2 ? 0.0 : d->squares / (double)(d->n - 1);
}

// How far a mean may be above the least one by chance, all variances having the mean `common`.
static double width_of(const subset *s, const statistics_sample *d, double common)
{
    const double freedom = (double)(d->n - 1);
    const double prior = fmin(prior_freedom, (double)(s->k - 2) * freedom);
    const double variance = (prior * common + freedom * variance_of(d)) / (prior + freedom);
    const double tail = (1.0 - s->confidence) / (double)(s->k - 1);

    return statistics_student(tail, prior + freedom) * sqrt(variance / (double)d->n);
}

size_t subset_find(const subset *s, const subset_system *systems, bool *ret_is_in)
{
    double common = 0.0;
    size_t best = 0, n_pairs = 0;

    for (size_t i = 1; i < s->k; i++)
        if (mean_of(&systems[i]) < mean_of(&systems[best]))
            best = i;
    for (size_t i = 0; i < s->k; i++) {
        const statistics_sample d = differences_of(&systems[i], &systems[best]);
        common += i == best ? 0.0 : variance_of(&d);
        n_pairs += i != best && d.n >= 2;
    }
    common = n_pairs > 0 ? common / (double)n_pairs : 0.0;
    for (size_t i = 0; i < s->k; i++) {
        const statistics_sample d = differences_of(&systems[i], &systems[best]);
        const double width = i == best || d.n < 2 ? 0.0 : width_of(s, &d, common);
        ret_is_in[i] = i == best || d.mean <= fmax(s->indifference, width);
    }
    return best;
}
