/// The front of two objectives (Pareto): the points to none of which another one is better in one objective and not worse in the
/// other, by the means of their trials.
///
/// What does not matter is no difference: both objectives are counted in whole steps above the least, of the indifference, or
/// CHOICE_RELATIVE of the least where none is given, and of CHOICE_RELATIVE of the least second one. Of points that are alike in both
/// one is on the front: that which the choice names, or the first.
///
/// Points that are compared are those of study_choice.h: of STUDY_SCREEN those of the microscopic model as soon as one has a
/// value. What chance leaves open counts as nothing: a point may be on the front, or not, by chance.
///
/// Source   K. Deb: Multi-Objective Optimization Using Evolutionary Algorithms (2001), section 2.4; M. Laumanns, L. Thiele, K. Deb,
///          E. Zitzler: Combining convergence and diversity in evolutionary multiobjective optimization (2002), section 4 (boxes).

#pragma once

#include "core/study/study_choice.h"

/// Fill *ret_is_on, of study_points() points: which of those that the choice compared are on the front of the first and the
/// second value, and how many there are; those without one of the values are not on it. BF_ENOMEM.
BF_MUST_CHECK bf_status study_front(const study *s, const study_choice *choice, bool *ret_is_on,
                                    size_t *ret_n, bf_error *err);
