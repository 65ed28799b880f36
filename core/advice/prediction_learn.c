#include "core/advice/prediction_learn.h"

#include <math.h>
#include <string.h>

enum { N = PREDICTION_TERM_COUNT };

static const double far = 2.0; // standard deviations

void prediction_learn_begin(prediction_learned *ret_learned)
{
    memset(ret_learned, 0, sizeof *ret_learned);
    for (size_t kind = 0; kind < PREDICTION_KIND_COUNT; kind++)
        for (size_t i = 0; i < N; i++)
            for (size_t j = 0; j < N; j++)
                ret_learned->covariance[kind][i][j] =
                    PREDICTION_PRIOR_COMMON * PREDICTION_PRIOR_COMMON +
                    (i == j ? PREDICTION_PRIOR * PREDICTION_PRIOR : 0.0);
}

void prediction_learn(prediction_learned *learned, const prediction_work *work, double seconds,
                      prediction_speed *speed)
{
    double(*p)[N] = learned->covariance[work->kind];
    const double predicted = prediction_seconds(work, speed);
    double slope[N], gain[N], expected = 0.0;

    if (!(isfinite(seconds) && seconds > 0.0 && predicted > 0.0))
        return;
    prediction_seconds_of_terms(work, speed, slope);
    for (size_t i = 0; i < N; i++)
        slope[i] /= predicted;
    for (size_t i = 0; i < N; i++)
        p[i][i] += PREDICTION_DRIFT * PREDICTION_DRIFT;
    for (size_t i = 0; i < N; i++) {
        gain[i] = 0.0;
        for (size_t j = 0; j < N; j++)
            gain[i] += p[i][j] * slope[j];
        expected += slope[i] * gain[i];
    }
    const double off = log(seconds / predicted);
    const double noise = PREDICTION_NOISE * PREDICTION_NOISE;
    const double times = fabs(off) / sqrt(expected + noise) / far;
    const double variance = expected + noise * fmax(1.0, times * times);
    for (size_t i = 0; i < N; i++)
        speed->corrections[work->kind][i] += gain[i] / variance * off;
    for (size_t i = 0; i < N; i++)
        for (size_t j = 0; j < N; j++)
            p[i][j] -= gain[i] * gain[j] / variance;
    learned->n[work->kind]++;
}
