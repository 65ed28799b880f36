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

/// The table of one instruction set.
typedef struct disk_kernels {
    /// Forces of the solids on touches first <= k < last of the list, left in step->next for advance():
    /// all touches of a group must be among them. Raises the overlaps of *extremes.
    void (*touch)(const disk_step *step, size_t first, size_t last, driver_extremes *extremes);

    /// One step for groups first <= g < last: contacts, belt, integration. Raises *extremes.
    void (*advance)(const disk_step *step, size_t first, size_t last, driver_extremes *extremes);

    /// ret_y = tanh(x), relative error within 1e-12, for n numbers, n a multiple of 8.
    void (*tanh_of)(size_t n, const double *x, double *ret_y);
} disk_kernels;

/// The build for an instruction set.
const disk_kernels *disk_kernels_of(cpu_level level);
