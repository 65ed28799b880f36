#include "core/observe/survival.h"

#include <math.h>

void survival_find(const survival *s, const double *p, size_t n, double *ret_mean,
                   double *ret_quantiles)
{
    const double longest = fmax(s->left->max, s->inside->max);
    double at_risk = s->left->weight + s->inside->weight - s->first->weight;
    double survives = 1.0, area = 0.0;
    size_t known = 0;

    for (size_t k = 0; k < n; k++)
        ret_quantiles[k] = (double)NAN;
    for (size_t bin = 0; bin < quantiles_bins() && quantiles_border(bin) <= longest; bin++) {
        const double from = quantiles_border(bin);
        const double to = fmin(quantiles_border(bin + 1), longest);
        const double left = s->left->bins[bin];
        const double before = survives;
        if (left > 0.0)
            survives *= fmax(0.0, 1.0 - left / fmax(at_risk, left));
        area += (to - from) * (0.5 * (before + survives));
        for (; known < n && survives <= 1.0 - p[known]; known++) {
            const double part = (before - (1.0 - p[known])) / (before - survives);
            ret_quantiles[known] = fmax(s->left->min, from + part * (to - from));
        }
        at_risk += s->first->bins[bin] - left - s->inside->bins[bin];
    }
    *ret_mean = area;
}
