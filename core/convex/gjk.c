// A simplex of at most four points of a - b moves towards the origin. Each iteration adds the farthest point
// towards the origin and retains the corners that the nearest point depends on.

#include "core/convex/gjk.h"

#include "core/convex/convex_priv.h"

#include <float.h>

enum { ROUNDS_MAX = 128 };

/// Relative to the size of the difference: a gain of less is rounding.
#define ROUNDING 1e-14

/// Relative to the same: a distance and the gap along its normal differ by less.
#define AGREEMENT 1e-9

gjk_pair gjk_pair_of(const hull *a, vec3 x_a, const mat3 *r_a, const hull *b, vec3 x_b,
                     const mat3 *r_b)
{
    return (gjk_pair){ a, b, mat3_between(r_a, r_b), mat3_apply_back(r_a, vec3_sub(x_b, x_a)) };
}

/// Reduce to corner i, corners i and j, or i, j and k, with their weights.
static void select_one(gjk__simplex *s, int i)
{
    *s = (gjk__simplex){ 1, { s->point[i] }, { 1.0 } };
}

static void reduce_segment(gjk__simplex *s, int i, int j)
{
    vec3 along = vec3_sub(s->point[j].at, s->point[i].at);
    double length_squared = vec3_dot(along, along), t = -vec3_dot(s->point[i].at, along);

    if (t <= 0.0 || length_squared == 0.0) {
        select_one(s, i);
    } else if (t >= length_squared) {
        select_one(s, j);
    } else {
        const double weight_j = t / length_squared;
        *s = (gjk__simplex){ 2, { s->point[i], s->point[j] }, { 1.0 - weight_j, weight_j } };
    }
}

/// Reduce to the part of triangle i, j, k that is nearest to the origin, by the regions around it.
static void reduce_triangle(gjk__simplex *s, int i, int j, int k)
{
    vec3 a = s->point[i].at, b = s->point[j].at, c = s->point[k].at;
    vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), normal = vec3_cross(ab, ac);
    double area = vec3_dot(normal, normal);
    // Weights by areas: each vanishes on the side opposite its corner.
    double u = vec3_dot(vec3_cross(b, c), normal);
    double v = vec3_dot(vec3_cross(c, a), normal);
    double w = vec3_dot(vec3_cross(a, b), normal);

    if (area > 0.0 && u > 0.0 && v > 0.0 && w > 0.0) {
        double sum = u + v + w;
        *s = (gjk__simplex){ 3,
                             { s->point[i], s->point[j], s->point[k] },
                             { u / sum, v / sum, w / sum } };
        return;
    }
    const int sides[3][2] = { { i, j }, { j, k }, { i, k } };
    double nearest = DBL_MAX;
    gjk__simplex best = *s;
    for (int side = 0; side < 3; side++) {
        gjk__simplex trial = *s;
        reduce_segment(&trial, sides[side][0], sides[side][1]);
        vec3 at = vec3_scale(trial.point[0].at, trial.weight[0]);
        if (trial.n == 2)
            at = vec3_along(at, trial.weight[1], trial.point[1].at);
        if (vec3_dot(at, at) < nearest) {
            nearest = vec3_dot(at, at);
            best = trial;
        }
    }
    *s = best;
}

static vec3 nearest_point(const gjk__simplex *s)
{
    vec3 at = { 0.0, 0.0, 0.0 };

    for (int k = 0; k < s->n; k++)
        at = vec3_along(at, s->weight[k], s->point[k].at);
    if (s->n != 3)
        return at;
    // The projection of the origin on the plane has less rounding error than the sum.
    vec3 a = s->point[0].at;
    vec3 normal = vec3_cross(vec3_sub(s->point[1].at, a), vec3_sub(s->point[2].at, a));
    return vec3_scale(normal, vec3_dot(normal, a) / vec3_dot(normal, normal));
}

