/// What run_micro.c and run_micro_*.c share: from the scenario to the definition of a solver.

#pragma once

#include "core/micro/micro.h"
#include "core/scene/placement.h"
#include "core/scene/scene.h"

#include <stdint.h>

/// A definition with what it borrows; must stay where it is. run_micro__fini_setup().
typedef struct run_micro__setup {
    micro_def def;                     ///< ready, with the step that the run takes
    micro_kind kinds[SCENE_KINDS_MAX]; ///< def.kinds
    scene_placement placement;         ///< def.poses, def.part_kinds
} run_micro__setup;

/// The definition of a checked scenario. BF_ENOMEM, BF_EINPUT as placement_of(); *setup is then empty.
BF_MUST_CHECK bf_status run_micro__init_setup(const scene *s, int n_threads,
                                              run_micro__setup *setup, bf_error *err);

/// Free what the setup owns and zero it. NULL is fine.
void run_micro__fini_setup(run_micro__setup *setup);

/// BF_ELIMIT if steps of dt are too many for the run.
BF_MUST_CHECK bf_status run_micro__check_count(const scene *s, double dt, bf_error *err);
