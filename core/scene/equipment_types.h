/// Photo eyes and what they command, sinks, and what stops belts, as plain data.
///
/// Units    SI: m, s. Angles are radians.

#pragma once

#include "core/base/vec2.h"
#include "core/scene/limits.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A photo eye: a light barrier across a line.
typedef struct scene_photo_eye {
    char id[SCENE_ID_SIZE]; ///< unique among photo eyes (default "eye-<n>", n from 1)
    vec2 line[2];           ///< ends of the beam, m
    double block_time; ///< s, >= 0, for which the beam is broken before it is blocked (default 0)
    double clear_time; ///< s, >= 0, for which it is free before it is clear (default 0)
    double
        density_ratio; ///< macroscopic: the beam is broken where the largest density on it is at least this, in
    ///< (0, 1]; 0, "auto": by the parts that cross it (core/run/crossings.h; default 0)
} scene_photo_eye;

/// A place at which goods are taken off the line: a packer, a robot, a chute (sink.h).
typedef struct scene_sink {
    char id[SCENE_ID_SIZE]; ///< unique among sinks (default "sink-<n>", n from 1)
    size_t n_points;        ///< 3 to SCENE_POINTS_MAX (no default)
    vec2 *polygon;          ///< its outline, a simple polygon, m
    size_t n_kinds;         ///< that it takes; 0: all (default 0)
    uint32_t *kinds;        ///< indices into scene.cargo
    double rate;            ///< most parts/s, > 0 (default INFINITY)
} scene_sink;

/// What an action acts on.
typedef enum scene_action_type {
    SCENE_ACTION_BELT,     ///< a belt gets another speed, reached with its accelerations
    SCENE_ACTION_TURN,     ///< an obstacle turns about its pivot
    SCENE_ACTION_PRESENCE, ///< an obstacle comes or goes
    SCENE_ACTION_FEED,     ///< a feed is held or released
    SCENE_ACTION_SHIFT,    ///< an obstacle is shifted
    SCENE_ACTION_COUNT
} scene_action_type;

/// No kind of cargo in particular.
#define SCENE_KIND_ANY UINT32_MAX

/// What a photo eye commands. From the first command on, the target's own schedule has no effect.
typedef struct scene_action {
    size_t eye;        ///< index into scene.photo_eyes
    bool when_blocked; ///< acts when the state becomes blocked; else when it becomes clear
    uint32_t
        kind; ///< index into scene.cargo: acts for each part of this kind (default SCENE_KIND_ANY: for whatever breaks the beam)
    double delay;           ///< s after that, >= 0 (default 0)
    scene_action_type type; ///< see there
    size_t target;          ///< index of the belt, obstacle or feed
    double value; ///< of a belt its factor; of a turn the angle, rad; of a presence 1 or 0; of a
                  ///< feed 1: it is held, 0: it is not
    vec2 shift;   ///< of a shift: to where, from the path as in the document, m
    double over;  ///< of a turn and of a shift: how long it takes, s, > 0 (default 0.5)
} scene_action;

/// Which of the lanes that wait is released next.
typedef enum scene_merge_order {
    SCENE_MERGE_IN_TURN,  ///< the first one behind the lane that was released last, in a circle
    SCENE_MERGE_PRIORITY, ///< the first one of the list
    SCENE_MERGE_ORDER_COUNT
} scene_merge_order;

/// A lane that comes to a merge.
typedef struct scene_lane {
    size_t belt; ///< index into scene.belts: what stops and releases it
    size_t eye;  ///< index into scene.photo_eyes: where its parts wait, and are counted
} scene_lane;

/// Lanes that are released one at a time (core/run/merges.h).
typedef struct scene_merge {
    char id[SCENE_ID_SIZE];  ///< unique among merges (default "merge-<n>", n from 1)
    size_t n_lanes;          ///< 2 to SCENE_LANES_MAX (no default)
    scene_lane *lanes;       ///< see there
    scene_merge_order order; ///< see there (default SCENE_MERGE_IN_TURN)
    double
        parts; ///< most parts of a release, a whole number >= 1 (default 1, with a limit of time INFINITY)
    double time; ///< s, > 0, that a release lasts at most (default INFINITY)
    double gap;  ///< s, >= 0, from the end of a release to the next one (default 0)
} scene_merge;

/// How the times between failures, or of repairs, are distributed about their mean.
typedef enum scene_time_law {
    SCENE_TIME_EXPONENTIAL, ///< memoryless
    SCENE_TIME_WEIBULL,     ///< with a shape: below 1 early failures, above 1 wear
    SCENE_TIME_FIXED,       ///< each is the mean
    SCENE_TIME_LAW_COUNT
} scene_time_law;

/// A time that is drawn again and again.
typedef struct scene_drawn_time {
    double mean;        ///< s, > 0
    scene_time_law law; ///< see there (default SCENE_TIME_EXPONENTIAL)
    double shape;       ///< of SCENE_TIME_WEIBULL (default 1)
} scene_drawn_time;

/// How failures of one kind come.
typedef enum scene_failure_type {
    SCENE_FAILURE_DRAWN,  ///< at random
    SCENE_FAILURE_LISTED, ///< at given times
    SCENE_FAILURE_COUNT
} scene_failure_type;

/// A kind of failure of a belt, which stands from its beginning to the end of its repair. Only the members of its
/// type are used.
typedef struct scene_failure {
    char id
        [SCENE_ID_SIZE]; ///< unique among the failures of all belts (default "failure-<n>", n from 1)
    scene_failure_type type; ///< see there
    scene_drawn_time
        between; ///< drawn: from a repair, or the start, to the next failure; operating time, see
                 ///< belt_stops.h
    scene_drawn_time repair; ///< drawn: of each one
    size_t n_times;          ///< listed: failures
    double *times;           ///< listed: when each begins, s, >= 0, rising
    size_t n_durations;      ///< as many as there are times
    double *durations;       ///< listed: how long each lasts, s, > 0
} scene_failure;

/// Planned stops of a belt: breaks, or the time between shifts.
typedef struct scene_break {
    double start;    ///< of the first one, s, >= 0
    double duration; ///< s, > 0
    double
        every; ///< from the start of one to that of the next, s, > duration (default INFINITY: there is one)
} scene_break;

/// What stops a belt beside its speed schedule and commands.
typedef struct scene_stops {
    size_t n_failures;       ///< (default none)
    scene_failure *failures; ///< see there
    size_t n_breaks;         ///< (default none)
    scene_break *breaks;     ///< see there
    uint64_t substream;      ///< of the scene; set by scene_resolve()
    double until; ///< s, how long stops are needed: the scene's duration; set by scene_resolve()
} scene_stops;
