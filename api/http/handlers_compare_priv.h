/// Private to handlers_compare*.c: what is compared.

#pragma once

#include "api/http/routes.h"
#include "api/json/json_out.h"
#include "api/services.h"
#include "core/compare/compare.h"

enum { HANDLERS_COMPARE__MAX = 8 }; ///< runs and measurements that are compared at once

/// A run or a measurement.
typedef struct handlers_compare__entry {
    char id[API_ID_SIZE];        ///< as the query has it
    char pointer[32];            ///< where: "/a", "/runs/2"
    bool is_run;                 ///< which of the two is filled:
    api_run run;                 ///< of a run
    api_measurement measurement; ///< of a measurement
    bf_buffer columns;           ///< of its curve
    compare_figures figures;     ///< of its curve
    compare_measures measures;   ///< against the reference, which is a; not filled of itself
} handlers_compare__entry;

/// Write how far the densities of two entries are apart, as a value: null unless both are runs, else
/// {"same_grid", "n_common", "mean", "snapshots"}. At most about n_cells_max cells are compared, but
/// one snapshot in any case; two of them are held at a time.
BF_MUST_CHECK bf_status handlers_compare__density(exchange *x, json_out *w,
                                                  const handlers_compare__entry *a,
                                                  const handlers_compare__entry *b,
                                                  size_t n_cells_max, bf_error *err);
