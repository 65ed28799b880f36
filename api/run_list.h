/// Which runs a list shows, and in which order.

#pragma once

#include "api/event.h"
#include "api/measurements.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    API_LIST_NEWEST = 50000,    ///< newest runs that a search, another order or a count looks at
    API_LIST_DOCUMENTS = 10000, ///< newest ones whose scenarios a search by conditions reads
    API_LIST_DOCUMENT_BYTES = 64 << 20, ///< of these scenarios and key figures; more are refused
    API_LIST_LOOKS = 20000,             ///< runs that a page in the order of creation looks at
    API_SORT_KEY_SIZE = 81,             ///< bytes of the text of a run's key with its terminator
    API_SORT_FIGURE_SIZE = 48,          ///< same of the name of a key figure, "residence_s.p95"
    API_CURSOR_SIZE = API_ID_SIZE + 2 * API_SORT_KEY_SIZE, ///< same of a cursor
};

/// What a list is sorted by.
typedef enum api_sort_by {
    API_SORT_CREATED,  ///< time of creation
    API_SORT_FINISHED, ///< time of the end
    API_SORT_NAME,     ///< of the scenario, its first 80 bytes, small letters as large ones
    API_SORT_LABEL,    ///< the same of the label
    API_SORT_MODEL,    ///< macroscopic ones first
    API_SORT_STATUS,   ///< in the order of run_state
    API_SORT_FIGURE,   ///< a key figure of the run
} api_sort_by;

/// An order. Runs that have no value come last; among equal ones the newest is first. Zeros: the newest is first.
typedef struct api_sort {
    api_sort_by by;                    ///< see there
    bool is_rising;                    ///< the smallest, oldest, first in the alphabet comes first
    char figure[API_SORT_FIGURE_SIZE]; ///< of API_SORT_FIGURE: its name
} api_sort;

enum {
    API_CONDITIONS_MAX = 4,       ///< conditions of a search
    API_CONDITION_NAME_SIZE = 64, ///< bytes of a name with its terminator
};

/// How the number in the document is to that of the condition; numbers of the same six significant digits are equal.
typedef enum api_relation {
    API_LESS,     ///< <
    API_AT_MOST,  ///< <=
    API_EQUAL,    ///< =
    API_AT_LEAST, ///< >=
    API_GREATER,  ///< >
} api_relation;

/// Conditions on numbers of a scenario or on key figures (api/scenario/condition.h); all of them have to hold.
typedef struct api_conditions {
    size_t n; ///< 0: anything will do
    struct {
        char name[API_CONDITION_NAME_SIZE]; ///< of a member, or the end of its pointer
        api_relation relation;              ///< how the document's number is
        double number;                      ///< to this one; in the document's unit
    } items[API_CONDITIONS_MAX];            ///< in the order of the text
} api_conditions;

/// Which runs.
typedef struct api_list_query {
    int state;                  ///< run_state, or -1: any
    int model;                  ///< run_model, or -1: any
    char owner[API_OWNER_SIZE]; ///< "": everybody's
    char label[API_LABEL_SIZE]; ///< "": any
    char line[API_LABEL_SIZE];  ///< "": any
    char study[API_ID_SIZE];    ///< whose trials; "": only runs that are nobody's trials
    /// What name, label or line contains, A to Z as small letters; "": anything
    char search[API_LABEL_SIZE];
    int64_t from_ms;   ///< accepted at this Unix time or later
    int64_t before_ms; ///< accepted before it; 0: at any time
    bool is_starred;   ///< only starred ones
    /// Only runs of whose scenario or key figures they hold; not of trials
    api_conditions conditions;
    api_sort sort;            ///< the order
    char before[API_ID_SIZE]; ///< only runs behind the one with this id; "": from the first
    char before_key[API_SORT_KEY_SIZE]; ///< its key, "" if it had none; none of API_SORT_CREATED
    size_t limit;                       ///< 1 .. API_LIST_MAX
    bool counts;                        ///< the total is wanted
} api_list_query;
