/// What the methods of studies share: the table of points and trials.

#pragma once

#include "core/study/cmaes.h"
#include "core/study/study.h"

/// What is kept of a point.
typedef struct study_point_record {
    study_model model;  ///< that solves it
    size_t first_trial; ///< SIZE_MAX: none yet
    size_t last_trial;  ///< same
    size_t n_trials;    ///< its trials
    size_t confirmed;   ///< see study_point
    bool is_dropped;    ///< same
} study_point_record;

/// What is kept of a trial; those of a point are a list.
typedef struct study_trial_record {
    study_trial trial; ///< what is told of it
    size_t next;       ///< trial of the same point; SIZE_MAX: it is the last one
} study_trial_record;

/// A study.
struct study {
    study_definition definition;     ///< what it is
    size_t n_points;                 ///< points
    size_t room_points;              ///< for points
    double *at;                      ///< d coordinates of each
    double *costs;                   ///< of each: see study_cost(); filled as a round begins
    study_point_record *points;      ///< of each
    size_t n_trials;                 ///< trials
    size_t room_trials;              ///< for trials
    study_trial_record *trials;      ///< of each
    double *values;                  ///< n_values of each
    size_t n_told;                   ///< trials that were told
    struct calibration *calibration; ///< STUDY_CALIBRATE: its searches
    cmaes evolution;                 ///< STUDY_CMAES: the generation under way
    size_t n_first_stage;            ///< points of the sweep or of DIRECT; 0: it goes on
    bool is_ended;                   ///< nothing more to try
    bool is_decided;                 ///< see study_is_decided()
};

/// Make room for so many more points and trials.
BF_MUST_CHECK bf_status study_reserve(study *s, size_t n_points, size_t n_trials, bf_error *err);

/// Add a point, for which there is room, without trials; its number.
size_t study_add_point(study *s, const double *at, study_model model);

/// Add the next n replications of a point, for which there is room.
void study_add_trials(study *s, size_t point, size_t n);

/// What the searches minimise: the mean objective of a point, negative where more is better, or of STUDY_CALIBRATE the
/// mean of all values; INFINITY where a trial has none.
double study_cost(const study *s, size_t point);

/// How many more points with n trials each fit the limit of trials.
size_t study_points_left(const study *s, size_t n_replications);

/// Points of a sweep; SIZE_MAX where they are too many.
size_t study_sweep_points(const study_definition *definition, study_method sweep);

/// Add the next round of a method; nothing, and is_ended, when there is none.
BF_MUST_CHECK bf_status study_sweep(study *s, study_method sweep, study_model model,
                                    size_t n_replications, bf_error *err);
BF_MUST_CHECK bf_status study_search(study *s, bf_error *err);
BF_MUST_CHECK bf_status study_evolve(study *s, bf_error *err);
BF_MUST_CHECK bf_status study_screen(study *s, bf_error *err);
BF_MUST_CHECK bf_status study_calibrate(study *s, bf_error *err);

/// The point of least cost among the first n >= 1; the first one where several have it.
size_t study_least(const double *costs, size_t n);
