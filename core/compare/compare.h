/// How far two outflow curves are apart.
///
/// Between samples a curve is linear; where two curves have different times, both are read on the
/// union of their times within the common interval. Integrals are exact for such lines.

#pragma once

#include "core/base/status.h"

#include <stddef.h>

/// A curve: parts at rising times. Borrowed.
typedef struct compare_curve {
    size_t n;            ///< samples, >= 1
    const double *t;     ///< times, strictly rising, s
    const double *parts; ///< U(t)
} compare_curve;

/// Measures between two curves a and b.
typedef struct compare_measures {
    double t_start;      ///< start of the common interval, s
    double t_end;        ///< its end, s
    double l1;           ///< mean |a - b| over the common interval, parts
    double l2;           ///< root of the mean of (a - b)^2, parts
    double largest;      ///< largest |a - b|, parts
    double largest_at;   ///< first time at which it is reached, s
    double drain_time_a; ///< first t at which a <= 1 % of its first value; NAN: never, s
    double drain_time_b; ///< same of b
    double rate_a;       ///< mean outflow (first - last)/duration over the common interval, parts/s
    double rate_b;       ///< same of b
} compare_measures;

/// Compare two curves. BF_EINPUT: one is empty, has times that do not rise, values that are not
/// finite, or they have no common interval; err->pointer is "/a" or "/b".
BF_MUST_CHECK bf_status compare_curves(const compare_curve *a, const compare_curve *b,
                                       compare_measures *ret_measures, bf_error *err);
