// The Minkowski difference a - b of two hulls: the hulls overlap where it holds the origin.

#include "core/convex/convex_priv.h"

double minkowski__size(const gjk_pair *pair)
{
    return pair->a->radius + pair->b->radius + vec3_length(pair->translation);
}

minkowski__point minkowski__support(const gjk_pair *pair, vec3 d)
{
    size_t of_a = hull_support(pair->a, d);
    size_t of_b = hull_support(pair->b, mat3_apply_back(&pair->rotation, vec3_scale(d, -1.0)));
    vec3 at_b =
        vec3_add(mat3_apply(&pair->rotation, hull_vertex(pair->b, of_b)), pair->translation);

    return (minkowski__point){ vec3_sub(hull_vertex(pair->a, of_a), at_b), (uint8_t)of_a,
                               (uint8_t)of_b };
}

gjk_result minkowski__witnesses(const gjk_pair *pair, const minkowski__point *points,
                                const double *weights, int n)
{
    gjk_result touch = { .n_vertices = n };

    for (int k = 0; k < n; k++) {
        vec3 at_b = mat3_apply(&pair->rotation, hull_vertex(pair->b, points[k].of_b));
        touch.on_a = vec3_along(touch.on_a, weights[k], hull_vertex(pair->a, points[k].of_a));
        touch.on_b = vec3_along(touch.on_b, weights[k], vec3_add(at_b, pair->translation));
        touch.of_a[k] = points[k].of_a;
        touch.of_b[k] = points[k].of_b;
    }
    return touch;
}
