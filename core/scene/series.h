/// A function of time as plain data.

#pragma once

#include <stddef.h>

/// A function of time by its values at some times.
typedef struct scene_series {
    size_t n_times;  ///< 0: there is none (default)
    double *times;   ///< s, >= 0, rising
    size_t n_values; ///< as many as there are times
    double *values;  ///< see the member's own description
    double repeat;   ///< s after which it begins again, >= the last time (default INFINITY: never)
} scene_series;
