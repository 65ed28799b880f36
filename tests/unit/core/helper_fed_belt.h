/// A small belt that parts enter and leave, for all four solvers.

#pragma once

#include "core/micro/micro.h"

enum { HELPER_FED_BELT_PARTS = 4, HELPER_FED_BELT_SOLVERS = 4 };

/// A belt of 0.12 m x 0.1 m that runs from west to east with 1 m/s between two walls. Do not move it once it was made.
typedef struct helper_fed_belt {
    micro_def def;        ///< to be changed at will; no parts at first
    scene_belt belt;      ///< see there
    scene_obstacle plate; ///< from the north wall to the middle; not in def yet
    vec2 path[2];         ///< of the plate
    micro_kind
        kinds[2]; ///< cylinders of 12 mm; cylinders of 9 mm, or boxes of 30 mm x 20 mm in space
    scene_pose poses[HELPER_FED_BELT_PARTS]; ///< see def.n_parts
} helper_fed_belt;

/// Make it for a solver: disks explicit, implicit, bodies explicit, implicit.
void helper_fed_belt_init(helper_fed_belt *w, int solver);

/// Its solver; micro_destroy(). This and all that follows assert that all goes well.
micro_solver *helper_fed_belt_start(const helper_fed_belt *w);

/// Admit a part with the velocity of the belt. Returns its handle.
size_t helper_fed_belt_admit(micro_solver *s, uint32_t kind, double x, double y);

/// micro_is_free().
bool helper_fed_belt_is_free(micro_solver *s, uint32_t kind, double x, double y, double heading);

/// Steps for a time, s.
void helper_fed_belt_run(micro_solver *s, double time);
