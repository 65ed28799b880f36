/// Valid ranges of numbers: one definition that checks enforce and documents state.

#pragma once

#include "core/base/faults.h"

#include <stdbool.h>

/// Which numbers are in range.
typedef struct bf_range {
    double minimum;    ///< smallest, -INFINITY: any
    double maximum;    ///< largest, INFINITY: any
    bool excludes_min; ///< minimum itself is out of range
    bool excludes_max; ///< maximum itself is out of range
    double
        guard; ///< numbers of larger size are refused, too, so that later arithmetic is safe; far
               ///< from any sensible value, so documents do not state it; 0: none
} bf_range;

/// Note a fault at pointer if the value is out of range or no number.
void range_check(const bf_range *range, double value, const char *pointer, bf_faults *faults);
