/// Positions of the parts at the start: listed, hexagonal or random.

#pragma once

#include "core/scene/scene.h"
#include "core/scene/shape.h"
#include "core/scene/surroundings.h"

/// Place the parts of a scenario. Random places are drawn by random.h from
/// initial.seed, so the same scenario gives the same places on every machine.
/// The caller owns *ret_placement: placement_fini().
/// BF_ENOMEM; BF_EINPUT: that many random parts do not fit without overlap, which is predicted where it is clear.
BF_MUST_CHECK bf_status placement_make(const scene *s, scene_placement *ret_placement,
                                       bf_error *err);

/// The same for a check: within so many steps of the search for free places (overlap_grid.h), and until the check is
/// cancelled. BF_ELIMIT: there were more steps; BF_EBUSY: it was cancelled.
BF_MUST_CHECK bf_status placement_make_within(const scene *s, uint64_t steps_max,
                                              const bf_faults *check,
                                              scene_placement *ret_placement, bf_error *err);

/// The places that scene_check() left in the scene, borrowed from it, or placement_make() where it was
/// not checked: in either case placement_fini().
BF_MUST_CHECK bf_status placement_of(const scene *s, scene_placement *ret_placement, bf_error *err);

/// Free the places and zero *p. NULL is fine.
void placement_fini(scene_placement *p);

/// Note parts that extend outside the domain (over a wall) or have their centre outside (over an
/// open edge), or overlap another part by more than SCENE_TOLERANCE, with the pointer of the part; or that this
/// takes more than SCENE_PLACEMENT_STEPS_MAX steps. BF_ENOMEM; BF_EBUSY: the check was cancelled.
BF_MUST_CHECK bf_status placement_check(const scene *s, const scene_placement *p, bf_faults *faults,
                                        bf_error *err);

/// How far a part extends over a side of the domain, m: with its footprint over a wall, with its centre
/// over any side. Negative inside.
double placement_excess(const surroundings *around, const shape_footprint *footprint,
                        scene_pose pose, scene_side side);

/// Note parts that overlap the plate of an obstacle, as it stands at t = 0, by more than SCENE_TOLERANCE, for the microscopic
/// model, where a plate is solid; or that this takes more than SCENE_PLACEMENT_STEPS_MAX steps. BF_ENOMEM.
BF_MUST_CHECK bf_status placement_check_plates(const scene *s, const scene_placement *p,
                                               bf_faults *faults);
