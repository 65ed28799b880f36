/// What the accumulators of key figures hold: filled by figures.c, read by figures_values.c.

#pragma once

#include "core/observe/fifo.h"
#include "core/observe/figures.h"
#include "core/observe/quantiles.h"
#include "core/observe/queue.h"
#include "core/observe/steady.h"
#include "core/observe/thinned.h"

#include <stdbool.h>
#include <stdint.h>

/// Of a counter; integrals are over time since the warm-up.
typedef struct counter_sums {
    double content;                     ///< of the last sample, parts
    double content_integral;            ///< parts s
    double content_max;                 ///< parts
    double states[QUEUE_STATES];        ///< parts in each state, of the sample that is being taken
    double states_before[QUEUE_STATES]; ///< same of the last one
    double states_integral[QUEUE_STATES]; ///< parts s
} counter_sums;

/// Of what leaves a counter or an outlet, or is taken by a sink.
typedef struct flow_sums {
    double left;       ///< until the last sample, parts
    double left_start; ///< until the end of the warm-up
    steady batches;    ///< see there; .length is 0 until the warm-up is over
} flow_sums;

/// Of a feed.
typedef struct feed_sums {
    feed_balance balance; ///< of the last sample
    double waiting_max;   ///< parts
} feed_sums;

/// Of a photo eye.
typedef struct eye_sums {
    uint64_t n_inside;      ///< parts that interrupt the beam
    uint64_t is_noted;      ///< the doubles count all of them
    double last_end;        ///< travel at the end of the last interruption, m; NAN: none
    double n;               ///< parts that have interrupted it
    double n_doubles;       ///< of them, together with another
    uint64_t is_blocked;    ///< its state
    double blocked_since;   ///< while it is, s
    double n_blocked;       ///< times that are over
    double blocked_total;   ///< of them together, s
    double blocked_longest; ///< of one of them, s
} eye_sums;

/// Of a belt whose speed changes.
typedef struct belt_sums {
    double known_until; ///< how it moved, s
    uint64_t stands;    ///< it stands
    double since;       ///< while it does, s
    double n;           ///< stops that are over
    double total;       ///< of them together, s
    double longest;     ///< of one of them, s
} belt_sums;

/// Of a belt with failures or breaks; saved only where there are some.
typedef struct stop_sums {
    uint64_t now;   ///< belt_stops_now()
    double failed;  ///< time down by failures outside breaks, s
    double planned; ///< time in breaks, s
} stop_sums;

/// Of a kind of failure.
typedef struct failure_sums {
    double n;     ///< that began
    double total; ///< time down by them outside breaks, s
} failure_sums;

/// Of jams.
typedef struct jam_sums {
    double since;        ///< of the last exit or empty domain, s
    double since_exited; ///< parts that had left then
    uint64_t is_jam;     ///< it has lasted long enough
    double count;        ///< jams that began
    double first;        ///< when the first one did, s; NAN: none
    double total;        ///< length of those that are over, s
} jam_sums;

/// Of plates that cargo stops.
typedef struct stall_sums {
    uint64_t n_now; ///< plates that are stopped
    double since;   ///< of their last change, s
    double count;   ///< how often one was stopped
    double first;   ///< when the first one was, s; NAN: none
    double total;   ///< for how long, until `since`, s
} stall_sums;

/// Plain numbers of the run, saved as they are.
typedef struct run_sums {
    uint64_t is_warm;    ///< the warm-up is over
    uint64_t has_cargo;  ///< the speed of cargo is known
    double t_start;      ///< end of the warm-up, s
    double exited_start; ///< parts that had left then
    double t;            ///< of the last sample, s
    double entered;      ///< parts until then
    double exited;       ///< parts until then
    double fallen;       ///< parts until then
    double peak;         ///< largest density; NAN: none yet
    double queue_end;    ///< longest queue, m
    double drained_at;   ///< s; NAN: it is not empty
    jam_sums jam;        ///< see there
    stall_sums stall;    ///< see there
    steady batches;      ///< of what leaves
} run_sums;

/// The accumulators.
struct figures {
    const scene *s; ///< borrowed
    bool has_parts; ///< the model is that of parts
    bool has_exits; ///< there are feeds: figures_exit() is called; else all entered at the start
    queue queue;    ///< of the sample that is being taken
    run_sums run;   ///< see there
    feed_sums feeds[SCENE_FEEDS_MAX];          ///< of each feed
    counter_sums counters[SCENE_COUNTERS_MAX]; ///< of each counter
    eye_sums eyes[SCENE_EYES_MAX];             ///< of each photo eye
    size_t n_through;                          ///< with feeds, counters and outlets; else 0
    size_t n_flows;                            ///< these, and sinks
    flow_sums *flows;                          ///< of each counter, outlet and sink
    size_t n_belts; ///< that belt_range_may_change(), as all that fail or have breaks do
    belt_sums belts[SCENE_BELTS_MAX]; ///< of each of them
    size_t n_stops;                   ///< of `stops`: n_belts, or 0 where nothing stops any
    stop_sums stops[SCENE_BELTS_MAX]; ///< of each of them
    size_t n_failures;                ///< kinds
    failure_sums failures[SCENE_ALL_FAILURES_MAX]; ///< of each of them
    quantiles residence;                           ///< times in the domain
    quantiles ages;       ///< has_exits: of what is inside, at the last sample
    quantiles ages_first; ///< same at the end of the warm-up
    bool are_ages_old;    ///< those of the sample that is being taken have not begun to come
    quantiles waits[SCENE_FEEDS_MAX]; ///< waits at each feed
    quantiles gaps[SCENE_EYES_MAX];   ///< gaps at each photo eye
    fifo inside;                      ///< without feeds: the domain
    fifo queues[SCENE_FEEDS_MAX];     ///< without parts: each feed
    thinned
        outflow; ///< without feeds: the first counter's curve after the warm-up, with what fell in it
};
