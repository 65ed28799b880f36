#include "core/base/range.h"

#include <math.h>

void range_check(const bf_range *range, double value, const char *pointer, bf_faults *faults)
{
    double maximum = range->guard > 0.0 ? range->guard : range->maximum;
    double minimum = range->guard > 0.0 ? fmax(range->minimum, -range->guard) : range->minimum;
    bool is_low = range->excludes_min ? !(value > minimum) : !(value >= minimum);
    bool is_high = range->excludes_max ? !(value < maximum) : !(value <= maximum);

    if (!is_low && !is_high)
        return;
    faults_add(faults, pointer, "must be %s %g and %s %g, not %g",
               range->excludes_min ? "above" : "at least", minimum,
               range->excludes_max ? "below" : "at most", maximum, value);
    faults_set_limit(faults, value, is_low ? minimum : maximum);
}
