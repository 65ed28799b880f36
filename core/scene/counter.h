/// Counters: parts inside a rectangle, U(t) of the paper. A cell counts if its centre is inside.

#pragma once

#include "core/base/grid.h"
#include "core/scene/scene.h"

/// The cells of a counter: columns i_min <= i < i_max, rows j_min <= j < j_max.
typedef struct counter_cells {
    size_t i_min; ///< first column
    size_t i_max; ///< column after the last; = i_min where none is inside
    size_t j_min; ///< first row
    size_t j_max; ///< row after the last
} counter_cells;

/// The cells whose centres lie in the counter's rectangle.
counter_cells counter_cells_of(const scene_counter *c, const bf_grid *grid);

/// True if the point lies in the counter's rectangle.
bool counter_holds(const scene_counter *c, vec2 at);

/// True if it counts parts of a kind of cargo.
static inline bool counter_counts(const scene_counter *c, uint32_t kind)
{
    return c->kind == SCENE_KIND_ANY || c->kind == kind;
}
