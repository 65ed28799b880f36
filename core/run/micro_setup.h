/// The microscopic model's scenarios: its limits, and from scenario to definition of the solver.

#pragma once

#include "core/base/faults.h"
#include "core/base/status.h"
#include "core/micro/micro.h"
#include "core/scene/placement.h"
#include "core/scene/scene.h"
#include "core/scene/surroundings.h"
#include "core/world/world.h"

/// A definition of the microscopic solver with what it borrows; must stay where it is.
/// micro_setup_fini().
typedef struct micro_setup {
    micro_def def;                     ///< ready, with the step that the run takes
    micro_kind kinds[SCENE_KINDS_MAX]; ///< def.kinds
    surroundings inlets;               ///< def.domain, edges and belts where a feed lies on a side
    scene_placement placement;         ///< def.poses, def.part_kinds
} micro_setup;

/// The definition of a checked scenario; w is its world, NULL if no solver is made. BF_ENOMEM, BF_EINPUT as placement_of(); *setup is
/// then empty.
BF_MUST_CHECK bf_status micro_setup_init(const scene *s, bf_world *w, int n_threads,
                                         micro_setup *setup, bf_error *err);

/// Free what the setup owns and zero it. NULL is fine.
void micro_setup_fini(micro_setup *setup);

/// Add the faults for which a checked scenario cannot be solved, and those of them that need its definition.
void micro_setup_check_scenario(const scene *s, bf_faults *faults);
void micro_setup_check(const scene *s, const micro_setup *setup, bf_faults *faults);
