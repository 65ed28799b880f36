// The least depth of two hulls among all directions that can have it: the normals of their faces and the cross
// products of their edges (separating axis theorem).

#include "core/convex/convex_priv.h"

/// Sine of the angle below which edges are parallel. A direction at right angles to both is then a face's normal,
/// to this angle.
#define PARALLEL 1e-6

/// Relative to the size of the difference: what edges must gain over faces, whose region has more points.
#define GAIN 1e-10

/// True if the hulls are farther apart, or less deep in each other, along a direction of length 1 than along the
/// best so far by `gain`, which it then is, with the vertices that are farthest along it.
static bool try_direction(const gjk_pair *pair, vec3 normal, double gain, gjk_result *best)
{
    minkowski__point p = minkowski__support(pair, normal);
    double gap = -vec3_dot(p.at, normal);

    if (gap <= best->distance + gain)
        return false;
    *best = minkowski__witnesses(pair, &p, (double[]){ 1.0 }, 1);
    best->distance = gap;
    best->normal = normal;
    return true;
}

static vec3 vertex_of_b(const gjk_pair *pair, size_t k)
{
    return vec3_add(mat3_apply(&pair->rotation, hull_vertex(pair->b, k)), pair->translation);
}

/// The witness is the point of a's edge that is nearest to the other edge's line.
static void try_edges(const gjk_pair *pair, const hull_edge *of_a, const hull_edge *of_b,
                      gjk_result *best)
{
    vec3 p = hull_vertex(pair->a, of_a->from), u = vec3_sub(hull_vertex(pair->a, of_a->to), p);
    vec3 q = vertex_of_b(pair, of_b->from), v = vec3_sub(vertex_of_b(pair, of_b->to), q);
    vec3 across = vec3_cross(u, v), to = vec3_sub(q, p);
    vec3 outward = vec3_add(pair->a->normal[of_a->left], pair->a->normal[of_a->right]);
    double length = vec3_length(across), gain = GAIN * minkowski__size(pair);

    if (length <= PARALLEL * vec3_length(u) * vec3_length(v))
        return;
    vec3 normal = vec3_scale(across, (vec3_dot(across, outward) < 0.0 ? -1.0 : 1.0) / length);
    // A direction in which other vertices are farther than these edges is not theirs.
    double between = vec3_dot(normal, to);
    if (between <= best->distance + gain ||
        between + vec3_dot(minkowski__support(pair, normal).at, normal) > gain ||
        !try_direction(pair, normal, gain, best))
        return;
    double s = vec3_dot(vec3_cross(to, v), across) / (length * length);
    best->on_a = vec3_along(p, fmin(fmax(s, 0.0), 1.0), u);
    best->on_b = vec3_along(best->on_a, best->distance, normal);
    best->n_vertices = 2;
    best->of_a[0] = of_a->from;
    best->of_a[1] = of_a->to;
    best->of_b[0] = of_b->from;
    best->of_b[1] = of_b->to;
}

void features__search(const gjk_pair *pair, gjk_result *touch)
{
    // The witnesses are the deepest vertex of the other hull and its foot on the face.
    for (size_t face = 0; face < pair->a->n_faces; face++)
        if (try_direction(pair, pair->a->normal[face], 0.0, touch))
            touch->on_a = vec3_along(touch->on_b, -touch->distance, touch->normal);
    for (size_t face = 0; face < pair->b->n_faces; face++) {
        vec3 inward = vec3_scale(pair->b->normal[face], -1.0);
        if (try_direction(pair, mat3_apply(&pair->rotation, inward), 0.0, touch))
            touch->on_b = vec3_along(touch->on_a, touch->distance, touch->normal);
    }
    for (size_t i = 0; i < pair->a->n_edges; i++)
        for (size_t j = 0; j < pair->b->n_edges; j++)
            try_edges(pair, &pair->a->edge[i], &pair->b->edge[j], touch);
}
