/// Why a run fails whose parts are pressed too far into each other, or into a plate, in the words of those who plan.

#pragma once

#include "core/micro/press.h"
#include "core/scene/scene.h"

/// BF_ENUMERIC at the plate, if it moves, at the masses, if they differ by more than contacts of the hardness "auto" can follow,
/// else at the hardness of the parts: which part is pressed into what, where,
/// when (t, s), and what to change.
bf_status micro_press_fail(const scene *s, const micro_press *press, double t, bf_error *err);
