/// Merges: which lanes run, and which stand before the place where they meet.
///
/// Parts of a lane go on to the beam of its photo eye, which breaks where they wait: the belt of a lane stands while its beam is
/// broken and its state is blocked, but runs while the lane is released. At most one lane of a merge is released at a time.
///
///     A release ends when `parts` have left the beam since it began, or after `time`, or when the eye is clear: the
///     lane has run out. After `gap` the next one of the lanes that wait is released, by the order of the merge.
///
/// Lanes in which nothing waits are passed over. A release is not cut short by a lane that comes before it in the list.
///
/// Bits     times are counted in steps of the run. Before the tick at t = 0 every lane runs, and none is released.

#pragma once

#include "core/base/checkpoint.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// The parts at an eye.
typedef struct merges_eye {
    bool is_broken;  ///< its beam
    bool is_blocked; ///< its state
    uint64_t n_left; ///< parts that have left its beam since t = 0
} merges_eye;

/// How far a merge has come.
typedef struct merges_state {
    uint64_t is_open; ///< a lane is released
    uint64_t
        lane; ///< which; else the one that was released last, at first the last one of the list
    uint64_t since;  ///< the step at which that began, or ended
    uint64_t n_left; ///< of the lane, when it began
    uint64_t held;   ///< lanes that stand: 1 << lane
} merges_state;

/// The merges of a scene, which must outlive them.
typedef struct merges {
    const scene *scene;                    ///< of the run
    double dt;                             ///< step of the run, s
    merges_state states[SCENE_MERGES_MAX]; ///< see there
} merges;

/// The merges of a scene at t = 0, in a run with steps of dt, s.
merges merges_of(const scene *s, double dt);

/// Let a merge go on at a tick, after a number of steps, by what the eyes of the scene see. Returns the lanes that
/// begin to stand or to run: 1 << lane.
uint64_t merges_go_on(merges *m, size_t merge, const merges_eye *eyes, uint64_t step);

/// Which of the scene's belts stand by merges.
void merges_find_held(const merges *m, bool *ret_held);

/// Write the states to a checkpoint, nothing where there are no merges, and take them from one of the same scene. False: it is damaged.
void merges_save(const merges *m, checkpoint_writer *w);
BF_MUST_CHECK bool merges_load(merges *m, checkpoint_reader *r);
