/// Comparisons as JSON, for the resource and the command line alike. NAN is written as null.

#pragma once

#include "api/json/members.h"
#include "core/compare/compare.h"

#include <stdint.h>

/// The figures of a curve (compare_figures), which stand among the members of what it is of.
extern const member_table compare_json_figures;

/// The measures between two curves (compare_measures).
extern const member_table compare_json_measures;

/// The distance of two densities (compare_distance).
extern const member_table compare_json_distance;

/// A run or a measurement that is compared.
typedef struct compare_json_entry {
    const char *id;          ///< of the run or the measurement
    const char *kind;        ///< "run" or "measurement"
    const char *label;       ///< the client's
    const char *name;        ///< of the scenario; NULL: it was measured
    const char *model;       ///< word of the solver; NULL: it was measured
    const char *status;      ///< word of the run's state; NULL: it was measured
    const char *column;      ///< of its curve that is compared
    compare_figures figures; ///< of that column
} compare_json_entry;

/// Its object; the struct is the one above.
extern const member_table compare_json_compared;

/// The distance of two densities at a common time.
typedef struct compare_json_snapshots {
    double t;                  ///< the common time, s
    uint64_t a;                ///< number of a's snapshot
    uint64_t b;                ///< number of b's snapshot
    double mass_a;             ///< parts in the domain of a
    double mass_b;             ///< parts in the domain of b
    compare_distance distance; ///< of the two
} compare_json_snapshots;

/// Its object; the struct is the one above.
extern const member_table compare_json_density_distance;
