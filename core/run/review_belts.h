/// Places at which cargo gets off the belts: there, the density stands still, parts glide on without friction, and what
/// leaves over a side of the domain counts as throughput.
///
/// Looked at are the borders of belts towards which a belt runs, where nothing lies beyond them: no belt, no side of the
/// domain, and no plate across the way.

#pragma once

#include "core/base/status.h"
#include "core/run/review.h"
#include "core/run/run.h"
#include "core/scene/scene.h"

/// Warn of each belt that ends where none goes on, of each gap between belts that the density does not cross, and of
/// parts that begin off every belt. Gaps below the smallest radius are none for parts, whose centres glide across. What takes
/// longer than a tenth of a second is left out. BF_ENOMEM.
BF_MUST_CHECK bf_status review_belts(const scene *s, run_model model, review_warnings *ret_warnings,
                                     bf_error *err);
