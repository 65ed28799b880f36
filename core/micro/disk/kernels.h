/// The inner loops of the planar path with explicit steps, in groups of DISK_GROUP parts.
///
/// The same source is compiled once per instruction set (core/CMakeLists.txt). All variants give the
/// same bits: core/base/simd.h says why.

#pragma once

#include "core/base/cpu.h"
#include "core/micro/disk/disk_priv.h"

#include <stdbool.h>

/// The numbers of a step.
typedef struct disk_step {
    const disk_state *state; ///< laws and lists; its now and next do not count here
    const disk_row *now;     ///< state before the step
    disk_row *next;          ///< state after it; before, in groups with touches, their pushes
    double *heading;         ///< by place, updated
    double dt;               ///< s, for places and headings
    double dt_force;         ///< s, what forces act for: dt, or 0 in the first step
    double keep;             ///< 1 - D dt, or 1 in the first step
    double keep_spin;        ///< (1 - D)^dt, or 1 in the first step
} disk_step;

/// What a step tells.
typedef struct disk_extremes {
    double speed2;        ///< largest v^2, m2/s2
    double sum;           ///< of v^2 and spin^2: not finite if anything is not
    double overlap;       ///< largest, m; 0 or more
    double overlap_share; ///< largest overlap / smaller radius
} disk_extremes;

/// The table of one instruction set.
typedef struct disk_kernels {
    /// Forces of the solids on touches first <= k < last of the list, left in step->next for advance():
    /// all touches of a group must be among them. Raises the overlaps of *extremes.
    void (*touch)(const disk_step *step, size_t first, size_t last, disk_extremes *extremes);

    /// One step for groups first <= g < last: contacts, belt, integration. Raises *extremes.
    void (*advance)(const disk_step *step, size_t first, size_t last, disk_extremes *extremes);

    /// ret_y = tanh(x), relative error within 1e-12, for n numbers, n a multiple of 8.
    void (*tanh_of)(size_t n, const double *x, double *ret_y);
} disk_kernels;

/// What both kinds of bursts of steps (disk_advance.c, disk_tiles.c) make of extremes.

/// Raise the extremes in *all.
void disk__join_extremes(disk_extremes *all, const disk_extremes *more);

/// True if a step may have gone wrong, in which the fastest part moved by `move`, m: disk__check().
bool disk__is_suspect(const disk_state *s, const disk_extremes *of_step, double move);

/// Count n steps as made: travel and move as in disk_state, and the largest overlaps.
void disk__count_steps(disk_state *s, uint64_t n, double travel, double move,
                       const disk_extremes *largest);

/// Make as many explicit steps as a tile has, at most n, on a list that is good. Returns how many; 0: no
/// tile fits, or single steps would end within it, and nothing has changed.
uint64_t disk__advance_tile(disk_state *s, const disk_step *step, uint64_t n, bool *ret_suspect);

/// The build for an instruction set.
const disk_kernels *disk_kernels_of(cpu_level level);
