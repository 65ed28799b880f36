/// Which of k systems has the least mean: the fully sequential procedure of Kim and Nelson with updated variances, which
/// drops systems as soon as they are known to be worse.
///
/// After r >= n_first replications of each, S_il^2 is the variance of all r differences X_i - X_l, and those systems stay
/// whose mean
///
///     mean_i <= mean_l + W_il(r),    W_il(r) = max(0, delta/(2 r) (h^2 S_il^2/delta^2 - r)),    for all l that are left,
///     h^2 = (r - 1) ((alpha/(k - 1))^(-2/(r - 1)) - 1),    alpha = 1 - confidence.
///
/// It ends when one is left, at the latest after the largest h^2 S_il^2/delta^2 replications, with the least mean. With
/// the confidence asked for that one is the best, or its mean is within delta, the indifference, of the best. Replications
/// are independent and nearly normal; those of equal number may share their random numbers, which makes S_il small.
///
/// Source   S.-H. Kim, B. L. Nelson: On the asymptotic validity of fully sequential selection procedures for steady-state
///          simulation, Oper. Res. 54 (2006), with c = 1. Their h^2 has 2 alpha, which gives the confidence where delta is
///          small against the deviation, and 91 to 96 % for 95 % of few replications; alpha gives it there too (94.8 to 100 %
///          of 4,000 selections in each of 15 least favourable cases, of which test_selection.c has a part).

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// What is asked.
typedef struct selection {
    size_t k;            ///< systems, >= 1
    size_t n_first;      ///< replications of each before the first is dropped, >= 2
    double confidence;   ///< between 0 and 1
    double indifference; ///< delta > 0: a difference that does not matter
} selection;

/// What is known: the values of system i are values[i stride + r], r < n. Borrowed.
typedef struct selection_known {
    const double *values; ///< see above
    size_t stride;        ///< from one system to the next
    size_t n;             ///< replications of the systems that are left, >= n_first
} selection_known;

/// Drop systems: is_left[i] becomes false. True when the selection has ended; the one with the least mean of those left
/// is then the answer.
bool selection_drop(const selection *s, const selection_known *known, bool *is_left);
