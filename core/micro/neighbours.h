/// Which parts are near each other: a grid of cells and the search in it, O(n) for all parts.
///
/// A list of neighbours holds every pair of parts whose centres are nearer in the plane than the sum of
/// their radii plus a skin. It is valid until some part has moved by half the skin: neighbours_holds().
/// The neighbours of a part stand in the order of their ids, so that sums over them have the same bits
/// however the work is split, and whenever the list was built.
///
/// The search writes the neighbours of one part to an array of the caller. neighbours_list stores them part by
/// part, for bodies; disks, which several lanes of a register handle together, lay them out in
/// core/micro/disk/list.c.
///
/// Units    m. Parts that have left are in no cell.

#pragma once

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NEIGHBOURS_STRIP = 16 }; ///< rows of cells in a strip

/// Parts sorted into square cells. Zero-initialise; neighbours_cells_fini(). Cells are numbered in strips of
/// NEIGHBOURS_STRIP rows, column by column within a strip, so that parts of neighbouring cells stand near
/// each other when parts are sorted by cell.
typedef struct neighbours_cells {
    double x_min;          ///< west edge of the first cell, m
    double y_min;          ///< south edge of the first cell, m
    double per_edge;       ///< 1 / edge of a cell, 1/m
    size_t n_x;            ///< cells in a row
    size_t n_y;            ///< rows
    size_t n_live;         ///< parts in cells
    uint32_t *first;       ///< n_x n_y + 1 indices into order: where each cell begins
    size_t first_capacity; ///< room
    uint32_t *order;       ///< parts by cell; within a cell in their own order
    size_t order_capacity; ///< room
    uint32_t *cell_of;     ///< cell of each part; UINT32_MAX for those left out
    size_t cell_capacity;  ///< room
} neighbours_cells;

/// The input of the search; arrays are the caller's.
typedef struct neighbours_parts {
    const double *x;       ///< of the centre of part k: x[k * stride], m
    const double *y;       ///< likewise
    size_t stride;         ///< doubles
    const double *radius;  ///< of a ball around part k: radius[k * radius_stride], m
    size_t radius_stride;  ///< doubles
    const uint32_t *id;    ///< by which neighbours are sorted; NULL: the index k itself
    const uint32_t *order; ///< that of the cells; NULL: parts stand in it
} neighbours_parts;

/// Sort n parts into cells with edges of at least `edge`, their number limited in proportion to n; those with
/// skip[k] != 0 are left out (NULL: none). Positions that are not finite are put into some cell. BF_ENOMEM: the
/// grid is empty.
BF_MUST_CHECK bf_status neighbours_sort(neighbours_cells *cells, size_t n,
                                        const neighbours_parts *parts, const uint8_t *skip,
                                        double edge, bf_error *err);

/// Let a grid use the caller's memory for order and cell_of, n numbers each, and take it back: for grids whose order is
/// of no use once parts are sorted by it. Such a grid has no memory of its own for them.
static inline void neighbours_lend(neighbours_cells *cells, size_t n, uint32_t *order,
                                   uint32_t *cell_of)
{
    cells->order = order;
    cells->cell_of = cell_of;
    cells->order_capacity = cells->cell_capacity = n;
}

static inline void neighbours_end_loan(neighbours_cells *cells)
{
    neighbours_lend(cells, 0, NULL, NULL);
}

/// Free what the grid owns and zero it. NULL is fine.
void neighbours_cells_fini(neighbours_cells *cells);

/// Column and row of a position, clamped to the grid.
size_t neighbours_column(const neighbours_cells *cells, double x);
size_t neighbours_row(const neighbours_cells *cells, double y);

/// Number of the cell in a column and a row.
static inline size_t neighbours_cell(const neighbours_cells *cells, size_t column, size_t row)
{
    size_t strip = row / NEIGHBOURS_STRIP, below = strip * NEIGHBOURS_STRIP;
    size_t height = cells->n_y - below < NEIGHBOURS_STRIP ? cells->n_y - below : NEIGHBOURS_STRIP;

    return below * cells->n_x + column * height + (row - below);
}

/// Write the neighbours of part k, in the order of their ids, to ret[0], ret[step], ret[2 step] and so on.
/// Cells must have edges of at least the sum of any two radii plus skin. Returns how many there are;
/// SIZE_MAX: more than `room`.
size_t neighbours_find(const neighbours_cells *cells, const neighbours_parts *parts, double skin,
                       size_t k, uint32_t *ret, size_t step, size_t room);

/// True if a list is valid while no part has moved farther than this since it was made.
static inline bool neighbours_holds(double skin, double moved)
{
    return moved <= 0.5 * skin;
}

/// The list, part by part. Zero-initialise; neighbours_fini().
typedef struct neighbours_list {
    double skin;           ///< m, > 0; set before the first neighbours_build()
    size_t n;              ///< parts
    size_t parts_capacity; ///< room for parts
    uint32_t *start;     ///< n + 1 indices of neighbour; part k's are start[k] .. start[k + 1] - 1
    uint32_t *neighbour; ///< indices of neighbours, rising for each part; every pair stands twice
    size_t capacity;     ///< room in neighbour
    double *x_built;     ///< x of each part when the list was made
    double *y_built;     ///< same for y
    uint64_t n_builds;   ///< how often the list was made
    neighbours_cells cells; ///< storage of the grid
} neighbours_list;

/// Make the list of n parts; n may differ from call to call. is_gone may be NULL. BF_ENOMEM: the list is not
/// usable until a build succeeds.
BF_MUST_CHECK bf_status neighbours_build(neighbours_list *list, size_t n, neighbours_parts parts,
                                         const uint8_t *is_gone, bf_error *err);

/// Free what the list owns and zero it. NULL is fine.
void neighbours_fini(neighbours_list *list);