/// Reduce a tetrahedron to its nearest face, or leave it if the origin is inside.
static void reduce_tetrahedron(gjk__simplex *s)
{
    static const int faces[4][4] = {
        { 0, 1, 2, 3 }, { 0, 2, 3, 1 }, { 0, 3, 1, 2 }, { 1, 3, 2, 0 }
    };
    gjk__simplex best = *s;
    double nearest = DBL_MAX;

    for (int face = 0; face < 4; face++) {
        const int *corner = faces[face];
        vec3 a = s->point[corner[0]].at;
        vec3 normal =
            vec3_cross(vec3_sub(s->point[corner[1]].at, a), vec3_sub(s->point[corner[2]].at, a));
        double inside = vec3_dot(normal, vec3_sub(s->point[corner[3]].at, a));
        double origin = -vec3_dot(normal, a);
        if (inside != 0.0 && inside * origin > 0.0)
            continue;
        gjk__simplex trial = *s;
        reduce_triangle(&trial, corner[0], corner[1], corner[2]);
        vec3 at = nearest_point(&trial);
        if (vec3_dot(at, at) < nearest) {
            nearest = vec3_dot(at, at);
            best = trial;
        }
    }
    *s = best;
}

static void reduce(gjk__simplex *s)
{
    switch (s->n) {
    case 1:
        s->weight[0] = 1.0;
        break;
    case 2:
        reduce_segment(s, 1, 0);
        break;
    case 3:
        reduce_triangle(s, 0, 1, 2);
        break;
    default:
        reduce_tetrahedron(s);
        break;
    }
}

static bool has_point(const gjk__simplex *s, const minkowski__point *p)
{
    for (int k = 0; k < s->n; k++)
        if (s->point[k].of_a == p->of_a && s->point[k].of_b == p->of_b)
            return true;
    return false;
}

/// Search from direction *axis. True if the hulls touch or overlap. If they are apart *axis is set to the direction of the last
/// iteration, and *ret_gap to their distance along it; with `hurried` the search ends at any separating
/// direction instead of the one of the largest gap.
static bool search(const gjk_pair *pair, bool hurried, vec3 *axis, gjk__simplex *ret_simplex,
                   double *ret_gap)
{
    double size = minkowski__size(pair), nearest = DBL_MAX;
    gjk__simplex s = { .n = 0 };

    *ret_gap = 0.0;
    for (int round = 0; round < ROUNDS_MAX; round++) {
        minkowski__point p = minkowski__support(pair, *axis);
        double beyond = vec3_dot(p.at, *axis), length = vec3_length(*axis);
        *ret_gap = -beyond / length;
        // With *axis = -v: v.v - v.p is the largest possible gain of the iteration, times |v|.
        if ((hurried && beyond < 0.0) ||
            (round > 0 &&
             (has_point(&s, &p) || length * length + beyond <= ROUNDING * size * length)))
            break;
        gjk__simplex grown = s;
        grown.point[grown.n++] = p;
        reduce(&grown);
        vec3 v = grown.n == 4 ? (vec3){ 0.0, 0.0, 0.0 } : nearest_point(&grown);
        double distance = vec3_length(v);
        if (distance >= nearest)
            break;
        s = grown;
        nearest = distance;
        if (s.n == 4 || distance <= ROUNDING * size) {
            *ret_simplex = s;
            return true;
        }
        *axis = vec3_scale(v, -1.0);
    }
    *ret_simplex = s;
    return false;
}

double gjk_find_gap(const gjk_pair *pair, vec3 *axis)
{
    gjk__simplex simplex;
    vec3 start = *axis;
    double gap;

    if (search(pair, true, &start, &simplex, &gap) || gap <= 0.0)
        return 0.0;
    *axis = start;
    return gap;
}

gjk_result gjk_measure(const gjk_pair *pair, vec3 axis)
{
    gjk__simplex simplex;
    gjk_result touch;
    double gap;

    if (search(pair, false, &axis, &simplex, &gap)) {
        touch = epa__penetrate(pair, &simplex, axis);
        gap = -vec3_dot(minkowski__support(pair, touch.normal).at, touch.normal);
    } else {
        touch = minkowski__witnesses(pair, simplex.point, simplex.weight, simplex.n);
        touch.distance = vec3_length(axis);
        touch.normal = vec3_scale(axis, 1.0 / touch.distance);
    }
    // Hulls that touch flush but for rounding may leave a simplex without area, whose normal is any.
    if (!(fabs(touch.distance - gap) <= AGREEMENT * minkowski__size(pair))) {
        touch.distance = gap;
        features__search(pair, &touch);
    }
    return touch;
}
