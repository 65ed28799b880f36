/// Bisection in n numbers that do not fall, which stand `stride` bytes apart: members of an array of structs, or doubles in a row.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// How many of them are less than a value, or, if `with_equal`, at most that.
static inline size_t search_count(const double *numbers, size_t stride, size_t n, double value,
                                  bool with_equal)
{
    size_t low = 0, high = n;

    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const double number = *(const double *)((const char *)numbers + middle * stride);
        if (number < value || (with_equal && number == value))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// Index of the last of them that is at most a value; 0 if none is.
static inline size_t search_last(const double *numbers, size_t stride, size_t n, double value)
{
    const size_t count = search_count(numbers, stride, n, value, true);

    return count > 0 ? count - 1 : 0;
}
