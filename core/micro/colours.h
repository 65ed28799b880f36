/// Greedy colouring of the contacts of a Gauss-Seidel iteration: no part occurs twice in a colour, so that the contacts of a colour
/// may be solved in any order, many at once.

#pragma once

#include <stdint.h>

/// The first of n colours, 1 to 64, that neither of two parts has yet, by their sets of colours; both have it from now on. n: there
/// is none.
static inline uint32_t colours_take(uint64_t *a, uint64_t *b, uint32_t n)
{
    const uint64_t free = ~(*a | *b) & (UINT64_MAX >> (64 - n));

    if (free == 0)
        return n;
    const uint32_t colour = (uint32_t)__builtin_ctzll(free);
    *a |= UINT64_C(1) << colour;
    *b |= UINT64_C(1) << colour;
    return colour;
}
