/// Private parts of the log (log.c, log_journal.c) and of the metrics (metrics.c counts, metrics_text.c writes).

#pragma once

#include "api/http/problem.h"
#include "api/run_state.h"
#include "api/services.h"
#include "server/base/log.h"
#include "server/base/metrics.h"

#include <stdatomic.h>
#include <stdbool.h>

// log.c and log_journal.c

/// True if descriptor fd is the stream that JOURNAL_STREAM ("device:inode"; NULL: none) names.
bool log__is_journal(int fd, const char *stream);

/// Send an event to the journal: text is its line from `event=` on. False: the journal does not take
/// it.
bool log__send(log_level level, const char *text);

// metrics.c and metrics_text.c

enum {
    METRICS_ROUTES_MAX = 96, ///< routes of the API and the two words beside them
    METRICS_BOUNDS = 11,     ///< bounds of a histogram
    METRICS_DIMENSIONS = 3,  ///< labels of a metric at most
};

/// Methods and status codes that are counted apart; the last of each stands for all others. Codes are those of
/// answers and of all problems.
#define METRICS_METHODS                                                 "GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "other"
#define METRICS_CODE(status, word, title, headers, codes, when, remedy) #status,
#define METRICS_CODES                                                   "200", "201", "202", "204", "206", "304", PROBLEM_LIST(METRICS_CODE) "other"

enum {
    METRICS__N_METHODS = sizeof(const char *[]){ METRICS_METHODS } / sizeof(const char *),
    METRICS__N_CODES = sizeof(const char *[]){ METRICS_CODES } / sizeof(const char *),
};

/// Labels of metrics, X(symbol, label, how many values).
#define METRICS_DIMENSION_LIST(X)                                                                  \
    X(METRICS__BY_ROUTE, "route", METRICS_ROUTES_MAX)                                              \
    X(METRICS__BY_METHOD, "method", METRICS__N_METHODS)                                            \
    X(METRICS__BY_CODE, "code", METRICS__N_CODES)                                                  \
    X(METRICS__BY_STATE, "state", RUN_STATE_COUNT)                                                 \
    X(METRICS__BY_MODEL, "model", RUN_MODEL_COUNT)                                                 \
    X(METRICS__BY_FRAME, "kind", API_EVENT_TYPE_COUNT)                                             \
    X(METRICS__BY_REASON, "reason", METRICS_EXIT_COUNT)                                            \
    X(METRICS__BY_LAYER, "layer", METRICS_LAYER_COUNT)                                             \
    X(METRICS__BY_QUOTA, "quota", METRICS_QUOTA_COUNT)                                             \
    X(METRICS__BY_PLACE, "place", METRICS_PLACE_COUNT)                                             \
    X(METRICS__BY_TASK, "state", METRICS_TASK_COUNT)                                               \
    X(METRICS__BY_MATCH, "match", METRICS_MATCH_COUNT)                                             \
    X(METRICS__BY_LEVEL, "level", LOG_LEVEL_COUNT)                                                 \
    X(METRICS__BY_VERSION, "version", 1)                                                           \
    X(METRICS__BY_COMPILER, "compiler", 1)

/// The dimensions.
typedef enum metrics__dimension {
#define X(dimension, label, n) dimension,
    METRICS_DIMENSION_LIST(X)
#undef X
        METRICS__BY_NOTHING
} metrics__dimension;

/// How many values each has.
enum {
#define X(dimension, label, n) dimension##_N = n,
    METRICS_DIMENSION_LIST(X)
#undef X
        METRICS__BY_NOTHING_N = 1
};

/// Sets of labels, X(symbol, up to three dimensions).
#define METRICS_LABELS_LIST(X)                                                                     \
    X(NONE, NOTHING, NOTHING, NOTHING)                                                             \
    X(EXCHANGE, ROUTE, METHOD, CODE)                                                               \
    X(ROUTE, ROUTE, METHOD, NOTHING)                                                               \
    X(STATE, STATE, NOTHING, NOTHING)                                                              \
    X(MODEL, MODEL, NOTHING, NOTHING)                                                              \
    X(FRAME, FRAME, NOTHING, NOTHING)                                                              \
    X(REASON, REASON, NOTHING, NOTHING)                                                            \
    X(LAYER, LAYER, NOTHING, NOTHING)                                                              \
    X(QUOTA, QUOTA, NOTHING, NOTHING)                                                              \
    X(PLACE, PLACE, NOTHING, NOTHING)                                                              \
    X(TASK, TASK, NOTHING, NOTHING)                                                                \
    X(MATCH, MATCH, NOTHING, NOTHING)                                                              \
    X(LEVEL, LEVEL, NOTHING, NOTHING)                                                              \
    X(BUILD, VERSION, COMPILER, NOTHING)

/// How many series each has.
enum {
#define X(labels, a, b, c)                                                                         \
    METRICS__SERIES_##labels = METRICS__BY_##a##_N * METRICS__BY_##b##_N * METRICS__BY_##c##_N,
    METRICS_LABELS_LIST(X)
#undef X
};

/// Types, X(symbol, word of the text form, slots of a series). A histogram has a slot for each bound,
/// one beyond them, and its sum.
#define METRICS_TYPE_LIST(X)                                                                       \
    X(COUNTER, "counter", 1)                                                                       \
    X(GAUGE, "gauge", 1)                                                                           \
    X(TIMES, "histogram", METRICS_BOUNDS + 2)                                                      \
    X(SIZES, "histogram", METRICS_BOUNDS + 2)

/// The types.
typedef enum metrics__type {
#define X(type, word, n_slots) METRICS__##type,
    METRICS_TYPE_LIST(X)
#undef X
} metrics__type;

/// A row of the table as the code needs it.
typedef struct metrics__metric {
    const char *name;                                  ///< in the text form
    const char *unit;                                  ///< "" none
    const char *help;                                  ///< one line
    metrics__type type;                                ///< kind
    metrics__dimension dimensions[METRICS_DIMENSIONS]; ///< of its labels
    size_t n_series;                                   ///< combinations of its labels' values
    size_t n_slots;                                    ///< of a series
    _Atomic int64_t *slots;                            ///< of all series
} metrics__metric;

/// The table, METRICS_COUNT rows.
extern const metrics__metric metrics__table[];

/// The word of a type in the text form.
const char *metrics__type_word(metrics__type type);

/// The bounds of a histogram, rising; METRICS_BOUNDS values.
const int64_t *metrics__bounds(metrics__type type);

/// Label of a dimension and how many values it has.
const char *metrics__label(metrics__dimension dimension);
size_t metrics__size(metrics__dimension dimension);

/// The word of one of its values; NULL: it does not occur.
const char *metrics__word(metrics__dimension dimension, size_t value);
