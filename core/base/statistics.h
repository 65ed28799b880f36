/// Statistics of replications: mean, deviation, and confidence intervals of a mean and of a probability.
///
/// Source   A. M. Law, W. D. Kelton: Simulation Modeling and Analysis, 3rd ed. (2000), section 4.5 (Student's interval);
///          E. B. Wilson: Probable inference, the law of succession, and statistical inference, J. Amer. Statist.
///          Assoc. 22 (1927); B. P. Welford: Note on a method for calculating corrected sums of squares and
///          products, Technometrics 4 (1962).

#pragma once

#include <stdint.h>

/// Values that were added one by one; plain numbers, to be copied. Zero-initialise.
typedef struct statistics_sample {
    uint64_t n;     ///< values
    double mean;    ///< of them
    double squares; ///< sum of the squares of the distances from the mean
} statistics_sample;

/// An interval.
typedef struct statistics_range {
    double low;  ///< lower end
    double high; ///< upper end
} statistics_range;

/// Add a finite value.
void statistics_add(statistics_sample *s, double value);

/// The standard deviation, sqrt(squares/(n - 1)); NAN below two values.
double statistics_deviation(const statistics_sample *s);

/// Half the width of Student's confidence interval of the mean, t(1 - (1 - confidence)/2; n - 1) deviation/sqrt(n), for
/// values that are independent and nearly normal; 0 < confidence < 1. NAN below two values.
double statistics_half_width(const statistics_sample *s, double confidence);

/// Wilson's confidence interval of a probability after `hits` of n trials, within [0, 1]: the p with
/// |hits/n - p| <= z sqrt(p (1 - p)/n), z being the normal quantile of the confidence. [0, 1] for n = 0.
statistics_range statistics_wilson(uint64_t hits, uint64_t n, double confidence);

/// The t beyond which Student's distribution with `freedom` > 0 degrees of freedom has the probability 0 < tail <= 1/2.
/// To 1e-10 of t.
double statistics_student(double tail, double freedom);

/// The z beyond which the normal distribution has the probability 0 < tail <= 1/2. To 1e-10 of z.
double statistics_normal(double tail);
