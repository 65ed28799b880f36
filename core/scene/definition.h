/// The digest of what a scenario defines: equal where every number is. Checkpoints of a run belong to it. Names and ids have
/// no part in it, but for those of feeds, of which draws depend.

#pragma once

#include "core/scene/types.h"

/// A whole resolved scenario.
uint64_t definition_digest(const scene *s);
