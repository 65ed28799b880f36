/// When the parts of a feed arrive, and what they are.
///
/// Both models are fed by one cumulative arrival function: Lambda(t), parts until the time t. It is the
/// integral of the feed's rate from its start to its end, or, of a list, the step function of its counts between the
/// two, both inclusive. The density's demand in a step is what Lambda grows by, at most `count` parts in all (part by part: density_entry.h). Of the
/// parts, k = 1, 2, ..., each arrives where Lambda reaches
///
///     regular   k - 1/2
///     poisson   the sum of k exponential variates of mean 1
///     erlang    the sum of k Erlang variates of mean 1
///     batch     (j - 1/2) b, for all b parts of batch j
///     list      the time of its entry
///
/// and at most `count` of them. So a count of parts differs from Lambda by at most 1/2 (regular), b/2 (batch), and
/// has the mean Lambda (poisson; erlang for large Lambda).
///
/// The profile is integrated exactly: piece by piece it is linear, so its integral is the trapezoid, and the inverse
/// of Lambda the root of a quadratic, taken in the form without cancellation.
///
/// Kind, place, heading and time of part k depend on the feed's seed and id, the substream and k alone: on nothing
/// that happened in a run.
///
/// Cost     O(log n) for Lambda and its inverse with n times; a part is O(log n) after the part before.
/// Units    SI; angles radians.

#pragma once

#include "core/base/status.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/// The arrivals of a feed, opaque and constant. It borrows the feed, which must outlive it.
typedef struct feed_arrivals feed_arrivals;

/// A place in the sequence of parts: plain numbers without padding, to be copied, saved and restored. Members
/// are written by the functions below alone.
typedef struct feed_cursor {
    uint64_t number; ///< of the part, from 1
    double due;      ///< when it arrives, s; INFINITY: there is no further part
    double level;    ///< Lambda there
    double residue;  ///< what rounding took from level (Kahan)
    uint64_t entry;  ///< of a list: index of its entry
    uint64_t left;   ///< of a list: parts of the entry that follow
} feed_cursor;

/// What a part is.
typedef struct feed_part {
    uint64_t number; ///< from 1
    double due;      ///< when it arrives, s
    uint32_t kind;   ///< index into scene.cargo
    double place;    ///< from the start of the feed's line, 0, to its end, 1
    bool is_placed;  ///< the place was given by a list: it takes no other
    double heading;  ///< rad
} feed_part;

/// Prepare the arrivals of a checked feed. The caller owns *ret_arrivals: feed_arrivals_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status feed_arrivals_create(const scene_feed *feed, uint64_t substream,
                                             feed_arrivals **ret_arrivals, bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
feed_arrivals *feed_arrivals_destroy(feed_arrivals *a);

/// Lambda(t), parts, at most `count`; t = INFINITY: all that will ever arrive, which may be INFINITY.
double feed_arrivals_until(const feed_arrivals *a, double t);

/// What all feeds of a checked scene offer together from one time to another, s, parts; it may be INFINITY. BF_ENOMEM.
BF_MUST_CHECK bf_status feed_offered(const scene *s, double from, double to, double *ret_parts,
                                     bf_error *err);

/// The parts of all feeds of a checked scene that are due after one time and until another, s, as they are drawn. O(n) in the parts
/// that are due until then. BF_ENOMEM.
BF_MUST_CHECK bf_status feed_drawn(const scene *s, double from, double to, double *ret_parts,
                                   bf_error *err);

/// The first time at which Lambda is at least `level` > 0, s; INFINITY: it never is.
double feed_arrivals_time(const feed_arrivals *a, double level);

/// The largest rate, parts/s; of a list the parts that follow its first entry by the time they take, 0 if they take
/// none.
double feed_arrivals_largest_rate(const feed_arrivals *a);

/// The cursor of the first part.
feed_cursor feed_arrivals_first(const feed_arrivals *a);

/// Move a cursor, whose due is finite, to the next part.
void feed_arrivals_next(const feed_arrivals *a, feed_cursor *cursor);

/// The part at a cursor whose due is finite.
feed_part feed_arrivals_part(const feed_arrivals *a, const feed_cursor *cursor);

/// Where a part is tried that did not find its place free: further draws, `attempt` from 1, in 0..1.
double feed_arrivals_place(const feed_arrivals *a, uint64_t number, uint32_t attempt);
