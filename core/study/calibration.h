/// Calibration: the parameters with which computed curves come nearest to measured ones, and how sure they are.
///
/// The cost of a point is the mean over the curves of mse_j, the mean square of the distance of the computed curve j from
/// the measured one, parts^2. Four stages:
///
///     1  n_points of Sobol's sequence
///     2  subplex from the best CALIBRATION_STARTS of them, at the same time; the best point of all is the answer
///     3  each curve left out in turn: subplex from the answer over the others; the distance of the curve that was left
///        out then says how well the model predicts what it was not fitted to. Only with two curves or more
///     4  the profile of each parameter: at CALIBRATION_PLACES places on either side of the answer, up to the ends of its
///        range, it is held, and the others are fitted anew. A better point that this finds becomes the answer, and the stage
///        begins again
///
/// With n independent samples in all curves, independent and normal errors, a value of a parameter agrees with the
/// measurement as well as the answer does where
///
///     n ln((cost + v)/(near cost + v)) <= z^2,    v = 1/12 parts^2,
///
/// z being the normal quantile of the confidence and v the variance of rounding to whole parts. The near cost is the mean
/// of those of the answer and of two points next to it along each parameter, CALIBRATION_NEAR of the range away: curves
/// of models jump a little with their parameters, and the answer of a search is the luckiest of many points. Between the places the root
/// of the left side is taken as linear. Any other point that was tried and agrees lies within, too: where a model has chance in
/// it, a place of the profile may be far off by chance while a point behind it is as near as the answer. Where these values reach an end of the range the parameter is not identifiable.
/// Samples of a curve are not independent: n is to be much less than their number.
///
/// Source   A. Raue et al.: Structural and practical identifiability analysis of partially observed dynamical models by
///          exploiting the profile likelihood, Bioinformatics 25 (2009).

#pragma once

#include "core/study/study.h"

enum {
    CALIBRATION_STARTS = 3, ///< of the second stage
    CALIBRATION_PLACES = 3, ///< on each side: 1/8, 1/2 and all of the way to the end of the range
};

#define CALIBRATION_NEAR 0.002 ///< of the range

/// What the profile of a parameter says.
typedef struct calibration_profile {
    double low;           ///< least value in the cube that agrees; 0: it reaches the end
    double high;          ///< largest one; 1: it reaches the end
    bool is_identifiable; ///< neither reaches the end
} calibration_profile;

/// The profile of a parameter of a study that has ended and has a best point. A place whose fit ran out of trials, while
/// the later half of them still made the root smaller by a tenth, counts as one that agrees.
calibration_profile calibration_profile_of(const study *s, size_t parameter);

/// The best point of those that are nearest to all curves but one; SIZE_MAX if there was no third stage for it. Its value
/// of that curve says how well it is predicted.
size_t calibration_without(const study *s, size_t curve);
