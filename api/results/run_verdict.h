/// What a run says, in sentences (api/results/verdict.h).
///
///     bridged             of the density: parts bridge the opening, so that none of the throughputs below is told
///     everything_through  all that is offered gets through, with the rate
///     queue_at_inlet      parts wait at a feed since the queue comes up to it: the throughput is what the line takes
///     inlet_limit         parts wait at a feed though no queue comes up to it: its line does not take what is offered
///     queue_grows         less gets through than is offered, and most of the rest is on the belt: the run is too short to say what the line takes
///     belt_fills          the same, where the warm-up is shorter than twice as long as parts stay: the belt was still filling
///     throughput          what gets through, where none of these is so
///     drained             without feeds: since when the belt has been empty, and how fast parts came through
///     not_drained         without feeds: what is left on the belt
///     bridges             of parts: nothing left for some time while parts stood before a plate
///     pauses              nothing left for some time, for other reasons
///     stalled             cargo stopped plates that were told to move
///     too_short           parts arrive by chance and the run is too short to say how far chance moved its throughput
///     not_compared        the model was never compared with experiments or the other model for lines like this one

#pragma once

#include "api/results/verdict.h"
#include "core/advice/advice.h"
#include "core/observe/figure.h"

/// The kind of belt_fills, on which too_early rests (compare_verdict.h).
#define RUN_VERDICT_BELT_FILLS "belt_fills"

/// What is looked at; all borrowed.
typedef struct run_verdict_subject {
    const scene *scene;   ///< resolved
    const advice *advice; ///< of it, with the model
    const frame_end *end; ///< of the run
    const double *values; ///< key figures, figure_values() of the scene; NULL: there are none
} run_verdict_subject;

/// Add the verdicts about a run. BF_ENOMEM.
BF_MUST_CHECK bf_status run_verdict_find(const run_verdict_subject *of, verdicts *ret_verdicts,
                                         bf_error *err);
