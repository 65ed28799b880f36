/// What a run does at its ticks beside stepping: sinks, departures, photo eyes, merges, actions, admissions, drives and belts that fail, in
/// this order.
///
/// A tick is a number of steps (run_plan.n_tick) that depends on the scenario alone. There is one at t = 0, at
/// every multiple of it, and at the end; scenarios that need none have none.

#pragma once

#include "core/run/commands.h"
#include "core/run/merges.h"
#include "core/run/photo_eyes.h"
#include "core/run/run.h"
#include "core/run/run_priv.h"

#include <stdbool.h>
#include <stdint.h>

/// What was told last of the drive of an obstacle that moves.
typedef struct control_drive {
    double turn;    ///< rad
    vec2 shift;     ///< m
    uint64_t state; ///< plate_drive_state
} control_drive;

/// The state of a run's ticks. Make with control_of(), free with control_fini().
typedef struct control {
    const scene *scene;                        ///< must outlive it
    bf_world *world;                           ///< of the run
    const run_backend *backend;                ///< the model
    uint64_t n_tick;                           ///< steps of a tick; 0: there are none
    double dt;                                 ///< step, s
    photo_eyes eyes;                           ///< see there
    commands commands;                         ///< see there
    merges merges;                             ///< see there
    passages passages[SCENE_EYES_MAX];         ///< of parts, at each eye
    control_drive drives[SCENE_OBSTACLES_MAX]; ///< of the obstacles
    uint32_t stops[SCENE_BELTS_MAX];           ///< of the belts: belt_stops_cause, told last
    bool has_stops;                            ///< some belt has failures or breaks, or is a lane
    uint64_t n_changes; ///< frames of changes since t = 0, at most FRAME_CHANGES_MAX
} control;

/// The ticks of a run at t = 0.
control control_of(const scene *s, bf_world *w, const run_backend *backend, const run_plan *plan);

/// Free what *c owns.
void control_fini(control *c);

/// The first step after `step` at which there is a tick; UINT64_MAX: none.
uint64_t control_next(const control *c, uint64_t step);

/// Make the tick after a number of steps; changes are emitted to the sink, FRAME_CHANGES_MAX
/// of a run. Failures are those of the model, of
/// commands_note() and of the sink.
BF_MUST_CHECK bf_status control_tick(control *c, void *solver, uint64_t step, figures *to,
                                     const run_sink *sink, bf_error *err);

/// True if the run is over because no feed will deliver any more part and the domain is empty.
bool control_is_drained(const control *c, const void *solver);

/// Write the state to a checkpoint, nothing where there are no ticks, and take it from one. BF_ECORRUPT, BF_ENOMEM.
void control_save(const control *c, checkpoint_writer *w);
BF_MUST_CHECK bf_status control_load(control *c, checkpoint_reader *r, bf_error *err);
