/// Vectors and points in the plane of the belts.

#pragma once

#include <math.h>

/// A vector or a point.
typedef struct vec2 {
    double x; ///< along the belt (x1)
    double y; ///< across it (x2)
} vec2;

/// Sum, difference, multiple, inner product and cross product (z component) of vectors.
static inline vec2 vec2_add(vec2 a, vec2 b)
{
    return (vec2){ a.x + b.x, a.y + b.y };
}

static inline vec2 vec2_sub(vec2 a, vec2 b)
{
    return (vec2){ a.x - b.x, a.y - b.y };
}

static inline vec2 vec2_scale(vec2 a, double factor)
{
    return (vec2){ a.x * factor, a.y * factor };
}

static inline double vec2_dot(vec2 a, vec2 b)
{
    return a.x * b.x + a.y * b.y;
}

static inline double vec2_cross(vec2 a, vec2 b)
{
    return a.x * b.y - a.y * b.x;
}

/// Length of a vector, by sqrt alone: the same bits on every processor, and |(x, 0)| = |x| exactly.
static inline double vec2_length(vec2 a)
{
    return sqrt(vec2_dot(a, a));
}

/// The point at a part of the way from a to b: a at 0, b at 1.
static inline vec2 vec2_between(vec2 a, vec2 b, double part)
{
    return vec2_add(a, vec2_scale(vec2_sub(b, a), part));
}

/// a turned left by a right angle.
static inline vec2 vec2_turn_left(vec2 a)
{
    return (vec2){ -a.y, a.x };
}
