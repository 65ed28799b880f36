/// Times in a system by what has entered and left it until each time, first in, first out.
///
/// With E(t) and X(t) the cumulative curves of entries and exits, the level u, 0 <= u <= X, enters at the time at
/// which E reaches u and leaves when X does: the distance of the curves at that level is its time inside. Both
/// curves are linear between their samples, so between two corners this distance is linear in u, and what leaves in
/// between has its times spread uniformly from the distance at the one to that at the other.
///
/// Only the corners of E that are still needed are stored, at most FIFO_CORNERS. Corners closer than 1/2048 of the time
/// between the first and the last are merged, and where there are too many, every second one is dropped: so an
/// entry is known to some thousandth of the longest time inside.
///
/// Source   Little's law in this form: C. F. Daganzo, Fundamentals of Transportation and Traffic Operations (1997),
///          chapter 2, "N-curves".

#pragma once

#include "core/observe/quantiles.h"

#include <stdbool.h>
#include <stddef.h>

enum { FIFO_CORNERS = 4096 };

/// A corner of the curve of entries.
typedef struct fifo_corner {
    double t;     ///< s
    double level; ///< E(t)
} fifo_corner;

/// The state. Begin with fifo_init().
typedef struct fifo {
    size_t n;             ///< corners
    fifo_corner *corners; ///< room for FIFO_CORNERS of them
    fifo_corner out;      ///< the last sample of the curve of exits
} fifo;

/// Begin at t = 0, empty: a sample at t = 0 says what is inside then. The caller owns it: fifo_fini(). BF_ENOMEM: nothing
/// is owned.
BF_MUST_CHECK bf_status fifo_init(fifo *ret_f, bf_error *err);

/// Free what *f owns and zero it.
void fifo_fini(fifo *f);

/// The curves at a time, which does not fall: in all `entered` and `exited`. What left since the sample before is added
/// to *times (NULL: not wanted). A curve that falls, by rounding, counts as constant.
void fifo_sample(fifo *f, double t, double entered, double exited, quantiles *times);

/// Append the state to a checkpoint, and take it from one. False: damaged; *f is then only to be freed.
void fifo_save(const fifo *f, checkpoint_writer *w);
BF_MUST_CHECK bool fifo_load(fifo *f, checkpoint_reader *r);
