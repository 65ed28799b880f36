/// Parts that come and go during a run of the microscopic model: what each is, departures and admissions.
///
/// It belongs to one solver; times are those of the solver's steps.

#pragma once

#include "core/base/checkpoint.h"
#include "core/feed/parts_entry.h"
#include "core/micro/micro.h"
#include "core/run/run_priv.h"

#include <stddef.h>
#include <stdint.h>

/// What is known of a part beside its state.
typedef struct micro_tag {
    double entered;    ///< when it entered, s; 0 for those at the start
    uint32_t feed;     ///< index into scene.feeds; n_feeds: it was there at the start
    uint32_t kind;     ///< index into scene.cargo
    uint32_t counters; ///< in which it was at the last tick, a bit each
    uint32_t left;     ///< that it has left since it was there, the same
    double in_sink;    ///< the tick that found it in its sink, s
    uint32_t sink;     ///< index into scene.sinks, in which it is; n_sinks: none
    uint32_t is_taken; ///< by this sink
} micro_tag;

/// The parts. Zero-initialise; micro_feeds_init(), micro_feeds_fini().
typedef struct micro_feeds {
    const scene *scene;        ///< must outlive it
    micro_solver *solver;      ///< same
    feed_parts *entry;         ///< NULL: there are no feeds
    micro_tag *tags;           ///< by handle
    size_t n_tags_max;         ///< handles that they have room for
    run_departure *departures; ///< since the last tick
    size_t n_departures_max;   ///< that there is room for
    figures *figures;          ///< that waits are told, during micro_feeds_admit()
    bf_error query_error;      ///< of a question that feeds asked; BF_OK: none failed
    double part_steps;   ///< where there are feeds: parts in the domain, summed over the steps
    surroundings around; ///< of the scene
    size_t n_flows;      ///< counters and outlets
    double *flows;       ///< parts that left each counter, then each outlet, since t = 0
} micro_feeds;

/// Where a part counts: one that lies on a side with a feed, or was pushed back behind it, so that counters up to that side hold it.
vec2 micro_feeds_counted_place(const scene *s, vec2 at);

/// Begin at t = 0 with the parts of a placement, whose kinds may be NULL. BF_ENOMEM: to be freed all the same.
BF_MUST_CHECK bf_status micro_feeds_init(micro_feeds *f, const scene *s, micro_solver *solver,
                                         const scene_placement *placement, bf_error *err);

/// Free what *f owns.
void micro_feeds_fini(micro_feeds *f);

/// run_backend.depart, .admit, .balance and .is_exhausted.
BF_MUST_CHECK bf_status micro_feeds_depart(micro_feeds *f, run_departures *ret_departures,
                                           bf_error *err);
BF_MUST_CHECK bf_status micro_feeds_admit(micro_feeds *f, figures *to, bf_error *err);

/// Count the parts in the domain for n steps that are made now.
void micro_feeds_count_steps(micro_feeds *f, uint64_t n);

/// How long a part of the solver has been in the domain, s.
double micro_feeds_age(const micro_feeds *f, size_t part);

/// Parts that entered since t = 0.
double micro_feeds_entered(const micro_feeds *f);

/// run_backend.save and .load where there are feeds or sinks, with the solver's state.
BF_MUST_CHECK bf_status micro_feeds_save(const micro_feeds *f, checkpoint_writer *w, bf_error *err);
BF_MUST_CHECK bf_status micro_feeds_load(micro_feeds *f, checkpoint_reader *r, bf_error *err);
