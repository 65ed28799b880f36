/// Flows of the counters, outlets and sinks of two runs, side by side: lines that let the same through in all may still divide
/// it in another way.

#pragma once

#include "api/json/members.h"
#include "api/results/verdict.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

#include <stddef.h>

enum {
    COMPARE_FLOWS_MAX =
        SCENE_COUNTERS_MAX + SCENE_BELTS_MAX + SCENE_SINKS_MAX, ///< counters, outlets and sinks
    COMPARE_FLOWS_TOLD = 3,                                     ///< that a verdict names
};

/// The flow of a counter, an outlet or a sink.
typedef struct compare_flow {
    const char *of;         ///< "counter", "outlet" or "sink"
    char id[SCENE_ID_SIZE]; ///< of the counter, of the outlet's belt, or of the sink
    double per_h;           ///< parts/h
    double error_per_h;     ///< half width of its interval of 95 %; NAN: there is none
} compare_flow;

/// Those of a run that it could say. Zero-initialise; owns nothing.
typedef struct compare_flows {
    size_t n;                              ///< of items
    compare_flow items[COMPARE_FLOWS_MAX]; ///< counters, outlets, sinks
} compare_flows;

/// The flow of what two runs both have.
typedef struct compare_flow_pair {
    const char *of;   ///< "counter", "outlet" or "sink"
    const char *id;   ///< borrowed
    double a_per_h;   ///< of a, parts/h
    double a_error;   ///< half width of its interval of 95 %, parts/h; NAN: there is none
    double b_per_h;   ///< of b
    double b_error;   ///< same
    double gap_per_h; ///< that of b minus that of a
} compare_flow_pair;

/// Its object; the struct is the one above.
extern const member_table compare_flow_members;

/// Read the flows from the object of a run's key figures (key_figures_write()), parsed; NULL: none is there.
void compare_flows_read(const struct json_t *figures, compare_flows *ret_flows);

/// Find what both have, in the order of a: at most COMPARE_FLOWS_MAX, whose number is returned.
size_t compare_flows_match(const compare_flows *a, const compare_flows *b,
                           compare_flow_pair *ret_pairs);

/// Write what both have as a list.
void compare_flows_write(json_out *w, const compare_flows *a, const compare_flows *b);
