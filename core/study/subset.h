/// Which of k systems may be the one with the least mean: a subset that contains it with the confidence asked for.
///
/// Of a pair with n common replications, which may share their random numbers, D_r are the differences and S^2 their
/// variance. With b the system of the least mean, i is in the subset if
///
///     mean D_ib <= max(indifference, t(alpha/(k - 1); f) s_ib/sqrt(n)),    alpha = 1 - confidence,
///     s_ib^2 = (f_0 S^2 + (n - 1) S_ib^2)/(f_0 + n - 1),    f = f_0 + n - 1,
///
/// S^2 being the mean of all S_ib^2 with f_0 = min(4, (k - 2)(n - 1)) degrees of freedom: of few replications the variance of one
/// pair is known too badly to drop anything. So the subset is that of Nelson and others by Bonferroni's inequality,
/// but for comparing with b alone, by which it is larger, and for the moderated variance. Without replications, n = 1, a system is
/// in the subset if it is within the indifference.
///
/// Source   S. S. Gupta: On some multiple decision (selection and ranking) rules, Technometrics 7 (1965); B. L. Nelson,
///          J. Swann, D. Goldsman, W. Song: Simple procedures for selecting the best simulated system when the number
///          of alternatives is large, Operations Research 49 (2001), section 2; G. K. Smyth: Linear models and empirical
///          Bayes methods, Stat. Appl. Genet. Mol. Biol. 3 (2004), for the moderated variance.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// What is asked.
typedef struct subset {
    size_t k;            ///< systems, >= 1
    double confidence;   ///< between 0 and 1
    double indifference; ///< >= 0: a difference that does not matter
} subset;

/// What is known of a system. Borrowed.
typedef struct subset_system {
    const double *values; ///< of its replications, finite; those of equal number are paired
    size_t n;             ///< how many there are, >= 1
} subset_system;

/// Fill ret_is_in[k]; the system with the least mean is in it. Its index.
size_t subset_find(const subset *s, const subset_system *systems, bool *ret_is_in);
