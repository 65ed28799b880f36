/// How well is the throughput of one run known? Batch means with a test of independence, for its confidence interval and
/// for the end `until` = "steady".
///
/// After the warm-up time is cut into batches of equal length: of a plant with a cycle one cycle, else 0.25 s at first.
/// When STEADY_BATCHES_MAX are full, neighbours are merged and the length doubles. For an estimate neighbours are merged
/// further, two by two, to n batches, n >= STEADY_TESTED, until they are independent by a test of their means
/// m_j, with the correlation of successive ones
///
///     r = sum (m_j - m)(m_(j+1) - m) / sum (m_j - m)^2,    |r + 1/n| sqrt(n) <= z(0.9),
///
/// which is von Neumann's ratio but for its ends. Pairs of these make k = n/2 batches, whose remaining correlation is about
/// half as large; with s^2 = sum (m_j - m)^2/(k - 1) of them the half width of the interval of 95 % is
///
///     h = t(0.975; k - 1) s/sqrt(k).
///
/// In the long run as many parts leave as enter, with the same variance. What enters shows its variance at once, what
/// leaves shows that of jams; so h is the larger one of both. And both means must agree:
///
///     |what is inside now - what was inside at the end of the warm-up| / time <= h/4,
///
/// or the warm-up was too short, or the run is. There is no interval
///
///     without chance, and where the plant changes but does not repeat: batches then are no sample;
///     where batches of what leaves have r < 0 at all lengths, or an h that is 1/0.7 of that of what enters: it follows a
///     feed that is regular, and s says too much;
///     where the run is too short for n batches, for independence, or for what is inside. steady_estimate.needs
///     then is the time after the warm-up that will be enough, if correlations fall as those of an AR(1) process
///     and h with the root of time.
///
/// Where jams are rarer than the time of the run, nothing in the run tells of them.
///
/// Tested when n = 32, 40, ..., 64, 80, ... batches are full, by quarters of an octave, the throughput m is steady if
/// h <= precision m, for which r < 0 is no obstacle; without chance, if the later half of 16 or more batches are within
/// precision m of m.
///
/// Source   A. Tafazzoli, N. M. Steiger, J. R. Wilson: N-Skart: a nonsequential skewness- and autoregression-adjusted
///          batch-means procedure, IEEE Trans. Automatic Control 56 (2011), for spaced tests before wider batches;
///          J. von Neumann, Ann. Math. Statist. 12 (1941); C. Alexopoulos, A. F. Seila: Output data analysis, in
///          J. Banks (ed.), Handbook of Simulation (1998).
/// Units    s, parts, parts/s.

#pragma once

#include "core/scene/regime.h"

#include <stdint.h>

enum { STEADY_BATCHES_MAX = 512, STEADY_TESTED = 32 };

/// What the batches say.
typedef struct steady_estimate {
    double mean;       ///< m of what left, parts/s; NAN: there is no batch
    double half_width; ///< of the confidence interval, parts/s; NAN: there is none
    double needs;      ///< for want of time: how much is needed after the warm-up, s; else NAN
} steady_estimate;

/// A flow; plain numbers.
typedef struct steady_flow {
    double start_level;               ///< parts until the start of the batch that is not full
    double level;                     ///< of the last sample
    double means[STEADY_BATCHES_MAX]; ///< of the full batches, parts/s
} steady_flow;

/// The batches; plain numbers without padding, to be copied, saved and restored. Begin with steady_from().
typedef struct steady {
    double precision;     ///< half width of the interval relative to the mean, at most
    uint64_t has_chance;  ///< see scene_regime
    uint64_t is_constant; ///< same
    double length;        ///< of a batch, s
    double t_start;       ///< end of the warm-up, s
    double inside;        ///< parts inside then
    double start;         ///< of the batch that is not full, s
    double t;             ///< last sample, s
    steady_flow in;       ///< what entered
    steady_flow out;      ///< what left
    uint64_t n;           ///< full batches, fewer than STEADY_BATCHES_MAX
    double reached_at;    ///< the first test that found it steady; NAN: none yet, s
} steady;

/// Parts that had entered and left until a time.
typedef struct steady_levels {
    double t;       ///< s
    double entered; ///< parts, with those of the start
    double left;    ///< of them
} steady_levels;

/// Begin at the end of the warm-up.
steady steady_from(const scene_regime *regime, double precision, const steady_levels *at);

/// Add a sample, not before the last one. Between samples flows are constant.
void steady_sample(steady *s, const steady_levels *at);

/// The estimate of all full batches.
steady_estimate steady_estimate_of(const steady *s);
