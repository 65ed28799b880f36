/// Sinks of the microscopic model (core/scene/sink.h): which parts they take at a tick.
///
/// A part is inside from the first tick on that finds its centre there. A sink with a rate that was free before the tick has taken
/// its part then, so that ticks cost it nothing: parts that wait are taken at exactly its rate.

#pragma once

#include "core/base/checkpoint.h"
#include "core/run/micro_feeds.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A part in a sink that is free.
typedef struct micro_sinks_waiting {
    size_t part;   ///< its handle
    uint64_t id;   ///< its id
    double since;  ///< when it came into the sink, s
    uint32_t sink; ///< index
} micro_sinks_waiting;

/// The sinks of a run. Zero-initialise; micro_sinks_init(), micro_sinks_fini().
typedef struct micro_sinks {
    const scene *scene;              ///< must outlive it
    double free_at[SCENE_SINKS_MAX]; ///< from when on each may take a part again, s
    double taken[SCENE_SINKS_MAX];   ///< parts that each took since t = 0
    size_t n_waiting_max;            ///< that there is room for
    micro_sinks_waiting *waiting;    ///< scratch
} micro_sinks;

/// Begin at t = 0.
void micro_sinks_init(micro_sinks *m, const scene *s);

/// Free what *m owns.
void micro_sinks_fini(micro_sinks *m);

/// A tick: take the parts whose turn it is out of the solver, and note it in their tags. BF_ENOMEM.
BF_MUST_CHECK bf_status micro_sinks_take(micro_sinks *m, micro_feeds *f, bf_error *err);

/// Append what is not in the tags to a checkpoint, and take it from one. False: it is damaged.
void micro_sinks_save(const micro_sinks *m, checkpoint_writer *w);
BF_MUST_CHECK bool micro_sinks_load(micro_sinks *m, checkpoint_reader *r);
