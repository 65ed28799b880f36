/// The velocity field of obstacles that turn, are shifted, come and go, and of belts that run backwards.
///
/// The velocity field, the closed faces and, for the congested closure, apertures and transverse velocities are made
/// again for the plates' present places before a step
///
///     when a point of a plate has moved by a quarter of a cell since they were made,
///     when a plate comes or goes, and
///     when a plate that has moved since comes to rest;
///
/// and for the belts' present directions before a step in which a belt runs in another one than the step before. One that
/// stands keeps its direction. The field is that of a scene whose belts have v_T, turn and incline of the other sign, where they
/// run backwards; so cargo slides along the other face of a plate then, and a fed side is a wall as ever.
///
/// In between, plates stand where they were. The scenario and the number of the step decide that, so that a run
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

/// The field of a scene; opaque, on the heap.
typedef struct moving_field moving_field;

/// Build it for t = 0. The scene and its world must outlive it. The caller owns *ret_field: moving_field_destroy().
/// BF_ENOMEM.
BF_MUST_CHECK bf_status moving_field_create(const scene *s, bf_world *w, moving_field **ret_field,
                                            bf_error *err);

/// Free it. NULL is fine. Always returns NULL.
moving_field *moving_field_destroy(moving_field *p);

/// The field of the present places and directions; valid as long as *p is.
const velocity_field *moving_field_now(const moving_field *p);

/// The scene's belts with their present directions; NULL if none may run backwards. Valid as long as *p is.
const scene_belt *moving_field_belts(const moving_field *p);

/// Move plates to where they are before the next step of a solver, let belts run in their directions, and push cargo. Never
/// allocates.
void moving_field_update(moving_field *p, macro_solver *s);

/// Write the places and directions that the field has.
void moving_field_save(const moving_field *p, checkpoint_writer *w);

/// Take those of the same scene, and let a solver have the field of these places. False: they are damaged, and *p undefined.
BF_MUST_CHECK bool moving_field_load(moving_field *p, macro_solver *s, checkpoint_reader *r);
