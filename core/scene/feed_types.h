/// Feeds as plain data: sources of cargo while a run goes on.
///
/// Units    SI: m, s. Angles are radians.

#pragma once

#include "core/base/vec2.h"
#include "core/scene/limits.h"
#include "core/scene/series.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// The sides of the domain.
typedef enum scene_side {
    SCENE_WEST,  ///< x = x_min
    SCENE_EAST,  ///< x = x_max
    SCENE_SOUTH, ///< y = y_min
    SCENE_NORTH, ///< y = y_max
    SCENE_SIDE_COUNT
} scene_side;

/// How parts of a feed arrive, where Lambda is its cumulative arrival function (core/feed/arrivals.h).
typedef enum scene_arrivals {
    SCENE_ARRIVALS_REGULAR, ///< part k, from 1, where Lambda reaches k - 1/2
    SCENE_ARRIVALS_POISSON, ///< Lambda grows by exponential variates of mean 1 from part to part
    SCENE_ARRIVALS_ERLANG,  ///< by Erlang variates of mean 1
    SCENE_ARRIVALS_BATCH, ///< batch j, from 1, of b parts at once where Lambda reaches (j - 1/2) b
    SCENE_ARRIVALS_COUNT
} scene_arrivals;

/// What says how many parts a feed delivers.
typedef enum scene_demand {
    SCENE_DEMAND_RATE,     ///< a constant rate
    SCENE_DEMAND_PROFILE,  ///< a rate that changes in time
    SCENE_DEMAND_SCHEDULE, ///< a list of arrivals
    SCENE_DEMAND_COUNT
} scene_demand;

/// What happens to parts of a feed that do not find a free place.
typedef enum scene_when_blocked {
    SCENE_BLOCKED_WAIT,    ///< they wait until there is one, first come first served
    SCENE_BLOCKED_DISCARD, ///< they are dropped, and counted, after max_wait
    SCENE_BLOCKED_COUNT
} scene_when_blocked;

/// A kind of a feed's mix.
typedef struct scene_feed_kind {
    uint32_t kind; ///< index into scene.cargo
    double share;  ///< probability of it in proportion to all shares, > 0
} scene_feed_kind;

/// A list of arrivals: at each time some parts at once.
typedef struct scene_arrival_list {
    size_t n;         ///< entries
    double *times;    ///< s, >= 0, not falling
    uint32_t *counts; ///< parts that arrive, >= 1; NULL: 1 each
    uint32_t *kinds;  ///< of these parts, indices into scene.cargo; NULL: drawn from the mix
    double *places;   ///< in 0..1 from the start of the line to its end; NULL or NAN: drawn
    double *headings; ///< rad; NULL or NAN: that of the feed
} scene_arrival_list;

/// A source of cargo while the run goes on. Parts enter on a line: part of a side of the domain, or a line inside.
typedef struct scene_feed {
    char id[SCENE_ID_SIZE]; ///< unique among feeds (default "feed-<n>", n from 1)
    bool is_edge;           ///< it lies on a side of the domain: nothing leaves over this side
    scene_side edge;        ///< is_edge: which side (no default)
    vec2 line[2]; ///< on which centres enter: its ends, m (default of an edge: the whole side)
    double start; ///< first time of its Lambda, s, >= 0 (default 0)
    double end;   ///< last, s, > start (default INFINITY)
    double count; ///< most parts, a whole number >= 1 (default INFINITY)
    scene_arrivals arrivals; ///< (default SCENE_ARRIVALS_REGULAR); not of a list of arrivals
    uint32_t shape;          ///< of SCENE_ARRIVALS_ERLANG, >= 1 (default 2)
    uint32_t batch_size;     ///< b of SCENE_ARRIVALS_BATCH, >= 1 (default 10)
    scene_demand demand;     ///< which of the next three counts (no default)
    double rate;             ///< parts/s, > 0
    scene_series profile; ///< parts/s, >= 0, linear between its times, constant outside; its times,
                          ///< and repeat, count from the feed's start
    scene_arrival_list schedule; ///< see there; times are those of the run
    bool has_random_heading;     ///< headings are drawn, uniformly
    double heading;              ///< else that of every part, rad (default 0)
    size_t n_cargo; ///< kinds of its mix (default all of scene.cargo with their shares)
    scene_feed_kind cargo[SCENE_KINDS_MAX]; ///< see there
    scene_when_blocked when_blocked;        ///< (default SCENE_BLOCKED_WAIT)
    double max_wait;                        ///< SCENE_BLOCKED_DISCARD: s, >= 0 (default 0)
    uint64_t seed;                          ///< of its draws (default 1), < 2^53
} scene_feed;
