/// The key figures of a run: one table of their words, units and definitions, and where their values stand.
///
/// A run has the values of all figures of the table as doubles in one array: those of the run, then those of its first
/// feed, of its second feed, and so on, then of its counters, of its photo eyes, of its belts whose speeds change, of their
/// failures, of its outlets and of its sinks, each in the order of the table. NAN: the run cannot say; never 0 instead.
///
/// Every figure but offered, admitted, discarded, entered, left, taken, throughput_needs_s, flow_needs_s, outflow_needs_s, taken_needs_s,
/// steady_at_s and drained_at_s leaves out what was before the first sample at or after the scenario's warmup_s, the warm-up.
/// Samples are those of the curve.

#pragma once

#include "core/scene/scene.h"

#include <stddef.h>

/// What a figure is of.
typedef enum figure_scope {
    FIGURE_OF_RUN,     ///< the whole run
    FIGURE_OF_FEED,    ///< each feed
    FIGURE_OF_COUNTER, ///< each counter
    FIGURE_OF_EYE,     ///< each photo eye
    FIGURE_OF_BELT,    ///< each belt that belt_range_may_change()
    FIGURE_OF_FAILURE, ///< each kind of failure, in the order of their belts
    FIGURE_OF_OUTLET, ///< with feeds, each belt that cargo leaves the domain from, where there are several, or sinks
    FIGURE_OF_SINK, ///< each sink
    FIGURE_SCOPES
} figure_scope;

/// The figures, sorted by scope. Figures that stand in one JSON object are neighbours.
typedef enum figure_id {
    FIGURE_THROUGHPUT,
    FIGURE_THROUGHPUT_ERROR,
    FIGURE_THROUGHPUT_NEEDS,
    FIGURE_STEADY_AT,
    FIGURE_SUSTAINED,
    FIGURE_RESIDENCE_MEAN,
    FIGURE_RESIDENCE_P50,
    FIGURE_RESIDENCE_P90,
    FIGURE_RESIDENCE_P95,
    FIGURE_RESIDENCE_P99,
    FIGURE_JAM_COUNT,
    FIGURE_JAM_FIRST,
    FIGURE_JAM_TOTAL,
    FIGURE_STALL_COUNT,
    FIGURE_STALL_FIRST,
    FIGURE_STALL_TOTAL,
    FIGURE_QUEUE_END,
    FIGURE_PEAK,
    FIGURE_DRAINED_AT,
    FIGURE_ENTERED,
    FIGURE_LEFT,
    FIGURE_OFFERED, ///< the first one of a feed
    FIGURE_ADMITTED,
    FIGURE_DISCARDED,
    FIGURE_WAITING_MAX,
    FIGURE_WAIT_MEAN,
    FIGURE_WAIT_P95,
    FIGURE_WAIT_MAX,
    FIGURE_CONTENT_MEAN, ///< the first one of a counter
    FIGURE_CONTENT_MAX,
    FIGURE_STATE_FREE,
    FIGURE_STATE_QUEUED,
    FIGURE_STATE_BLOCKED,
    FIGURE_FLOW,
    FIGURE_FLOW_ERROR,
    FIGURE_FLOW_NEEDS,
    FIGURE_GAP_MIN, ///< the first one of a photo eye
    FIGURE_GAP_P05,
    FIGURE_GAP_MEAN,
    FIGURE_DOUBLES,
    FIGURE_BLOCKED_COUNT,
    FIGURE_BLOCKED_TOTAL,
    FIGURE_BLOCKED_LONGEST,
    FIGURE_STOPPED_COUNT, ///< the first one of a belt
    FIGURE_STOPPED_TOTAL,
    FIGURE_STOPPED_LONGEST,
    FIGURE_AVAILABILITY,
    FIGURE_FAILED_COUNT, ///< the first one of a kind of failure
    FIGURE_FAILED_TOTAL,
    FIGURE_OUTFLOW, ///< the first one of an outlet
    FIGURE_OUTFLOW_ERROR,
    FIGURE_OUTFLOW_NEEDS,
    FIGURE_TAKEN, ///< the first one of a sink
    FIGURE_SINK_FLOW,
    FIGURE_SINK_FLOW_ERROR,
    FIGURE_SINK_FLOW_NEEDS,
    FIGURE_COUNT
} figure_id;

/// Models that have a figure; flags.
enum {
    FIGURE_BY_DENSITY = 1,
    FIGURE_BY_PARTS = 2,
    FIGURE_BY_BOTH = 3,
    FIGURE_BY_FED_DENSITY = 4, ///< the density where there are feeds
    FIGURE_BY_BOTH_FED = 6
};

/// A key figure.
typedef struct figure {
    const char *word;       ///< the JSON member
    const char *part;       ///< the member within it; NULL: it is a number itself
    const char *unit;       ///< NULL: none
    const char *definition; ///< one sentence
    figure_scope scope;     ///< what it is of
    unsigned models;        ///< that have it, FIGURE_BY_...
} figure;

/// The table.
extern const figure figure_table[FIGURE_COUNT];

/// The first figure of a scope; of FIGURE_SCOPES, FIGURE_COUNT.
figure_id figure_first(figure_scope scope);

/// What there is of a scope in a scene: 1, its feeds, counters, photo eyes, belts that belt_range_may_change(), kinds of
/// failures, outlets, or sinks.
size_t figure_items(const scene *s, figure_scope scope);

/// Which belt of the scene the k-th one of FIGURE_OF_BELT, or of FIGURE_OF_OUTLET, is.
size_t figure_belt(const scene *s, figure_scope scope, size_t k);

/// Which outlet a belt, or the belt of a section, is; figure_items() of FIGURE_OF_OUTLET or more: none.
size_t figure_outlet(const scene *s, size_t belt);

/// Which belt of the scene the k-th kind of failure is of, and which of its failures it is.
size_t figure_failure(const scene *s, size_t k, size_t *ret_failure);

/// Id of an item of a scope: that of the feed, the counter, the photo eye, the belt (of an outlet, too), the failure or the
/// sink; "" of the run.
const char *figure_item_id(const scene *s, figure_scope scope, size_t item);

/// Values of all figures of a scene.
size_t figure_values(const scene *s);

/// Where the value of a figure of an item, below figure_items(), stands among them.
size_t figure_at(const scene *s, figure_id id, size_t item);
