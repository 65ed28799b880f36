/// The cells of the macroscopic grid: how long they are, and how they are fitted to the domain.
///
///     wanted   macro.cell, or for "auto" max(D/n, sqrt(area/CELLS_AUTO_MAX)), with D the diameter of a disk with the
///              footprint of the smallest kind, n that of the closure, area that of the domain
///     fitted   both sides are whole numbers of it: it is the edge of square cells
///              else the shorter side gets the nearest whole number of cells, and the longer one the number by which
///              its edges are nearest to theirs: they differ by at most 1/(2 n), n the cells along the longer side
///
/// Units    SI.

#pragma once

#include "core/scene/types.h"

enum {
    CELLS_PER_DIAMETER_CONGESTED = 3,  ///< n of SCENE_CONGESTED
    CELLS_PER_DIAMETER_DISPERSIVE = 5, ///< n of SCENE_DISPERSIVE, about the paper's 5 mm for 24 mm
    CELLS_AUTO_MAX = 1000000           ///< about so many cells at most, for "auto"
};

/// A grid before it is known whether its numbers of cells are within the limits.
typedef struct cells {
    double n1; ///< along x1, whole, >= 1; not finite where the domain or the cell is no number
    double n2; ///< the same along x2
    double d1; ///< edge along x1, m
    double d2; ///< edge along x2, m
} cells;

/// The edge that is wanted, m: what the scenario says, or of "auto" its rule. Kinds whose shape is at fault do not count.
double cells_wanted(const scene *s);

/// The cells of a resolved scenario, checked or not.
cells cells_of(const scene *s);
