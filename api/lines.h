/// Lines: what runs and studies of an owner belong to by their members `line`.

#pragma once

#include "api/measurements.h"

#include <stdint.h>

/// A line: it is there as long as a run or a study belongs to it.
typedef struct api_line {
    char line[API_LABEL_SIZE];    ///< what it is called
    char owner[API_OWNER_SIZE];   ///< whose it is; "": nobody's
    uint64_t n_versions;          ///< the greatest version of its runs
    uint64_t n_runs;              ///< without trials
    uint64_t n_studies;           ///< see there
    char newest_run[API_ID_SIZE]; ///< its newest run; "": it has none
    char newest[API_ID_SIZE];     ///< its newest run or study
    int64_t used_ms;              ///< when that was accepted, Unix time, ms
} api_line;
