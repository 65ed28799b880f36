/// Pages of lists of studies, measurements and lines as the services of the API take and return them; api/run_list.h has those
/// of runs.

#pragma once

#include "api/lines.h"
#include "api/measurements.h"
#include "api/studies.h"

#include <stdbool.h>
#include <stddef.h>

/// Which ones a page shows; the newest first, of lines the last used one.
typedef struct api_page_query {
    int state;                  ///< of studies: api_study_state, or -1: any
    char owner[API_OWNER_SIZE]; ///< "": everybody's
    char label[API_LABEL_SIZE]; ///< of measurements; "": any
    char line[API_LABEL_SIZE];  ///< of studies; "": any
    /// Only those older than this id, of a line its newest run's or study's; "": from the newest
    char before[API_ID_SIZE];
    size_t limit; ///< 1 .. API_LIST_MAX
} api_page_query;

/// A page.
typedef struct api_page {
    size_t n;                      ///< items in this page
    bool has_more;                 ///< older ones follow
    char next_cursor[API_ID_SIZE]; ///< of these: api_page_query.before; who answers writes it
    union {
        api_study studies[API_LIST_MAX];            ///< the page, of studies
        api_measurement measurements[API_LIST_MAX]; ///< of measurements
        api_line lines[API_LIST_MAX];               ///< of lines
    };
} api_page;
