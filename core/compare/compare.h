/// Measures of the difference of outflow curves, and of densities on the same grid.
///
/// Curve       Between samples it is linear; where two curves have different times, both are read
///             on the union of their times within the common interval. Integrals are exact for such
///             lines.
/// Throughput  On an interval from t0 to t1, with U the curve and what left |U(t1) - U(t0)|,
///
///                 0.8 |U(t1) - U(t0)| / (t90 - t10),   parts/s,
///
///             t10 and t90 being the first times at which the curve has gone 10 % and 90 % of the
///             way from U(t0) to U(t1): the ramp at the start and the slow tail at the end are excluded.
/// Contents    U of a place that cargo enters while it leaves is no outflow: compare_figures_of_content().
/// Gaps        of figures are b minus a.

#pragma once

#include "core/base/grid.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/// A curve: parts at rising times. Borrowed.
typedef struct compare_curve {
    size_t n;            ///< samples, >= 1
    const double *t;     ///< times, strictly rising, s
    const double *parts; ///< U(t)
} compare_curve;

/// Figures of one curve over all its samples.
typedef struct compare_figures {
    double t_start;     ///< first time, s
    double t_end;       ///< last time, s
    double parts_start; ///< first value
    double parts_end;   ///< last value
    double
        drain_time; ///< first t at which it is <= 1 % of its first value; NAN: never, or it rises, s
    double t10;     ///< see above; NAN: nothing left, s
    double t90;     ///< see above; NAN: nothing left, s
    double throughput; ///< see above; NAN: nothing left, parts/s
} compare_figures;

/// Measures between two curves a and b.
typedef struct compare_measures {
    double t_start;    ///< start of the common interval, s
    double t_end;      ///< its end, s
    double l1;         ///< mean |a - b| over the common interval, parts
    double l2;         ///< root of the mean of (a - b)^2, parts
    double largest;    ///< largest |a - b|, parts
    double largest_at; ///< first time at which it is reached, s
    double
        drain_time_a; ///< first t at which a <= 1 % of its first value; NAN: never, or it rises, s
    double drain_time_b; ///< same of b
    double drain_gap;    ///< drain_time_b - drain_time_a, s; NAN where one is
    double
        rate_a; ///< mean outflow (first - last)/duration over the common interval, parts/s; NAN: a content
    double rate_b;         ///< same of b
    double throughput_a;   ///< over the common interval, parts/s; NAN: nothing left
    double throughput_b;   ///< same of b
    double throughput_gap; ///< throughput_b - throughput_a, parts/s; NAN where one is
} compare_measures;

/// The figures of a curve. BF_EINPUT: it is empty, has times that do not rise, or values that are not
/// finite.
BF_MUST_CHECK bf_status compare_figures_of(const compare_curve *curve, compare_figures *ret_figures,
                                           bf_error *err);

/// Compare two curves. BF_EINPUT: one is empty, has times that do not rise, values that are not
/// finite, or they have no common interval; err->pointer is "/a" or "/b".
BF_MUST_CHECK bf_status compare_curves(const compare_curve *a, const compare_curve *b,
                                       compare_measures *ret_measures, bf_error *err);

/// Take away what a curve does not have that is a content: drain_time, t10, t90 and throughput become NAN.
void compare_figures_of_content(compare_figures *figures);

/// The same of measures: the drain time, rate and throughput of those of a and b that are contents, and the gaps of them.
void compare_measures_of_content(compare_measures *measures, bool is_a, bool is_b);

/// The difference of two densities.
typedef struct compare_distance {
    double mean_abs; ///< mean |a - b| over the cells
    double l1; ///< sum |a - b| / sum (|a| + |b|): 0 the same, 1 nothing in common; NAN: both empty
    double emd_x; ///< earth mover's distance of the marginals along x, m; NAN: one has no mass
    double emd_y; ///< same along y
} compare_distance;

/// Compare two densities on the same grid, cell (i, j) at j * n1 + i.
///
/// The earth mover's distance is the integral of |F_a - F_b| along an axis, F the fraction of the mass
/// up to there, with the density constant within a cell: the mean distance by which the cargo of the one would have to
/// be moved along this axis to have the distribution of the other. Each density is normalised by its own mass,
/// so that unequal masses have no effect on it; l1 measures them. BF_ENOMEM.
BF_MUST_CHECK bf_status compare_densities(const bf_grid *grid, const float *a, const float *b,
                                          compare_distance *ret_distance, bf_error *err);

/// True if two grids have the same cells, but for rounding of their places. Densities on others are not
/// compared.
bool compare_is_same_grid(const bf_grid *a, const bf_grid *b);

/// Rising times, s, that are members of the items of an array. Borrowed.
typedef struct compare_times {
    size_t n;          ///< times
    const void *first; ///< the first one, a double
    size_t stride;     ///< bytes from one to the next
} compare_times;

/// Move *i and *k on to the next times of a and b that are the same but for rounding. False: there are
/// none.
bool compare_next_common(const compare_times *a, const compare_times *b, size_t *i, size_t *k);

/// How many times both have.
size_t compare_count_common(const compare_times *a, const compare_times *b);

/// The mean of distances, each member over those distances where it is known. Zero-initialise.
typedef struct compare_mean {
    compare_distance sum; ///< of the members that are finite
    size_t n_mean_abs;    ///< how many these are
    size_t n_l1;          ///< same
    size_t n_emd_x;       ///< same
    size_t n_emd_y;       ///< same
} compare_mean;

/// Add a distance to a mean.
void compare_mean_add(compare_mean *mean, const compare_distance *d);

/// The mean of what was added; members that were never known are NAN.
compare_distance compare_mean_of(const compare_mean *mean);
