/// When a belt is stopped by its failures and breaks, whatever its schedule and commands tell it.
///
///     down       from the beginning of a failure until its repair ends
///     break      from start + k every on, for its duration, k = 0, 1, ...
///     operating  told to run (towards a factor that is not 0), not down and in no break
///
/// The time to the next drawn failure of a kind is operating time since its last repair, or since t = 0; so a belt that
/// stands, whatever for, does not fail. **Choice**: that is what planning systems count by default, and what wears a drive; it
/// gives an availability of MTBF/(MTBF + MTTR) of the time in which the belt is to run. Repairs take their time in breaks
/// too. Listed failures begin at their times whatever the belt does.
///
/// Failures that are due at once begin one after the other, each when the one before it is repaired: the earlier one in the
/// list is first.
///
/// Draws    of failure n, from 0, of a kind: core/base/draws.h, from the kind's id, the scene's substream and n.
/// Bits     follow from the scene and from when commands came, not from steps or threads.
/// Units    SI.

#pragma once

#include "core/scene/types.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// What stops a belt at a time; flags. Failure k of a belt is 1 << k.
enum {
    BELT_STOPS_BREAK = 1 << SCENE_FAILURES_MAX, ///< a break
    BELT_STOPS_FAILED = BELT_STOPS_BREAK - 1    ///< all failures
};

/// What stops a belt, in a word; a failure in a break is a failure. The values stand in frames.
typedef enum belt_stops_cause {
    BELT_STOPS_BY_NOTHING,
    BELT_STOPS_BY_FAILURE,
    BELT_STOPS_BY_BREAK,
    BELT_STOPS_BY_MERGE, ///< it is a lane that waits; not among what belt_stops_cause_of() knows
    BELT_STOPS_CAUSE_COUNT
} belt_stops_cause;

/// Of a kind of failure.
typedef struct belt_stops_failure {
    uint64_t n;   ///< failures that have begun
    double left;  ///< drawn: operating time until the next one, s
    double until; ///< while it is down: when that ends, s; INFINITY: it is not
} belt_stops_failure;

/// How far the stops of a belt have come: plain numbers, saved as they are.
typedef struct belt_stops_state {
    double t;                                        ///< s
    belt_stops_failure failures[SCENE_FAILURES_MAX]; ///< see there
    uint64_t n_borders[SCENE_BREAKS_MAX]; ///< of each entry of the breaks: begins and ends up to t
} belt_stops_state;

/// The state at t = 0, with what begins there.
belt_stops_state belt_stops_start(const scene_stops *stops);

/// What stops the belt in a state: BELT_STOPS_... and failures; 0: nothing.
unsigned belt_stops_now(const scene_stops *stops, const belt_stops_state *state);

/// The word for it.
belt_stops_cause belt_stops_cause_of(unsigned now);

/// Go on, with a belt that is told to run or to stand, to the next time at which something begins or ends, but to `until`, s, at
/// most, >= state->t.
void belt_stops_go_on(const scene_stops *stops, bool runs, double until, belt_stops_state *state);

/// Room for the times at which anything begins or ends in [0, stops->until], which are no more than those of a belt that
/// always runs.
size_t belt_stops_count(const scene_stops *stops);
