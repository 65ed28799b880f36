/// Sinks: places at which goods are taken off the line.
///
/// A part is taken when its centre is in the outline of a sink of its kind; where several of them overlap it is in the last one.
/// With a rate the next part is taken 1/rate after the last one at the earliest, that first which has been inside for longest;
/// until it is taken it moves on as any other.

#pragma once

#include "core/base/grid.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/// True if the sink takes this kind of cargo.
bool sink_takes(const scene_sink *sink, size_t kind);

/// Called with cells whose centres lie in a sink: columns first <= i < last of row j. False: no more are wanted.
typedef bool sink_visit(void *context, size_t j, size_t first, size_t last);

/// Call visit for all cells whose centres lie in a sink, row by row. BF_ENOMEM.
BF_MUST_CHECK bf_status sink_visit_cells(const scene_sink *sink, const bf_grid *grid,
                                         sink_visit *visit, void *context);

/// The sink that a part of a kind with its centre there is in; n_sinks: none.
size_t sink_at(const scene *s, vec2 at, size_t kind);
