/// Inside core/advice: a scenario's figures are measured (validity_measure.c) and judged by the table (validity.c).

#pragma once

#include "core/advice/validity.h"
#include "core/advice/validity_table.h"
#include "core/advice/validity_text.h"

/// The values of a figure.
typedef struct validity__noted {
    double least;                            ///< of all; NAN: there is none
    double largest;                          ///< the same
    validity_item items[VALIDITY_WAY_COUNT]; ///< the farthest out; without a pointer: there is none
} validity__noted;

/// What was found of a scenario so far; some 200 kB: on the heap.
typedef struct validity__findings {
    validity_subject subject;                       ///< what is compared
    layout layout;                                  ///< of the scenario
    review_warnings falls;                          ///< of places at which cargo gets off the belts
    validity__noted figures[VALIDITY_FIGURE_COUNT]; ///< of each
    bool is_unknown;                                ///< a value is
} validity__findings;

/// The range in which the subject was compared for a figure.
const validity_range *validity__range(const validity__findings *f, validity_figure figure);

/// Compare a value of a figure with its range, and note it; NAN: it is not known. The pointer is that of what has it.
void validity__judge(validity__findings *f, validity_figure figure, double value,
                     const char *pointer);

/// Measure every figure of a resolved and checked scenario but VALIDITY_OVERLAP, and have each judged. BF_ENOMEM.
BF_MUST_CHECK bf_status validity__measure(const scene *s, validity__findings *f, bf_error *err);
