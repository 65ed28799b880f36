/// How parts of feeds enter the microscopic model.
///
/// A part that is due becomes a body with its centre on its feed's line as soon as there is room: at its drawn place,
/// else at one of PARTS_ENTRY_DRAWS further draws, else at the first free place from the start of the line; else it
/// waits. Parts of a feed enter in the order of their arrival: while the first one waits, so do the others. A place
/// that a list of arrivals gives is the only one that is tried. Of a feed that discards, a part that has waited for
/// max_wait and still finds no place is dropped.
///
/// Places are drawn from where the footprint, at the part's heading, does not stick into walls of the domain; a
/// given place is moved there. The first free place of a disk among disks is exact: the ends of the intervals that the
/// others block. Where a plate is in the way, and for other footprints, places are tried every quarter of the bounding
/// radius, at most PARTS_ENTRY_TRIALS of them.
///
/// Within a call each feed has its turn once, and the one that is first changes from call to call, so that none starves
/// where two share a place. Parts that wait take no memory: they are a span of numbers between two cursors.
/// A feed that is held admits nothing, while parts go on to arrive.
///
/// Bits     the same for the same calls of feed_parts_advance(), also after save and load.
/// Units    SI; angles radians.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/feed/balance.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    PARTS_ENTRY_DRAWS = 10, ///< further draws of a place
    PARTS_ENTRY_TRIALS =
        1000, ///< most places that are tried along a line for a footprint that is no disk
};

/// A body near the line of a feed.
typedef struct feed_body {
    vec2 at;       ///< its centre, m
    uint32_t kind; ///< index into scene.cargo
} feed_body;

/// A part that enters.
typedef struct feed_admission {
    size_t feed;     ///< index into scene.feeds
    uint64_t number; ///< of its parts, from 1
    uint32_t kind;   ///< index into scene.cargo
    scene_pose pose; ///< its place
    double wait;     ///< time since it was due, s, >= 0
} feed_admission;

/// The model that parts enter, as a table of functions that get its context.
typedef struct feed_room {
    void *context; ///< of the functions
    /// True if a part of the kind overlaps nothing in this place.
    bool (*is_free)(void *context, uint32_t kind, scene_pose pose);
    /// Copy at most n_max of the bodies whose centres are nearer than `within` to the segment from start to end, and
    /// return how many there are.
    size_t (*near)(void *context, vec2 start, vec2 end, double within, feed_body *ret_bodies,
                   size_t n_max);
    /// Add the part.
    bf_status (*admit)(void *context, const feed_admission *part, bf_error *err);
} feed_room;

/// The entry of all feeds of a scene; opaque. It borrows the scene, which must outlive it.
typedef struct feed_parts feed_parts;

/// Begin at t = 0, before the first part. The caller owns *ret_parts: feed_parts_destroy(). BF_ENOMEM.
BF_MUST_CHECK bf_status feed_parts_create(const scene *s, feed_parts **ret_parts, bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
feed_parts *feed_parts_destroy(feed_parts *p);

/// Let in what is due at t, s, not before that of the last call. BF_ENOMEM, or what room->admit() reports.
BF_MUST_CHECK bf_status feed_parts_advance(feed_parts *p, double t, const feed_room *room,
                                           bf_error *err);

/// Hold a feed, or release it.
void feed_parts_hold(feed_parts *p, size_t feed, bool is_held);

/// The balance of a feed; whole numbers.
feed_balance feed_parts_balance(const feed_parts *p, size_t feed);

/// True if no part waits and none will arrive any more.
bool feed_parts_are_exhausted(const feed_parts *p);

/// Append the state to a checkpoint, and take it from one of the same scene. False: it is damaged, and *p undefined.
void feed_parts_save(const feed_parts *p, checkpoint_writer *w);
BF_MUST_CHECK bool feed_parts_load(feed_parts *p, checkpoint_reader *r);
