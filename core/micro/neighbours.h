/// Broad phase: which parts are near each other, by a grid of cells and a list with a skin, O(n).
///
/// The list holds every pair of parts whose centres are nearer in the plane than the sum of their reaches
/// plus skin. It stays right until some part has moved by skin/2 since it was made. Each part's
/// neighbours stand together and in a fixed order (by number), so that sums over them have the same
/// bits however the work is shared out.
///
/// Units    m. Parts that are gone are in no pair.

#pragma once

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// The list. Zero-initialise; neighbours_fini().
typedef struct pairs {
    double skin;         ///< m, > 0; set before the first neighbours_build()
    size_t n;            ///< parts
    uint32_t *start;     ///< n + 1 places in neighbour; part k's are start[k] .. start[k + 1] - 1
    uint32_t *neighbour; ///< numbers of neighbours, rising for each part; every pair stands twice
    size_t capacity;     ///< places of neighbour
    double *x_built;     ///< x of each part when the list was made
    double *y_built;     ///< same for y
    uint64_t n_builds;   ///< how often the list was made
    struct neighbours_cells *cells; ///< storage of the cell grid
} pairs;

/// Make the list of n parts at (x, y) with these reaches (NULL: all are reach0). is_gone may be NULL.
/// BF_ENOMEM: the list is not usable until a build succeeds.
BF_MUST_CHECK bf_status neighbours_build(pairs *p, size_t n, const double *x, const double *y,
                                         const double *reach, double reach0, const uint8_t *is_gone,
                                         bf_error *err);

/// True if a part has moved by more than skin/2 since the list was made.
bool neighbours_are_stale(const pairs *p, const double *x, const double *y, const uint8_t *is_gone);

/// Free what the list owns and zero it. NULL is fine.
void neighbours_fini(pairs *p);
