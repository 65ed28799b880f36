/// Studies: which trials a study makes, by rounds. Each round is a list of trials that may be run at the same time and in
/// any order; the next round depends on what all trials before it said and on nothing else. So a study that is cut and
/// resumed makes the same trials, with the same numbers.
///
///     study_create()
///     while study_advance() adds trials:  run those that have not been told, study_tell() each
///     study_best()
///
/// A point is a place in the unit cube and a model; it has one trial for each replication, at substreams 0, 1, ...,
/// which are common to all points.
///
///     STUDY_GRID, STUDY_LIST, STUDY_LHS, STUDY_SOBOL    all points in one round
///     STUDY_DIRECT    the first half of the trials by DIRECT, then subplex from the best point
///     STUDY_CMAES     each generation is a round
///     STUDY_SCREEN    a sweep by the macroscopic model, then replications of its best points by the microscopic one
///                     until one is selected (selection.h)
///     STUDY_CALIBRATE one value for each measured curve, the mean square of its distance from the computed one: see
///                     calibration.h
///
/// Threads  a study belongs to one thread at a time.

#pragma once

#include "core/base/statistics.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STUDY_PARAMETERS = 20,     ///< most parameters
    STUDY_VALUES = 32,         ///< most values of a trial
    STUDY_TRIALS_MAX = 100000, ///< most trials
    STUDY_SEARCH_MAX = 2000,   ///< most points of STUDY_DIRECT, whose time grows with their square
};

/// How points are chosen.
typedef enum study_method {
    STUDY_GRID,
    STUDY_LIST,
    STUDY_LHS,
    STUDY_SOBOL,
    STUDY_DIRECT,
    STUDY_CMAES,
    STUDY_SCREEN,
    STUDY_CALIBRATE,
    STUDY_METHODS
} study_method;

/// The model of a trial.
typedef enum study_model {
    STUDY_AS_SUBMITTED, ///< that of the study's base
    STUDY_MACRO,
    STUDY_MICRO
} study_model;

/// What a study is.
typedef struct study_definition {
    study_method method; ///< see above
    size_t d;            ///< parameters; 0 with STUDY_LIST alone: one point, which is repeated
    size_t n_values;     ///< of each trial; the first one is the objective, see STUDY_CALIBRATE
    bool is_maximized;   ///< the largest objective is best; else the least
    bool is_second_maximized; ///< same of the second value, which decides between equal points
    bool has_demand;          ///< the least first coordinate is best at which the objective is at
                              ///< least the demand, see study_choice.h; is_maximized then
    double demand;            ///< see there
    bool
        has_chance; ///< runs of a point at other substreams may differ, but for the macroscopic model
    uint64_t seed;       ///< of what is drawn
    size_t n_trials_max; ///< trials, at most
    size_t
        n_replications; ///< trials of each point; STUDY_SCREEN: at first, of each confirmed one. 1
                        ///< without chance
    study_method sweep; ///< STUDY_SCREEN: its sweep
    size_t steps[STUDY_PARAMETERS]; ///< STUDY_GRID: values of each parameter
    size_t n_points;      ///< STUDY_LIST, STUDY_LHS, STUDY_SOBOL: points; STUDY_CALIBRATE: starts
    double tolerance;     ///< of all searches: length in the cube below which they end
    size_t n_confirmed;   ///< STUDY_SCREEN: points for the microscopic model
    double confidence;    ///< of the set of best points, of a selection, of profiles
    double indifference;  ///< in units of the objective; NAN: see study_choice.h. STUDY_SCREEN: > 0
    double n_independent; ///< STUDY_CALIBRATE: independent samples of all curves, see calibration.h
} study_definition;

/// A trial.
typedef struct study_trial {
    size_t point;       ///< its number
    uint32_t substream; ///< of the replication, from 0
    bool is_told;       ///< it has ended
} study_trial;

/// A point.
typedef struct study_point {
    const double *at;   ///< d coordinates in the unit cube; borrowed until the next study_advance()
    study_model model;  ///< that solves it
    size_t first_trial; ///< the number of its first trial; the others may have any
    size_t n_trials;    ///< its trials
    size_t confirmed;   ///< STUDY_SCREEN: point of the sweep that it confirms; else SIZE_MAX
    bool is_dropped;    ///< STUDY_SCREEN: the selection has dropped it
} study_point;

/// A study; opaque, on the heap.
typedef struct study study;

/// The trials that a study has at least: those of its sweep, of STUDY_CALIBRATE those of its starts, of STUDY_CMAES those of a
/// generation, else one point;
/// SIZE_MAX where they are more than fit.
size_t study_first_trials(const study_definition *definition);

/// Begin a study. The caller owns *ret_study: study_destroy(). BF_ELIMIT: its sweep has more trials than it may have, or
/// more than STUDY_TRIALS_MAX. BF_ENOMEM.
BF_MUST_CHECK bf_status study_create(const study_definition *definition, study **ret_study,
                                     bf_error *err);

/// Free a study. NULL is fine. Always returns NULL.
study *study_destroy(study *s);

/// Add the trials of the next round; all before it must have been told. No trial is added when the study has ended.
/// BF_ENOMEM: the study is as it was.
BF_MUST_CHECK bf_status study_advance(study *s, bf_error *err);

/// Tell the n_values values of a trial; NAN: the run could not say, or failed. A trial is told once.
void study_tell(study *s, size_t trial, const double *values);

/// Trials and points so far.
size_t study_trials(const study *s);
size_t study_points(const study *s);

/// A trial, and a point, by its number.
study_trial study_trial_at(const study *s, size_t trial);
study_point study_point_at(const study *s, size_t point);

/// The values of a trial; borrowed until the next study_advance(). NAN before it is told.
const double *study_values(const study *s, size_t trial);

/// The replications of a point, as far as they have that value.
statistics_sample study_sample(const study *s, size_t point, size_t value);

/// The point with the best mean of the objective of those whose trials all have one; of STUDY_SCREEN of those of the
/// microscopic model as soon as one has it. SIZE_MAX: there is none. What a study answers is study_choice.h.
size_t study_best(const study *s);

/// True once study_advance() found that there is nothing more to try.
bool study_is_ended(const study *s);

/// STUDY_SCREEN: true if the selection ended by itself, with its confidence, and not for want of trials.
bool study_is_decided(const study *s);
