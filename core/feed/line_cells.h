/// The cells of a grid that a straight line crosses.

#pragma once

#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/base/vec2.h"

/// A cell and the length of the line in it.
typedef struct line_cell {
    size_t cell;   ///< layout of grid.h
    double length; ///< m, > 0; 1 of a line without length
} line_cell;

/// The cells that the line from start to end crosses, from its start on; at most n1 + n2 + 1. A line along a border of
/// cells lies in those of higher coordinates, and what is outside the grid counts to the nearest cell. *ret_cells is the
/// caller's: memory_free(). BF_ENOMEM.
BF_MUST_CHECK bf_status line_cells_find(const bf_grid *grid, vec2 start, vec2 end,
                                        line_cell **ret_cells, size_t *ret_n, bf_error *err);
