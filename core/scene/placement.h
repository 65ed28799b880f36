/// Where the parts are at the start: listed, hexagonal or random.

#pragma once

#include "core/scene/scene.h"

/// The places of all parts. Owned; free with placement_fini().
typedef struct placement {
    size_t n;          ///< parts
    scene_pose *poses; ///< n of them
    uint32_t *kinds;   ///< kind of each; NULL: all are of kind 0
} placement;

/// Place the parts of a scenario. Random places are drawn by a generator of our own from
/// initial.seed, so the same scenario gives the same places on every machine.
/// BF_ENOMEM; BF_EINPUT: no room for that many random parts without overlap.
BF_MUST_CHECK bf_status placement_make(const scene *s, placement *ret_placement, bf_error *err);

/// Free the places and zero *p. NULL is fine.
void placement_fini(placement *p);

/// Note parts that reach outside the domain (over a wall) or have their centre outside (over an
/// open edge), or overlap another part by more than SCENE_TOLERANCE, with the pointer of the part.
/// O(n) by a cell grid. BF_ENOMEM.
BF_MUST_CHECK bf_status placement_check(const scene *s, const placement *p, bf_faults *faults);

/// Note parts that overlap the plate of an obstacle by more than SCENE_TOLERANCE, for the microscopic
/// model, where a plate is solid. BF_ENOMEM.
BF_MUST_CHECK bf_status placement_check_plates(const scene *s, const placement *p,
                                               bf_faults *faults);
