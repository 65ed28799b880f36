/// The cell grid under the broad phase: parts sorted into square cells.
///
/// Cells are numbered in strips of NEIGHBOURS_STRIP rows, column by column within a strip, so that parts of
/// neighbouring cells stand near each other when parts are sorted by cell.

#pragma once

#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

enum { NEIGHBOURS_STRIP = 16 }; ///< rows of cells in a strip

/// The grid. Zero-initialise; neighbours__cells_fini().
typedef struct neighbours_cells {
    double x_min;          ///< west edge of the first cell, m
    double y_min;          ///< south edge of the first cell, m
    double per_edge;       ///< 1 / edge of a cell, 1/m
    size_t n_x;            ///< cells in a row
    size_t n_y;            ///< rows
    size_t n_live;         ///< parts in cells
    uint32_t *first;       ///< n_x n_y + 1 places in order: where each cell begins
    size_t first_capacity; ///< room
    uint32_t *order;       ///< parts by cell; within a cell by their numbers
    size_t order_capacity; ///< room
    uint32_t *cell_of;     ///< cell of each part; UINT32_MAX for those left out
    size_t cell_capacity;  ///< room
} neighbours_cells;

/// Sort n parts into cells with edges of at least `edge`, as many as is sensible for n. The places are
/// x[k stride], y[k stride]; parts with skip[k] != 0 are left out (NULL: none). Places that are not
/// finite end up in some cell. BF_ENOMEM: the grid is empty.
BF_MUST_CHECK bf_status neighbours__sort(neighbours_cells *cells, size_t n, const double *x,
                                         const double *y, size_t stride, const uint8_t *skip,
                                         double edge, bf_error *err);

/// Column and row of a place, moved into the grid.
size_t neighbours__column(const neighbours_cells *cells, double x);
size_t neighbours__row(const neighbours_cells *cells, double y);

/// Number of the cell in a column and a row.
static inline size_t neighbours__cell(const neighbours_cells *cells, size_t column, size_t row)
{
    size_t strip = row / NEIGHBOURS_STRIP, below = strip * NEIGHBOURS_STRIP;
    size_t height = cells->n_y - below < NEIGHBOURS_STRIP ? cells->n_y - below : NEIGHBOURS_STRIP;

    return below * cells->n_x + column * height + (row - below);
}

/// Free what the grid owns and zero it. NULL is fine.
void neighbours__cells_fini(neighbours_cells *cells);
