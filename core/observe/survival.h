/// The distribution of a time of which not all are known to their end, after Kaplan and Meier.
///
/// Of parts that left, the whole time in the domain is known; of those that are inside, that it is longer than their age; and those
/// that were inside when the counting began are known of from the age on that they had then. With the bins of quantiles.h, d_b
/// that left at times in bin b and R_b that were looked at and inside when it begins,
///
///     S_b = S_(b-1) (1 - d_b/R_b),    R_b = all that came later + sum_(j<b) (those of age j at first - d_j - those inside of age j),
///
/// the quantile p is where S falls to 1 - p, linear within a bin, and not known where it does not; the mean is the area
/// below S until the longest time that was seen, which is less than the mean where S is not 0 there.
///
/// Source   E. L. Kaplan, P. Meier: Nonparametric estimation from incomplete observations, J. Amer. Statist. Assoc. 53 (1958); J. P.
///          Klein, M. L. Moeschberger: Survival Analysis, 2nd ed. (2003), section 4.6, for those that are seen from an age on.

#pragma once

#include "core/observe/quantiles.h"

#include <stddef.h>

/// What is known; all borrowed.
typedef struct survival {
    const quantiles *left;   ///< times of those that left; of at least one
    const quantiles *inside; ///< ages of those inside at the end
    const quantiles *first;  ///< ages of those that were inside when the counting began
} survival;

/// The mean, and the n quantiles of rising p; NAN: not known.
void survival_find(const survival *s, const double *p, size_t n, double *ret_mean,
                   double *ret_quantiles);
