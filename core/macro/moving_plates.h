/// Obstacles that turn, are shifted, come and go in the macroscopic model.
///
/// The velocity field, the closed faces and, for the congested closure, apertures and transverse velocities are made
/// again for the plates' present places before a step
///
///     when a point of a plate has moved by a quarter of a cell since they were made,
///     when a plate comes or goes, and
///     when a plate that has moved since comes to rest;
///
/// in between, plates stand where they were. The scenario and the number of the step decide that, so that a run
/// resumes with the same bits. What plates sweep over is in swept_cells.h: they carry cargo before them by this
/// alone, whatever their speed and that of the belt, and v_stat is that of plates at rest. A plate that comes or
/// goes moves no cargo.
///
/// Step     a point of a plate moves by at most a cell in a step: scene_step_stable().
/// Units    SI.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "core/scene/scene.h"

/// The plates of a scene; opaque, on the heap.
typedef struct moving_plates moving_plates;

/// Build them for t = 0. The scene and its world must outlive them. The caller owns *ret_plates: moving_plates_destroy().
/// BF_ENOMEM.
BF_MUST_CHECK bf_status moving_plates_create(const scene *s, bf_world *w,
                                             moving_plates **ret_plates, bf_error *err);

/// Free them. NULL is fine. Always returns NULL.
moving_plates *moving_plates_destroy(moving_plates *p);

/// The field of their present places; valid as long as they are.
const velocity_field *moving_plates_field(const moving_plates *p);

/// Move plates to where they are before the next step of a solver, and hand cargo on. Never allocates.
void moving_plates_update(moving_plates *p, macro_solver *s);

/// Write the places that the field has.
void moving_plates_save(const moving_plates *p, checkpoint_writer *w);

/// Take those of the same scene, and let a solver have the field of these places. False: they are damaged, and *p undefined.
BF_MUST_CHECK bool moving_plates_load(moving_plates *p, macro_solver *s, checkpoint_reader *r);
