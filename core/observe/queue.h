/// Which cargo is held back: the only definition, from which the length of a queue, states and jams follow in both models.
///
///     free        faster than 0.8 of the belt under it
///     held back   not free: by what is before it, by a plate, or by a belt that stands; it is one of
///     queued      what moves of it
///     blocked     what stands of it: slower than 0.05 of the belt under it, or that one stands
///
/// The queue of a moment begins at what holds it back and ends at the last cargo that is held back. Along the direction
/// against the belt, that of the first plate which holds cargo back, or of the first belt without one,
///
///     length = the largest distance from the downstream end of the next plate to cargo before it that is held back,
///
/// and where nothing of the kind is before it (a transfer, a belt that stands, a part behind a plate), the distance from the
/// first to the last of it and a part's width. So the length is 0 where nothing is held back, and there alone.
///
/// Of a density the thin ends of what is held back do not count: less than half a part, and of it less than 5 %. Of parts all
/// count.
///
/// Units    SI.
/// Choice   a piece of a plate that is less inclined to its belt than 0.01 rad guides cargo and does not hold it back. Plates
///          are taken where they are at t = 0.

#pragma once

#include "core/base/vec2.h"
#include "core/scene/scene.h"

#include <stddef.h>

enum { QUEUE_BINS = 256 }; ///< of the longest line through the domain

/// What cargo does, by its speed relative to that of its belt.
typedef enum queue_state {
    QUEUE_FREE,    ///< it is not held back
    QUEUE_MOVES,   ///< it is held back and moves
    QUEUE_BLOCKED, ///< it is held back and stands
    QUEUE_STATES
} queue_state;

/// What is held back, by its distance along a line.
typedef struct queue_bins {
    double parts[QUEUE_BINS];    ///< in each bin
    double nearest[QUEUE_BINS];  ///< least distance of what is in the bin, m
    double farthest[QUEUE_BINS]; ///< largest one, m
} queue_bins;

/// A moment's queue. Begin with queue_of().
typedef struct queue {
    vec2 upstream;                          ///< against the belt's direction
    double start;                           ///< of the domain along it, m
    double span;                            ///< of the domain along it, m
    double width;                           ///< of a part, m
    size_t n_plates;                        ///< obstacles
    double plate_ends[SCENE_OBSTACLES_MAX]; ///< along that direction, m; INFINITY: a guide
    double parts;                           ///< that are queued
    queue_bins before_plates;               ///< by the distance from the next plate
    queue_bins elsewhere;                   ///< by the distance from the start
} queue;

/// State of cargo with a speed on a belt of a speed, m/s; 0: the belt stands, or there is none.
queue_state queue_state_of(double speed, double belt_speed);

/// An empty queue in a resolved scene.
queue queue_of(const scene *s);

/// Add cargo that is held back; at is its centre, m.
void queue_add(queue *q, vec2 at, double parts);

/// Its length, m.
double queue_length(const queue *q);

/// Begin the next moment.
void queue_clear(queue *q);
