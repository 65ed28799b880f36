/// Why a run fails whose parts are pressed too far into each other, or into a plate, in the words of those who plan.

#pragma once

#include "core/micro/press.h"
#include "core/scene/scene.h"

/// BF_ENUMERIC at the plate, if it moves, at the masses, if they differ by more than contacts of the hardness "auto" can follow,
/// else at the hardness of the parts: which part is pressed into what, where,
/// when (t, s), and what to change.
bf_status micro_press_fail(const scene *s, const micro_press *press, double t, bf_error *err);

/// A part that a step moved too far, m and m/s, as contacts that were pressed together threw it off.
typedef struct micro_thrown {
    uint64_t part; ///< id
    vec2 at;       ///< where it is, m
    double speed;  ///< m/s
} micro_thrown;

/// BF_ENUMERIC with the same at a plate that moves, if the part is within its diameter of where that comes to; else
/// what *err has.
bf_status micro_press_fail_thrown(const scene *s, const micro_thrown *thrown, double t,
                                  bf_error *err);
