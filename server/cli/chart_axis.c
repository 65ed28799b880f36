#include "server/cli/chart_axis.h"

#include <math.h>
#include <stdio.h>

// The step 1, 2 or 5 times a power of ten that gives at most about n_wanted ticks.
static double find_step(double range, int n_wanted)
{
    double rough = range / n_wanted;
    double power = pow(10.0, floor(log10(rough)));
    double factor = rough / power;

    return power * (factor <= 1.0 ? 1.0 : factor <= 2.0 ? 2.0 : factor <= 5.0 ? 5.0 : 10.0);
}

chart_axis chart_axis_make(double low, double high, int n_wanted, chart_axis_ends ends)
{
    double size = fmax(fabs(low), fabs(high));

    // So narrow a range has no digits left to label ticks with, and next to zero none to divide by.
    if (high - low <= 1e-9 * size || high - low < 1e-290) {
        double margin = size < 1e-280 ? 0.5 : 1e-3 * size;
        low -= margin;
        high += margin;
    }
    chart_axis a = { low, high, find_step(high - low, n_wanted), 0.0, 0 };
    if (ends == CHART_AXIS_ON_TICKS) {
        a.low = floor(low / a.step) * a.step;
        a.high = ceil(high / a.step) * a.step;
    }
    // Rounding must not cost the ticks at the ends.
    a.first = ceil(a.low / a.step - 1e-9);
    a.n = (int)floor((a.high - a.first * a.step) / a.step + 1e-9) + 1;
    a.n = a.n > CHART_AXIS_TICKS_MAX ? CHART_AXIS_TICKS_MAX : a.n;
    return a;
}

double chart_axis_tick(const chart_axis *a, int i)
{
    double value = (a->first + i) * a->step;

    return value == 0.0 ? 0.0 : value;
}

int chart_axis_label(const chart_axis *a, int i, char *ret_label)
{
    return snprintf(ret_label, CHART_AXIS_LABEL_SIZE, "%.6g", chart_axis_tick(a, i));
}

int chart_axis_place(const chart_axis *a, double value, int n)
{
    double fraction = (value - a->low) / (a->high - a->low);

    return (int)lround(fmin(fmax(fraction, 0.0), 1.0) * (n - 1));
}
