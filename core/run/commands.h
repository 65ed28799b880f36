/// Commands: what changes of photo eyes let happen, and when.
///
/// A change of an eye's state gives a command for each action that waits for it, due `delay` later; with a kind, a change of its
/// state of a part of this kind does. Commands that
/// are due at a tick are carried out in the order in which they are due, those of one step in the order of the actions
/// in the scene. A command that waits for its time is not taken back by later changes.
///
/// Times are counted in steps of the run. Units SI.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Most commands that may wait for their time.
enum { COMMANDS_MAX = 65536 };

/// A command that waits for its time.
typedef struct command {
    uint64_t step;   ///< at which it is due
    uint64_t action; ///< index into scene.actions
} command;

/// The commands that wait. Make with commands_of(), free with commands_fini().
typedef struct commands {
    const scene *scene; ///< must outlive them
    double dt;          ///< step of the run, s
    size_t n;           ///< how many
    command *items;     ///< in the order in which they will be carried out
    size_t capacity;    ///< for which there is room
} commands;

/// No commands yet, of a scene in a run with steps of dt, s.
commands commands_of(const scene *s, double dt);

/// Free what *c owns.
void commands_fini(commands *c);

/// Note the commands that follow from a change of an eye's state at a step, of the state of a part of a kind, or of its own
/// (SCENE_KIND_ANY). BF_ENOMEM; BF_ELIMIT: more than
/// COMMANDS_MAX would wait.
BF_MUST_CHECK bf_status commands_note(commands *c, size_t eye, uint32_t kind, bool is_blocked,
                                      uint64_t step, bf_error *err);

/// Take the next command that is due at a step. False: none is.
bool commands_take(commands *c, uint64_t step, size_t *ret_action);

/// Write the commands to a checkpoint, and take them from one of the same scene. BF_ECORRUPT: it is damaged;
/// BF_ENOMEM.
void commands_save(const commands *c, checkpoint_writer *w);
BF_MUST_CHECK bf_status commands_load(commands *c, checkpoint_reader *r, bf_error *err);
