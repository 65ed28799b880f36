/// Lines: what runs and studies of an owner belong to by their members `line`.

#pragma once

#include "api/measurements.h"

#include <stdbool.h>
#include <stddef.h>
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

/// Which lines a list shows; the last used one first.
typedef struct api_line_query {
    char owner[API_OWNER_SIZE]; ///< "": everybody's
    char before
        [API_ID_SIZE]; ///< only those whose newest run or study is older than this id; "": from the first
    size_t limit; ///< 1 .. API_LIST_MAX
} api_line_query;

/// A page of lines.
typedef struct api_line_list {
    size_t n;                      ///< lines in this page
    bool has_more;                 ///< lines used earlier follow
    char next_cursor[API_ID_SIZE]; ///< of these: who answers writes it
    api_line items[API_LIST_MAX];  ///< the page
} api_line_list;
