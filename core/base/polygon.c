#include "core/base/polygon.h"

#include <math.h>
#include <stdlib.h>

/// The place of the point of a segment that is nearest to start + to: 0 at start, 1 at start + along.
static double nearest_fraction(vec2 to, vec2 along)
{
    double square = vec2_dot(along, along);
    double fraction = square > 0.0 ? vec2_dot(to, along) / square : 0.0;

    return fmin(fmax(fraction, 0.0), 1.0);
}

double polygon_segment_distance(vec2 at, vec2 start, vec2 end)
{
    vec2 along = vec2_sub(end, start);
    vec2 to = vec2_sub(at, start);

    return vec2_length(vec2_sub(to, vec2_scale(along, nearest_fraction(to, along))));
}

vec2 polygon_segment_nearest(vec2 at, vec2 start, vec2 end)
{
    vec2 along = vec2_sub(end, start);

    return vec2_add(start, vec2_scale(along, nearest_fraction(vec2_sub(at, start), along)));
}

// Cuts the fractions [*from, *to] of a segment where start + fraction * step lies in [lower, upper].
static bool clip_axis(double start, double step, double lower, double upper, double *from,
                      double *to)
{
    if (step == 0.0)
        return start >= lower && start <= upper;
    double first = (lower - start) / step, last = (upper - start) / step;
    *from = fmax(*from, fmin(first, last));
    *to = fmin(*to, fmax(first, last));
    return *from <= *to;
}

// Liang and Barsky.
bool polygon_clip_segment(vec2 *start, vec2 *end, vec2 lower, vec2 upper)
{
    const vec2 along = vec2_sub(*end, *start);
    double from = 0.0, to = 1.0;

    if (!clip_axis(start->x, along.x, lower.x, upper.x, &from, &to) ||
        !clip_axis(start->y, along.y, lower.y, upper.y, &from, &to))
        return false;
    if (to < 1.0)
        *end = vec2_add(*start, vec2_scale(along, to));
    if (from > 0.0)
        *start = vec2_add(*start, vec2_scale(along, from));
    return true;
}

/// Distance of a point to the line through start and end, positive on the left.
static double measure_side(vec2 at, vec2 start, vec2 end)
{
    vec2 along = vec2_sub(end, start);
    double length = vec2_length(along);

    if (!(length > 0.0))
        return 0.0;
    return vec2_cross(along, vec2_sub(at, start)) / length;
}

static bool are_bounds_apart(double a0, double a1, double b0, double b1, double tolerance)
{
    return fmax(a0, a1) + tolerance < fmin(b0, b1) || fmax(b0, b1) + tolerance < fmin(a0, a1);
}

// Where all ends are farther than the tolerance from the other segment, crossing segments have their ends
// clearly on both sides of each other's line. An end whose side rounding leaves undecided lies beyond the other
// segment; then an end of that segment is near if the two cross at all.
bool polygon_segments_touch(vec2 a_start, vec2 a_end, vec2 b_start, vec2 b_end, double tolerance)
{
    if (are_bounds_apart(a_start.x, a_end.x, b_start.x, b_end.x, tolerance) ||
        are_bounds_apart(a_start.y, a_end.y, b_start.y, b_end.y, tolerance))
        return false;
    if (polygon_segment_distance(a_start, b_start, b_end) <= tolerance ||
        polygon_segment_distance(a_end, b_start, b_end) <= tolerance ||
        polygon_segment_distance(b_start, a_start, a_end) <= tolerance ||
        polygon_segment_distance(b_end, a_start, a_end) <= tolerance)
        return true;
    double side[4] = { measure_side(a_start, b_start, b_end), measure_side(a_end, b_start, b_end),
                       measure_side(b_start, a_start, a_end), measure_side(b_end, a_start, a_end) };
    for (int k = 0; k < 4; k++) {
        if (fabs(side[k]) <= tolerance)
            return false;
    }
    return (side[0] > 0.0) != (side[1] > 0.0) && (side[2] > 0.0) != (side[3] > 0.0);
}

bool polygon_holds(const vec2 *polygon, size_t n, vec2 at, double tolerance)
{
    bool is_inside = false;

    for (size_t k = 0, last = n - 1; k < n; last = k++) {
        vec2 a = polygon[last], b = polygon[k];
        if (!polygon_segment_is_far(at, a, b, tolerance) &&
            polygon_segment_distance(at, a, b) <= tolerance)
            return true;
        // A ray to the right crosses a side that has its ends on both sides of it.
        if ((a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x))
            is_inside = !is_inside;
    }
    return is_inside;
}

double polygon_area(const vec2 *polygon, size_t n)
{
    double twice = 0.0;

    for (size_t k = 1; k + 1 < n; k++)
        twice += vec2_cross(vec2_sub(polygon[k], polygon[0]), vec2_sub(polygon[k + 1], polygon[0]));
    return 0.5 * twice;
}

