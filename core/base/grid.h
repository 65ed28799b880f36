/// A uniform rectangular grid of cells over the belt.
///
/// Layout  cell (i, j) is element j * n1 + i; i along the belt (x1), j across it (x2).
///         Face (i, j) of x1, 0 <= i <= n1, is the west face of cell (i, j): element j*(n1+1)+i.
///         Face (i, j) of x2, 0 <= j <= n2, is the south face of cell (i, j): element j*n1 + i.

#pragma once

#include <math.h>
#include <stddef.h>

/// Where the cells are.
typedef struct bf_grid {
    size_t n1;     ///< cells along x1, >= 1
    size_t n2;     ///< cells along x2, >= 1
    double lower1; ///< x1 of the grid's west edge, m
    double lower2; ///< x2 of the grid's south edge, m
    double d1;     ///< cell edge along x1, m, > 0
    double d2;     ///< cell edge along x2, m, > 0
} bf_grid;

/// x1 of the centre of the cells in column i, m.
static inline double grid_x1(const bf_grid *g, size_t i)
{
    return g->lower1 + ((double)i + 0.5) * g->d1;
}

/// x2 of the centre of the cells in row j, m.
static inline double grid_x2(const bf_grid *g, size_t j)
{
    return g->lower2 + ((double)j + 0.5) * g->d2;
}

/// Number of cells.
static inline size_t grid_cells(const bf_grid *g)
{
    return g->n1 * g->n2;
}

/// Number of faces across an axis, 0: x1, 1: x2.
static inline size_t grid_faces(const bf_grid *g, int axis)
{
    return axis == 0 ? (g->n1 + 1) * g->n2 : g->n1 * (g->n2 + 1);
}

/// A real index as the nearest one of 0 .. n.
static inline size_t grid_clamp(double index, size_t n)
{
    return (size_t)fmin(fmax(index, 0.0), (double)n);
}
