/// Scenes that a model was compared on, one by one: which of them are like another scene, and how far off the model was.
///
/// The table, comparisons_table.c, is written by tests/validation/table.py from the fed lines that were solved by both
/// models (lines.py; the closure congested) and from the goods that were solved with contacts 100 times as hard (goods.py;
/// the microscopic model). A row has the figures of a scene (validity.h) and the relative error of its rate.
///
/// A scene is like another one if each figure of comparisons_columns either is absent from both or differs by at most
/// its tolerance. Lengths among them are in diameters of parts: pills before a plate may be like drums.

#pragma once

#include "core/advice/validity.h"

/// When two values of a figure are alike.
typedef enum comparison_rule {
    COMPARISON_DIFFERENCE, ///< they differ by at most the tolerance
    COMPARISON_RATIO,      ///< the larger one is at most the tolerance times the smaller one
} comparison_rule;

/// A figure by which scenes are compared.
typedef struct comparison_column {
    validity_figure figure; ///< see there
    bool is_least;          ///< the smallest value that the scene has of it, not the largest
    comparison_rule rule;   ///< see there
    double tolerance;       ///< unit of the figure, or 1 or more of a ratio
} comparison_column;

enum { COMPARISON_COLUMNS = 30 };

extern const comparison_column comparisons_columns[COMPARISON_COLUMNS];

/// A scene of the table.
typedef struct comparison_row {
    validity_subject subject; ///< what was compared
    double error;             ///< rate of the subject / that of what it was compared with, less 1
    double values[COMPARISON_COLUMNS]; ///< NAN: the scene has no such figure
} comparison_row;

extern const comparison_row comparisons_table[];
extern const size_t comparisons_table_n;

/// What the rows for a subject say of a scene with these values, NAN where it has none.
void comparisons_find(validity_subject subject, const double values[COMPARISON_COLUMNS],
                      validity_like *ret_like);
