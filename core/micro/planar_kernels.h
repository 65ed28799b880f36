/// The inner loops of the planar path with explicit steps, in groups of PLANAR_GROUP parts.
///
/// The same source is compiled once per instruction set (core/CMakeLists.txt). All variants give the
/// same bits: lanes.h says why.

#pragma once

#include "core/micro/planar_priv.h"

#include <stdbool.h>

/// The numbers of a step.
typedef struct planar_step {
    const planar_state *state; ///< laws and lists; its now and next do not count here
    const planar_row *now;     ///< state before the step
    planar_row *next;          ///< state after it; before, in groups with touches, their pushes
    double *heading;           ///< by place, updated
    double dt;                 ///< s, for places and headings
    double dt_force;           ///< s, what forces act for: dt, or 0 in the first step
    double keep;               ///< 1 - D dt, or 1 in the first step
    double keep_spin;          ///< (1 - D)^dt, or 1 in the first step
} planar_step;

/// What a step tells.
typedef struct planar_extremes {
    double speed2;        ///< largest v^2, m2/s2
    double sum;           ///< of v^2 and spin^2: not finite if anything is not
    double overlap;       ///< largest, m; 0 or more
    double overlap_share; ///< largest overlap / smaller radius
} planar_extremes;

/// The table of one instruction set.
typedef struct planar_kernels {
    const char *name; ///< of the instruction set, "avx512", "avx2", "base"

    /// Forces of the solids on touches first <= k < last of the list, left in step->next for advance():
    /// all touches of a group must be among them. Raises the overlaps of *extremes.
    void (*touch)(const planar_step *step, size_t first, size_t last, planar_extremes *extremes);

    /// One step for groups first <= g < last: contacts, belt, integration. Raises *extremes.
    void (*advance)(const planar_step *step, size_t first, size_t last, planar_extremes *extremes);

    /// ret_y = tanh(x), relative error within 1e-12, for n numbers, n a multiple of 8.
    void (*tanh_of)(size_t n, const double *x, double *ret_y);
} planar_kernels;

/// What both kinds of bursts of steps (planar_advance.c, planar_tiles.c) make of extremes.

/// Raise the extremes in *all.
void planar__join_extremes(planar_extremes *all, const planar_extremes *more);

/// True if a step may have gone wrong, in which the fastest part moved by `move`, m: planar__check().
bool planar__is_suspect(const planar_state *s, const planar_extremes *of_step, double move);

/// Count n steps as made: travel and move as in planar_state, and the largest overlaps.
void planar__count_steps(planar_state *s, uint64_t n, double travel, double move,
                         const planar_extremes *largest);

/// Make as many explicit steps as a tile has, at most n, on a list that is good. Returns how many; 0: no
/// tile fits, or single steps would end within it, and nothing has changed.
uint64_t planar__advance_tile(planar_state *s, const planar_step *step, uint64_t n,
                              bool *ret_suspect);

/// All variants that this processor can run, fastest first; NULL-terminated.
const planar_kernels *const *planar_kernels_available(void);
