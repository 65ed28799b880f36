/// What ends a run of the microscopic solver whose parts are too soft for their load.

#pragma once

#include "core/micro/micro.h"

/// Where parts are pressed into something by more than overlap_limit.
typedef struct micro_press {
    double overlap; ///< largest overlap of a step divided by the smaller part's radius
    uint64_t part;  ///< id
    uint64_t other; ///< id of the other part; UINT64_MAX: it is a plate or a wall
    vec2 at;        ///< centre of the part, m
} micro_press;

/// False: no overlap was beyond overlap_limit.
bool micro_press_now(const micro_solver *s, micro_press *ret_press);
