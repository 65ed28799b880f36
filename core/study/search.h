/// Searches for the least value of a function on the unit cube by NLopt, as a question of what to evaluate next.
///
///     SEARCH_GLOBAL   DIRECT with a local bias (GN_DIRECT_L): divides the cube into boxes
///     SEARCH_LOCAL    subplex with bounds (LN_SBPLX): simplices in subspaces, from a start; bears some noise
///
/// NLopt calls the function itself and cannot be left in the middle. Its algorithms draw no random numbers, so each
/// question starts it anew, answers what is known, and stops it where it asks for a point that is not. Points to evaluate
/// at the same time are those that two such runs both ask for, in which unknown values are very small in the one
/// and very large in the other; few of them turn out to be in vain. So the points of a search depend on the values and
/// n_room alone, and an interrupted one goes on from its list of points. The time of all questions grows with the
/// square of the points, some 0.1 us each.
///
/// Source   S. G. Johnson, The NLopt nonlinear-optimization package; J. M. Gablonsky, C. T. Kelley, A locally-biased form
///          of the DIRECT algorithm, J. Global Optimization 21 (2001); T. H. Rowan, Functional stability analysis of
///          numerical algorithms, thesis, Univ. of Texas at Austin (1990).
/// Threads  any; there is no state between calls.

#pragma once

#include "core/base/status.h"

#include <stddef.h>

/// The algorithm.
typedef enum search_algorithm { SEARCH_GLOBAL, SEARCH_LOCAL } search_algorithm;

/// A search.
typedef struct search {
    search_algorithm algorithm; ///< see above
    size_t d;                   ///< parameters, >= 1
    size_t n_max;               ///< points that are evaluated, at most
    const double *start;        ///< SEARCH_LOCAL: where it begins
    double step;                ///< SEARCH_LOCAL: first length along each parameter
    double tolerance; ///< SEARCH_LOCAL: it ends when points move by less along each parameter
} search;

/// What was evaluated: by this search, and perhaps other points, which are not evaluated again. Borrowed.
typedef struct search_known {
    size_t n;             ///< points
    const double *points; ///< d coordinates each
    const double *values; ///< INFINITY: the point has none
} search_known;

/// Fill *ret_points, room for n_room, with the points to evaluate next, which are not known; *ret_n is 0 when the search
/// has ended. n_begun of the known points count for n_max. BF_ENOMEM.
BF_MUST_CHECK bf_status search_next(const search *s, const search_known *known, size_t n_begun,
                                    size_t n_room, double *ret_points, size_t *ret_n,
                                    bf_error *err);
