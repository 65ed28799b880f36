/// What a study answers: the points that may be best, and which of them it names.
///
///     1  The set has the points that may be best by the objective, within the indifference and what chance leaves open
///        (subset.h). Of STUDY_SCREEN they are those of the microscopic model as soon as one has a value.
///     2  Of the set those stay whose second value is not worse than the best by more than CHOICE_RELATIVE of it, or than half of
///        its interval of 95 %.
///     3  Of these the one is named that is nearest to their mean in the unit cube; of several the first.
///
/// With a demand the set has the points that meet it, each with its lower limit of the mean of n replications by Student's
/// distribution with the confidence asked for, divided by Bonferroni's inequality among the k points that are compared:
///
///     mean - t((1 - confidence)/k; n - 1) s/sqrt(n) >= demand,
///
/// s = 0 without chance; and of it the one with the least first coordinate is named, of several the one with the largest mean.
/// Where none meets it, the set is empty and the one with the largest mean is named.
///
/// Where parts arrive by chance and a point has one replication, nothing is known of what chance does: then the set is not known, and the
/// point with the best value is named. So it is where the method searches, and points are not spread over the range.

#pragma once

#include "core/study/study.h"

/// Of a value: a difference that does not matter where none is given.
#define CHOICE_RELATIVE 0.005

/// The answer.
typedef struct study_choice {
    size_t best;         ///< the point named; SIZE_MAX: there is none
    bool is_known;       ///< the set is
    bool is_met;         ///< the demand, by the point that is named, as far as is known
    size_t n_set;        ///< its points
    size_t first, end;   ///< they are compared with points from this one to before that one
    size_t n_candidates; ///< of which so many have a value
    double indifference; ///< that was taken, in units of the objective
} study_choice;

/// Choose. *ret_is_in has room for study_points(): which of them are in the set; none where it is not known. BF_ENOMEM.
BF_MUST_CHECK bf_status study_choose(const study *s, bool *ret_is_in, study_choice *ret_choice,
                                     bf_error *err);

/// True if runs of a point at other substreams may differ.
bool study_has_chance(const study *s, size_t point);
