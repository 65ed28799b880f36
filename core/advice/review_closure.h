/// Members of a document that do nothing, or not what they say: warnings about the closure of the macroscopic model and its
/// cells.

#pragma once

#include "core/advice/review.h"
#include "core/scene/scene.h"

/// Warn of each member with another value than its default that the scenario's closure does not use, and of a cell that
/// is fitted to the domain by more than a tenth. For a resolved scenario.
void review_closure(const scene *s, review_warnings *ret_warnings);
