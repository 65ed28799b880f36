/// The distribution of a quantity x >= 0 at bounded memory: mean, extremes, quantiles.
///
/// Weights are summed in bins whose borders are the doubles with a mantissa of 8 bits: 256 bins for each power of
/// two from 2^-14 (6.1e-5) to 2^22 (4.2e6), so that a bin is at most 2^-8 = 0.4 % of its values wide. What is less
/// counts in one bin from 0 on, what is more in the last bin. This is the histogram of HdrHistogram
/// (G. Tene), with the exponent and the first bits of a double as the number of the bin; no logarithm is taken.
///
/// The quantile p is the value below which p of the weight lies, with the weight of a bin uniform over it, and never
/// outside the smallest and the largest value: so it is off by less than 0.4 % of itself. Mean and extremes are exact.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/// The distribution. Begin with quantiles_init().
typedef struct quantiles {
    double weight; ///< of all values
    double sum;    ///< of values times their weights
    double min;    ///< smallest value; INFINITY: none
    double max;    ///< largest value
    double *bins;  ///< weight in each
} quantiles;

/// Make an empty distribution. The caller owns it: quantiles_fini(). BF_ENOMEM: *ret_q is empty and to be left alone.
BF_MUST_CHECK bf_status quantiles_init(quantiles *ret_q, bf_error *err);

/// Free what *q owns and zero it.
void quantiles_fini(quantiles *q);

/// Add a value >= 0 with a weight.
void quantiles_add(quantiles *q, double x, double weight);

/// Add a weight that is spread uniformly over the values from a to b, 0 <= a, 0 <= b.
void quantiles_add_uniform(quantiles *q, double a, double b, double weight);

/// The mean; NAN: empty.
double quantiles_mean(const quantiles *q);

/// The quantile p, 0 < p < 1; NAN: empty.
double quantiles_at(const quantiles *q, double p);

/// The number of bins, and where each begins; the border behind the last one is where it ends.
size_t quantiles_bins(void);
double quantiles_border(size_t bin);

/// Make it empty again.
void quantiles_clear(quantiles *q);

/// Take the values of another one.
void quantiles_copy(quantiles *to, const quantiles *from);

/// Append the distribution to a checkpoint, and take one from it. False: damaged; *q then is as it may be, and
/// only to be freed.
void quantiles_save(const quantiles *q, checkpoint_writer *w);
BF_MUST_CHECK bool quantiles_load(quantiles *q, checkpoint_reader *r);
