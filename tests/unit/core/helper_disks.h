/// Small scenes of disks on belts for the tests of the planar path.

#pragma once

#include "core/micro/micro.h"

#include <stddef.h>
#include <stdint.h>

enum { HELPER_DISKS_MAX = 4096, HELPER_DISKS_BELTS = 4, HELPER_DISKS_KINDS = 3 };

/// A definition with what it points to. Do not move it once it was made.
typedef struct helper_disks {
    micro_def def;                         ///< to be changed at will
    scene_belt belts[HELPER_DISKS_BELTS];  ///< the first covers the domain
    scene_obstacle obstacle;               ///< along path
    vec2 path[4];                          ///< see there
    micro_kind kinds[HELPER_DISKS_KINDS];  ///< steel cylinders of 12, 9 and 15 mm
    scene_pose poses[HELPER_DISKS_MAX];    ///< def.n_parts of them
    uint32_t part_kinds[HELPER_DISKS_MAX]; ///< used if def.part_kinds says so
} helper_disks;

/// A domain of length x width, m, with walls in the south and in the north, one belt that moves at speed,
/// m/s, no parts and no obstacle. Freed by helper_disks_free().
helper_disks *helper_disks_make(double length, double width, double speed);

/// The same, 1 m x 1 m, where nothing but contacts acts: no belt, no damping.
helper_disks *helper_disks_make_bare(void);

/// NULL is fine.
void helper_disks_free(helper_disks *d);

/// Add a part of kind 0.
void helper_disks_add(helper_disks *d, double x, double y);

/// Add columns x rows parts in a square pattern with its first part at (x, y), moved about by up to
/// spread.
void helper_disks_fill(helper_disks *d, int columns, int rows, double x, double y, double spacing,
                       double spread);

/// Let the obstacle have n points of d->path and thickness, m.
void helper_disks_block(helper_disks *d, size_t n, double thickness);

/// A solver that must come to be.
micro_solver *helper_disks_start(const helper_disks *d);

/// micro_advance() that must go well.
void helper_disks_advance(micro_solver *s, uint64_t n);
