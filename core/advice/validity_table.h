/// The table of the comparisons (validity.h): one row a figure, with its words and the ranges in which each model was
/// compared.

#pragma once

#include "core/advice/validity.h"

/// Where a model was compared, and what happens outside.
typedef struct validity_range {
    double minimum;    ///< -INFINITY: there is none; NAN: such a figure was never compared
    double maximum;    ///< INFINITY: there is none
    const char *below; ///< what to expect of smaller values; NULL: it was not measured
    const char *
        above; ///< what to expect of larger values, or of any if it was never compared; NULL: it was not measured
} validity_range;

/// The text about a figure: "<before> <value><after>; the model was compared with ... for <range><of>".
typedef struct validity_row {
    const char *unit;                              ///< in documents; NULL: none
    const char *before;                            ///< words before the value
    const char *after;                             ///< words after the value
    const char *of;                                ///< words after the numbers of the range
    const char *only;                              ///< instead of the least range; NULL: numbers
    validity_range ranges[VALIDITY_SUBJECT_COUNT]; ///< of each subject
} validity_row;

extern const validity_row validity_table[VALIDITY_FIGURE_COUNT];
