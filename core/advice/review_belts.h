/// Places at which cargo gets off the belts (surroundings.h) and falls, and belts that no cargo can come to.
///
/// Looked at are the borders of belts towards which a belt runs, where nothing lies beyond them: no belt, no gap that the
/// smallest part bridges, no side of the domain, and no plate across the way.

#pragma once

#include "core/advice/review.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

/// Warn of each belt that ends where none goes on, and of parts that begin off every belt. What takes longer than a tenth
/// of a second is left out. BF_ENOMEM.
BF_MUST_CHECK bf_status review_belts(const scene *s, review_warnings *ret_warnings, bf_error *err);

/// Warn of each belt no section of which reaches into the domain.
void review_belts_outside(const scene *s, review_warnings *ret_warnings);
