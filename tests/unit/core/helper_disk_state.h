/// Small test cases for the planar path with explicit steps, whose state tests may change.

#pragma once

#include "core/micro/disk/parts.h"
#include "tests/unit/core/helper_outflow.h"

enum { HELPER_DISK_STATE_PARTS = 1536 };

/// Steel cylinders of 12 mm (kind 0) and 9 mm (kind 1) in a domain of 2 m x 2 m that is open all around,
/// on two belts: west of x = 1 and east of it. No air. Do not move it once it was made.
typedef struct helper_disk_state {
    micro_def def;                                ///< to be changed at will; all parts of kind 0
    scene_belt belts[2];                          ///< west and east
    vec2 west[4];                                 ///< corners
    vec2 east[4];                                 ///< same
    scene_obstacle obstacle;                      ///< not in def yet
    vec2 path[2];                                 ///< of the obstacle
    micro_kind kinds[2];                          ///< def has both
    scene_pose poses[HELPER_DISK_STATE_PARTS];    ///< see helper_disk_state_add()
    uint32_t part_kinds[HELPER_DISK_STATE_PARTS]; ///< kinds; not in def yet
} helper_disk_state;

/// A world without parts, belts running to the east with v_west and v_east, m/s; free().
helper_disk_state *helper_disk_state_make(double v_west, double v_east);

/// Add a part.
void helper_disk_state_add(helper_disk_state *w, double x, double y);

/// A jam of 32 x 44 parts that overlap a little and are driven against an obstacle on the east belt
/// and across the edge in the east; every seventh is of kind 1 if is_mixed.
void helper_disk_state_crowd(helper_disk_state *w, bool is_mixed);

/// Example 1 (60) or 2 (90) with its packing compressed by 3 % and in contact with the plate.
void helper_disk_state_jam(helper_outflow *e, double angle_deg);

/// The state of the solver of a definition, asserted to be made; helper_disk_state_end().
disk_state *helper_disk_state_start(const micro_def *def);
void helper_disk_state_end(disk_state *s);

/// The part with an id.
disk *helper_disk_state_row(disk_state *s, size_t number);

/// Give a part a velocity, m/s, and a spin, rad/s.
void helper_disk_state_push(disk_state *s, size_t k, double vx, double vy, double spin);

/// Make n steps, asserted to succeed.
void helper_disk_state_advance(disk_state *s, uint64_t n);
