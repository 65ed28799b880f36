/// Photo eyes and what they command, as plain data.
///
/// Units    SI: m, s. Angles are radians.

#pragma once

#include "core/base/vec2.h"
#include "core/scene/limits.h"

#include <stdbool.h>
#include <stddef.h>

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

/// What an action acts on.
typedef enum scene_action_type {
    SCENE_ACTION_BELT,     ///< a belt gets another speed, reached with its accelerations
    SCENE_ACTION_TURN,     ///< an obstacle turns about its pivot
    SCENE_ACTION_PRESENCE, ///< an obstacle comes or goes
    SCENE_ACTION_FEED,     ///< a feed is held or released
    SCENE_ACTION_SHIFT,    ///< an obstacle is shifted
    SCENE_ACTION_COUNT
} scene_action_type;

/// What a photo eye commands. From the first command on, the target's own schedule has no effect.
typedef struct scene_action {
    size_t eye;             ///< index into scene.photo_eyes
    bool when_blocked;      ///< acts when the state becomes blocked; else when it becomes clear
    double delay;           ///< s after that, >= 0 (default 0)
    scene_action_type type; ///< see there
    size_t target;          ///< index of the belt, obstacle or feed
    double value; ///< of a belt its factor, >= 0; of a turn the angle, rad; of a presence 1 or 0;
                  ///< of a feed 1: it is held, 0: it is not
    vec2 shift;   ///< of a shift: to where, from the path as in the document, m
    double over;  ///< of a turn and of a shift: how long it takes, s, > 0 (default 0.5)
} scene_action;
