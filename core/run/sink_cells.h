/// Which cells of the density a sink takes from.
///
/// A cell is a sink's if its centre is in the sink's outline. A divider at which sinks end may lie on the centres of a row of cells, and
/// closes the faces on one side of them (core/macro/closed_lines.h): such cells are those of the sink on the side of their open faces.

#pragma once

#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/scene/scene.h"
#include "core/scene/sink.h"

#include <stdbool.h>
#include <stdint.h>

/// Where a cell lies from the closed line that its centre is on.
typedef enum sink_cells_side {
    SINK_CELLS_CENTRE, ///< on none
    SINK_CELLS_EAST,
    SINK_CELLS_WEST,
    SINK_CELLS_NORTH,
    SINK_CELLS_SOUTH,
    SINK_CELLS_SIDES
} sink_cells_side;

/// The cells of a scene with closed lines.
typedef struct sink_cells {
    bf_grid grid;               ///< of the density
    uint8_t *sides;             ///< a sink_cells_side of each cell
    bool has[SINK_CELLS_SIDES]; ///< whether a cell has it
} sink_cells;

/// Steps that it takes to find the cells of all sinks of a scene, for which SCENE_CHECK_STEPS_MAX is the limit.
double sink_cells_steps(const scene *s);

/// Find the cells on lines of obstacles, as they stand at t = 0: sink_cells_fini(). BF_ENOMEM; *ret_cells is then empty.
BF_MUST_CHECK bf_status sink_cells_init(const scene *s, sink_cells *ret_cells);

/// Free what they own and zero them.
void sink_cells_fini(sink_cells *cells);

/// Call visit for all cells of a sink. BF_ENOMEM.
BF_MUST_CHECK bf_status sink_cells_visit(const sink_cells *cells, const scene_sink *sink,
                                         sink_visit *visit, void *context);
