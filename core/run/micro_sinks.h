/// Sinks of the microscopic model (core/scene/sink.h): which parts they take at a tick.
///
/// A part is inside from the first tick on that finds its centre there. A sink with a rate that was free before the tick has taken
/// its part then, so that ticks cost it nothing: parts that wait are taken at exactly its rate.

#pragma once

#include "core/base/checkpoint.h"
#include "core/micro/micro.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// What is known of a part, by its handle.
typedef struct micro_sinks_tag {
    uint64_t id;       ///< of the part that this is of
    double since;      ///< the tick that found it in its sink, s
    uint32_t sink;     ///< in which it is; scene.n_sinks: none
    uint32_t is_taken; ///< by this sink
} micro_sinks_tag;

/// A part in a sink that is free.
typedef struct micro_sinks_waiting {
    size_t part;         ///< its handle
    micro_sinks_tag tag; ///< what is known of it
} micro_sinks_waiting;

/// The sinks of a run. Zero-initialise; micro_sinks_init(), micro_sinks_fini().
typedef struct micro_sinks {
    const scene *scene;              ///< must outlive it
    micro_solver *solver;            ///< same
    double free_at[SCENE_SINKS_MAX]; ///< from when on each may take a part again, s
    double taken[SCENE_SINKS_MAX];   ///< parts that each took since t = 0
    size_t n_tags;                   ///< handles that were ever seen
    size_t n_tags_max;               ///< that there is room for
    micro_sinks_tag *tags;           ///< by handle
    size_t n_waiting_max;            ///< that there is room for
    micro_sinks_waiting *waiting;    ///< scratch
} micro_sinks;

/// Begin at t = 0.
void micro_sinks_init(micro_sinks *m, const scene *s, micro_solver *solver);

/// Free what *m owns.
void micro_sinks_fini(micro_sinks *m);

/// A tick: take the parts whose turn it is out of the solver. BF_ENOMEM.
BF_MUST_CHECK bf_status micro_sinks_take(micro_sinks *m, bf_error *err);

/// True if a sink took the part with an id that had a handle.
bool micro_sinks_took(const micro_sinks *m, size_t part, uint64_t id);

/// Append the state to a checkpoint, and take it from one. BF_ECORRUPT: it is damaged; BF_ENOMEM.
void micro_sinks_save(const micro_sinks *m, checkpoint_writer *w);
BF_MUST_CHECK bf_status micro_sinks_load(micro_sinks *m, checkpoint_reader *r, bf_error *err);