bool polygon_is_simple(const vec2 *polygon, size_t n, double tolerance)
{
    for (size_t k = 0; k < n; k++) {
        vec2 a = polygon[k], b = polygon[(k + 1) % n], c = polygon[(k + 2) % n];
        if (polygon_segment_distance(c, a, b) <= tolerance ||
            polygon_segment_distance(a, b, c) <= tolerance)
            return false;
        for (size_t m = k + 2; m < n; m++) {
            if ((m + 1) % n != k &&
                polygon_segments_touch(a, b, polygon[m], polygon[(m + 1) % n], tolerance))
                return false;
        }
    }
    return true;
}

bool polygon_is_convex(const vec2 *polygon, size_t n, double tolerance)
{
    for (size_t k = 0, last = n - 1; k < n; last = k++) {
        for (size_t m = 0; m < n; m++) {
            if (measure_side(polygon[m], polygon[last], polygon[k]) < -tolerance)
                return false;
        }
    }
    return polygon_area(polygon, n) > 0.0;
}

static int compare_points(const void *left, const void *right)
{
    const vec2 *a = left, *b = right;

    if (a->x != b->x)
        return a->x < b->x ? -1 : 1;
    return (a->y > b->y) - (a->y < b->y);
}

/// Drop corners from the end of a chain (down to n_least) that do not turn left towards next.
static size_t drop_right_turns(const vec2 *chain, size_t n, size_t n_least, vec2 next)
{
    while (n > n_least &&
           vec2_cross(vec2_sub(chain[n - 1], chain[n - 2]), vec2_sub(next, chain[n - 2])) <= 0.0)
        n--;
    return n;
}

size_t polygon_convex_hull(vec2 *points, size_t n, vec2 *ret_hull)
{
    size_t n_hull = 0, n_lower;

    qsort(points, n, sizeof *points, compare_points);
    if (n == 0 || compare_points(&points[0], &points[n - 1]) == 0) {
        if (n > 0)
            ret_hull[n_hull++] = points[0];
        return n_hull;
    }
    for (size_t k = 0; k < n; k++) {
        n_hull = drop_right_turns(ret_hull, n_hull, 1, points[k]);
        ret_hull[n_hull++] = points[k];
    }
    n_lower = n_hull;
    for (size_t k = n - 1; k-- > 0;) {
        n_hull = drop_right_turns(ret_hull, n_hull, n_lower, points[k]);
        if (k > 0)
            ret_hull[n_hull++] = points[k];
    }
    return n_hull;
}

/// True if all of b lies beyond the side of a from start to end.
static bool is_beyond(vec2 start, vec2 end, const vec2 *b, size_t n_b, double tolerance)
{
    const vec2 along = vec2_sub(end, start);
    const double length = vec2_length(along);
    bool is_beyond = true;

    for (size_t m = 0; m < n_b && is_beyond && length > 0.0; m++)
        is_beyond = vec2_cross(along, vec2_sub(b[m], start)) / length <= tolerance;
    return is_beyond;
}

/// True if some side of a has all of b beyond it.
static bool has_separating_side(const vec2 *a, size_t n_a, const vec2 *b, size_t n_b,
                                double tolerance)
{
    for (size_t k = 0, last = n_a - 1; k < n_a; last = k++) {
        if (is_beyond(a[last], a[k], b, n_b, tolerance))
            return true;
    }
    return false;
}

bool polygon_overlaps(const vec2 *a, size_t n_a, const vec2 *b, size_t n_b, double tolerance)
{
    return !has_separating_side(a, n_a, b, n_b, tolerance) &&
           !has_separating_side(b, n_b, a, n_a, tolerance);
}

/// The nearest corner of a to b, as far as it is nearer than *distance.
static void find_nearest_corner(const vec2 *a, size_t n_a, const vec2 *b, size_t n_b,
                                double *distance, vec2 *ret_on_a, vec2 *ret_on_b)
{
    for (size_t k = 0; k < n_a; k++) {
        for (size_t m = 0, last = n_b - 1; m < n_b; last = m++) {
            vec2 nearest = polygon_segment_nearest(a[k], b[last], b[m]);
            double length = vec2_length(vec2_sub(nearest, a[k]));
            if (length >= *distance)
                continue;
            *distance = length;
            *ret_on_a = a[k];
            *ret_on_b = nearest;
        }
    }
}

double polygon_distance(const vec2 *a, size_t n_a, const vec2 *b, size_t n_b, vec2 *ret_on_a,
                        vec2 *ret_on_b)
{
    double distance = INFINITY;

    if (polygon_overlaps(a, n_a, b, n_b, 0.0))
        return 0.0;
    find_nearest_corner(a, n_a, b, n_b, &distance, ret_on_a, ret_on_b);
    find_nearest_corner(b, n_b, a, n_a, &distance, ret_on_b, ret_on_a);
    return distance;
}

bool polygon_overlaps_disk(vec2 centre, double radius, const vec2 *polygon, size_t n,
                           double tolerance)
{
    bool is_inside = true, is_near = false;

    for (size_t k = 0; k < n; k++) {
        vec2 start = polygon[k], end = polygon[(k + 1) % n];
        is_inside = is_inside && vec2_cross(vec2_sub(end, start), vec2_sub(centre, start)) > 0.0;
        is_near = is_near || polygon_segment_distance(centre, start, end) < radius - tolerance;
    }
    return is_inside || is_near;
}
