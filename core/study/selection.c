#include "core/study/selection.h"

#include <math.h>

static const double *values_of(const selection_known *known, size_t i)
{
    return known->values + i * known->stride;
}

static double mean_of(const selection_known *known, size_t i)
{
    double sum = 0.0;

    for (size_t r = 0; r < known->n; r++)
        sum += values_of(known, i)[r];
    return sum / (double)known->n;
}

// S_il^2
static double variance_of(const selection_known *known, size_t i, size_t l)
{
    const double *a = values_of(known, i), *b = values_of(known, l);
    const double mean = mean_of(known, i) - mean_of(known, l);
    double squares = 0.0;

    for (size_t r = 0; r < known->n; r++)
        squares += (a[r] - b[r] - mean) * (a[r] - b[r] - mean);
    return squares / (double)(known->n - 1);
}

bool selection_drop(const selection *s, const selection_known *known, bool *is_left)
{
    const double r = (double)known->n, degrees = r - 1.0, delta = s->indifference;
    const double alpha = 1.0 - s->confidence;
    const double h2 =
        s->k < 2 ? 0.0 : degrees * (pow(alpha / (double)(s->k - 1), -2.0 / degrees) - 1.0);
    // The largest number of replications that a pair of those left may need.
    double n_needed = 0.0;
    size_t n_left = 0;

    for (size_t i = 0; i < s->k; i++)
        for (size_t l = i + 1; l < s->k; l++) {
            if (!is_left[i] || !is_left[l])
                continue;
            const double n = h2 * variance_of(known, i, l) / (delta * delta);
            const double width = fmax(0.0, delta / (2.0 * r) * (n - r));
            const double gap = mean_of(known, i) - mean_of(known, l);
            n_needed = fmax(n_needed, n);
            if (gap > width)
                is_left[i] = false;
            else if (-gap > width)
                is_left[l] = false;
        }
    for (size_t i = 0; i < s->k; i++)
        n_left += is_left[i];
    return n_left <= 1 || r > n_needed;
}
