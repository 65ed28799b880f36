/// What moves in a scene whatever its cargo does: belts at their speeds, and plates at their places, by schedules, commands
/// and drives.
///
/// A run owns one. Its solver borrows it, asks it in each step, and lets drives follow under what its cargo does to them
/// (plate_drive_follow()). Commands are given to it alone, and it is saved once, beside the solver's state.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/world/belt_speeds.h"
#include "core/world/plate_drive.h"
#include "core/world/plate_motion.h"

/// The world of a scene. Begin with world_init().
typedef struct bf_world {
    belt_speeds belts;   ///< of the scene's belts
    plate_motion plates; ///< of its obstacles
    plate_drive *drives; ///< of each obstacle
} bf_world;

/// The world of a resolved scene at t = 0, which must outlive it. The caller owns it: world_fini(). BF_ENOMEM: *ret_world is empty.
BF_MUST_CHECK bf_status world_init(bf_world *ret_world, const scene *s, bf_error *err);

/// Free what *w owns and zero it.
void world_fini(bf_world *w);

/// Carry out an action on a belt or an obstacle at a time t, s; one on a feed has no effect.
void world_command(bf_world *w, const scene_action *action, double t);

/// Write commands, and how drives lag, and take them into the world of the same scene at t = 0. False: they are damaged, and *w undefined.
void world_save(const bf_world *w, checkpoint_writer *writer);
BF_MUST_CHECK bool world_load(bf_world *w, checkpoint_reader *r);
