/// Photo eyes: from whether beams are broken to states that last.
///
///     The state of an eye becomes blocked when its beam has been broken for block_time, and clear when it
///     has been free for clear_time, each without interruption, as seen at the ticks of a run.
///
/// Times are counted in steps of the run, so that rounding decides nothing.
///
/// Choice   at t = 0 every eye is clear; a beam that is broken then counts from there.
/// Units    SI.

#pragma once

#include "core/base/checkpoint.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// What an eye has seen.
typedef struct photo_eye_state {
    uint64_t since;      ///< the step of the tick since which the beam is as it is
    uint32_t is_broken;  ///< the beam, at the last tick
    uint32_t is_blocked; ///< the state
} photo_eye_state;

/// The eyes of a scene, which must outlive them.
typedef struct photo_eyes {
    size_t n;                               ///< eyes
    uint64_t n_block[SCENE_EYES_MAX];       ///< block_time of each in steps
    uint64_t n_clear[SCENE_EYES_MAX];       ///< clear_time of each in steps
    photo_eye_state states[SCENE_EYES_MAX]; ///< see there
} photo_eyes;

/// The eyes of a scene at t = 0 of a run with steps of dt, s.
photo_eyes photo_eyes_of(const scene *s, double dt);

/// Tell an eye at a tick, after the given number of steps, whether its beam is broken. True: its state changed.
bool photo_eyes_see(photo_eyes *eyes, size_t eye, uint64_t step, bool is_broken);

/// Write the states to a checkpoint, and take them from one of the same scene. False: it is damaged.
void photo_eyes_save(const photo_eyes *eyes, checkpoint_writer *w);
BF_MUST_CHECK bool photo_eyes_load(photo_eyes *eyes, checkpoint_reader *r);
