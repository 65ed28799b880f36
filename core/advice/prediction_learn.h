/// How predictions learn from what runs took: for each kind of solver a recursive least squares fit of the corrections of its
/// costs (prediction.h), which is an extended Kalman filter of
///
///     log measured = log sum_i terms_i exp(correction_i) + noise,
///
/// whose derivative by correction_i is what term i has of the time. At first corrections are normal with mean 0, standard
/// deviation PREDICTION_PRIOR each, and PREDICTION_PRIOR_COMMON of what they have in common; the noise is PREDICTION_NOISE. A
/// measurement that is more than two standard deviations off what is expected counts less: its noise is larger by as much. With each
/// one the corrections are taken to drift a little, so that old runs count less than new ones.
///
/// Source   S. Haykin: Adaptive Filter Theory, 4th ed. (2002), chapters 9 and 14; P. J. Huber: Robust Statistics (1981), chapter 7.

#pragma once

#include "core/advice/prediction.h"

#define PREDICTION_PRIOR        0.3
#define PREDICTION_PRIOR_COMMON 0.2
#define PREDICTION_NOISE        0.15
#define PREDICTION_DRIFT        0.02

/// What is known of the corrections; plain numbers.
typedef struct prediction_learned {
    double covariance[PREDICTION_KIND_COUNT][PREDICTION_TERM_COUNT]
                     [PREDICTION_TERM_COUNT]; ///< see above
    size_t n[PREDICTION_KIND_COUNT];          ///< runs of each kind that were learned from
} prediction_learned;

/// What is known before any run.
void prediction_learn_begin(prediction_learned *ret_learned);

/// A run with that work took so long, s: change the corrections of *speed. Times that are not finite and positive, and work
/// that is predicted to take none, are left out.
void prediction_learn(prediction_learned *learned, const prediction_work *work, double seconds,
                      prediction_speed *speed);
