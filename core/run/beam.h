/// Beams of photo eyes: whether a part breaks one, and which cells one crosses. Plates do not break beams.

#pragma once

#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/scene/shape.h"

#include <stdbool.h>
#include <stddef.h>

/// The cells that a beam crosses or touches, as element numbers of the grid.
typedef struct beam_cells {
    size_t n;      ///< how many
    size_t *cells; ///< rising
} beam_cells;

/// True if a part in its place touches the beam between two points, m.
bool beam_meets_part(const vec2 beam[2], const shape_footprint *footprint, scene_pose pose);

/// How far a part extends, m.
typedef struct beam_extent {
    double least; ///< along the vector
    double most;  ///< same, >= least
} beam_extent;

/// How far a part in its place extends from a point along a unit vector.
beam_extent beam_extent_of(vec2 from, vec2 along, const shape_footprint *footprint,
                           scene_pose pose);

/// The cells of a beam, none of one off the grid. The caller owns them: beam_cells_fini(). BF_ENOMEM.
BF_MUST_CHECK bf_status beam_cells_of(const vec2 beam[2], const bf_grid *grid,
                                      beam_cells *ret_cells, bf_error *err);

/// Free the cells and zero *cells.
void beam_cells_fini(beam_cells *cells);
