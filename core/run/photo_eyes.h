/// Photo eyes: from whether beams are broken to states that last.
///
///     The state of an eye becomes blocked when its beam has been broken for block_time, and clear when it
///     has been free for clear_time, each without interruption, as seen at the ticks of a run.
///     A beam that was free between two parts since the last tick, for a step of the solver at least, counts as free at this one.
///
/// With a kind of cargo an action acts for each part of that kind: of each part that has broken the beam the eye keeps a state of
/// its own, which becomes blocked and clear by the same rule, of this part alone. So of two parts that break the beam at once,
/// or one behind the other without a gap, each gives its command, and none of another kind does.
///
/// Times are counted in steps of the run, so that rounding decides nothing.
///
/// Choice   at t = 0 every eye is clear; a beam that is broken then counts from there.
/// Units    SI.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
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

/// A part that breaks a beam.
typedef struct photo_eye_part {
    uint64_t id;   ///< unique among the parts of a run that break this beam
    uint64_t kind; ///< index into scene.cargo
} photo_eye_part;

/// A part that an eye has a state of: its beam is broken, or the state is blocked.
typedef struct photo_eye_known {
    photo_eye_part part;   ///< which
    photo_eye_state state; ///< see there
    uint64_t is_new_state; ///< the state changed at the last tick; else 0
} photo_eye_known;

/// The parts that an eye knows, which tells kinds apart.
typedef struct photo_eye_parts {
    size_t n;               ///< how many
    photo_eye_known *items; ///< in the order in which they came
    size_t n_max;           ///< that there is room for
} photo_eye_parts;

/// The eyes of a scene, which must outlive them.
typedef struct photo_eyes {
    size_t n;                               ///< eyes
    uint64_t n_block[SCENE_EYES_MAX];       ///< block_time of each in steps
    uint64_t n_clear[SCENE_EYES_MAX];       ///< clear_time of each in steps
    photo_eye_state states[SCENE_EYES_MAX]; ///< see there
    bool tells_kinds[SCENE_EYES_MAX];       ///< some action at it has a kind
    photo_eye_parts parts[SCENE_EYES_MAX];  ///< of eyes that do; else empty
} photo_eyes;

/// The eyes of a scene at t = 0 of a run with steps of dt, s.
photo_eyes photo_eyes_of(const scene *s, double dt);

/// Free what they own.
void photo_eyes_fini(photo_eyes *eyes);

/// Tell an eye at a tick, after the given number of steps, whether its beam is broken. True: its state changed.
bool photo_eyes_see(photo_eyes *eyes, size_t eye, uint64_t step, bool is_broken);

/// Tell an eye that tells kinds which n parts break its beam at a tick. Those whose state changed have is_new_state set until the next
/// call. BF_ENOMEM.
BF_MUST_CHECK bf_status photo_eyes_see_parts(photo_eyes *eyes, size_t eye, uint64_t step, size_t n,
                                             const photo_eye_part *parts, bf_error *err);

/// Write the states to a checkpoint, and take them from one of the same scene. BF_ECORRUPT, BF_ENOMEM.
void photo_eyes_save(const photo_eyes *eyes, checkpoint_writer *w);
BF_MUST_CHECK bf_status photo_eyes_load(photo_eyes *eyes, checkpoint_reader *r, bf_error *err);
