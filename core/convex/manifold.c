#include "core/convex/manifold.h"

#include <math.h>
#include <string.h>

/// Cosine of the angle below which a normal is that of a face.
#define SAME_DIRECTION (1.0 - 1e-10)

/// Sine of the angle below which edges are parallel and span no plane.
#define PARALLEL 1e-6

/// The deepest point of the region may lie this fraction of the depth above the deepest vertex, which
/// may extend over the side of the reference.
#define OVERHANG 0.02

/// Fraction of `near`: what was clipped off at that distance cannot come into contact any more.
#define COMING 0.999

/// Cosine of the angle between a normal and faces that are about parallel to the contact.
#define NEARLY_OPPOSED 0.95

/// Weight of crossing edges.
#define CROSSING 0.25

/// A polygon.
typedef struct ring {
    size_t n;
    vec3 at[MANIFOLD_POINTS_MAX];
} ring;

/// Clip by a plane: the part with inward . p >= offset remains.
static void clip(ring *polygon, vec3 inward, double offset)
{
    double height[MANIFOLD_POINTS_MAX];
    bool is_cut = false;
    ring from;

    for (size_t k = 0; k < polygon->n; k++) {
        height[k] = vec3_dot(inward, polygon->at[k]) - offset;
        is_cut |= height[k] < 0.0;
    }
    if (!is_cut)
        return;
    from.n = polygon->n;
    memcpy(from.at, polygon->at, polygon->n * sizeof *from.at);
    polygon->n = 0;
    // Rounding may bend a polygon inwards; it has no more corners than there is room for.
    for (size_t k = 0, last = from.n - 1; k < from.n && polygon->n + 2 <= MANIFOLD_POINTS_MAX;
         last = k++) {
        if ((height[k] < 0.0) != (height[last] < 0.0)) {
            double weight = height[last] / (height[last] - height[k]);
            polygon->at[polygon->n++] =
                vec3_along(from.at[last], weight, vec3_sub(from.at[k], from.at[last]));
        }
        if (height[k] >= 0.0)
            polygon->at[polygon->n++] = from.at[k];
    }
}

/// A face of a hull at shift with rotation turn.
static void take_face(const hull *h, size_t face, const mat3 *turn, vec3 shift, ring *ret_ring)
{
    ret_ring->n = 0;
    for (size_t k = h->first[face]; k < h->first[face + 1]; k++)
        ret_ring->at[ret_ring->n++] =
            vec3_add(mat3_apply(turn, hull_vertex(h, h->corner[k])), shift);
}

/// All corners of a polygon as points below a plane, with their weights; normal points out of the
/// solid. No depth is less than `least`.
static void weigh_points(const ring *polygon, vec3 normal, double offset, double least,
                         manifold_point *ret_points)
{
    const size_t n = polygon->n;
    double outline = 0.0;
    double side_last = vec3_length(vec3_sub(polygon->at[0], polygon->at[n - 1]));

    for (size_t k = 0; k < n; k++) {
        vec3 at = polygon->at[k], next = polygon->at[k + 1 < n ? k + 1 : 0];
        double depth = offset - vec3_dot(normal, at);
        double side = vec3_length(vec3_sub(next, at));
        depth = depth > least ? depth : least;
        ret_points[k] =
            (manifold_point){ vec3_along(at, 0.5 * depth, normal), depth, side_last + side };
        outline += side_last + side;
        side_last = side;
    }
    for (size_t k = 0; k < n; k++)
        ret_points[k].weight = outline > 0.0 ? ret_points[k].weight / outline : 1.0 / (double)n;
}

/// Add the corners of the polygon that are above the plane by less than near.
static void add_coming(ring *polygon, vec3 normal, double offset, double near, manifold *m)
{
    manifold_point points[MANIFOLD_POINTS_MAX];

    clip(polygon, vec3_scale(normal, -1.0), -offset - near);
    if (polygon->n == 0)
        return;
    weigh_points(polygon, normal, offset, -HUGE_VAL, points);
    for (size_t k = 0; k < polygon->n && m->n < MANIFOLD_POINTS_MAX; k++)
        if (points[k].depth <= 0.0 && points[k].depth > -COMING * near)
            m->point[m->n++] = points[k];
}

/// Points and weights of the part of the polygon that is below a plane, and of the part near it.
static void take_points(ring *polygon, vec3 normal, double offset, double near, manifold *m)
{
    m->n = 0;
    if (m->depth > 0.0) {
        ring below = { .n = polygon->n };
        memcpy(below.at, polygon->at, polygon->n * sizeof *below.at);
        clip(&below, vec3_scale(normal, -1.0), -offset);
        if (below.n > 0)
            weigh_points(&below, normal, offset, 0.0, m->point);
        m->n = below.n;
    }
    m->n_below = m->n;
    if (near > 0.0 && polygon->n > 0)
        add_coming(polygon, normal, offset, near, m);
}

/// True if the deepest point of the region is about as deep as that of the hull.
static bool is_deepest(const manifold *m, double near)
{
    double deepest = m->depth > 0.0 ? 0.0 : -HUGE_VAL;

    for (size_t k = 0; k < m->n; k++)
        deepest = m->point[k].depth > deepest ? m->point[k].depth : deepest;
    return deepest >= (m->depth > 0.0 ? (1.0 - OVERHANG) * m->depth : m->depth - OVERHANG * near);
}

/// The region at a face of one hull, in its frame; the other is at shift with rotation turn. The
/// normal points out of the face.
static void find_at_face(const hull *h, size_t face, const hull *other, const mat3 *turn,
                         vec3 shift, double near, manifold *m)
{
    vec3 normal = h->normal[face];
    vec3 against = mat3_apply_back(turn, vec3_scale(normal, -1.0));
    size_t vertex = hull_support(other, against);
    vec3 at = vec3_add(mat3_apply(turn, hull_vertex(other, vertex)), shift);
    ring polygon;

    m->normal = normal;
    m->depth = h->offset[face] - vec3_dot(normal, at);
    m->n = m->n_below = 0;
    m->is_least = true;
    if (m->depth <= -near)
        return;
    take_face(other, hull_facing(other, vertex, against), turn, shift, &polygon);
    // Clip by the planes through the sides of a face.
    size_t first = h->first[face], last = h->first[face + 1];
    for (size_t k = first; k < last && polygon.n > 0; k++) {
        vec3 start = hull_vertex(h, h->corner[k]);
        vec3 end = hull_vertex(h, h->corner[k + 1 < last ? k + 1 : first]);
        vec3 inward = vec3_cross(h->normal[face], vec3_sub(end, start));
        clip(&polygon, inward, vec3_dot(inward, start));
    }
    take_points(&polygon, normal, h->offset[face], near, m);
    m->is_least = m->n > 0 && is_deepest(m, near);
}

/// True if n, at right angles to the edge between two faces, is between their normals.
static bool is_between(vec3 along, vec3 left, vec3 right, vec3 n)
{
    // left x right points along the edge.
    return vec3_dot(vec3_cross(left, n), along) >= 0.0 &&
           vec3_dot(vec3_cross(n, right), along) >= 0.0;
}

static void find_at_edges(const gjk_pair *pair, const hull_edge *of_a, const hull_edge *of_b,
                          double near, manifold *m)
{
    const hull *a = pair->a, *b = pair->b;
    vec3 p = hull_vertex(a, of_a->from), u = vec3_sub(hull_vertex(a, of_a->to), p);
    vec3 q = vec3_add(mat3_apply(&pair->rotation, hull_vertex(b, of_b->from)), pair->translation);
    vec3 q_end = vec3_add(mat3_apply(&pair->rotation, hull_vertex(b, of_b->to)), pair->translation);
    vec3 v = vec3_sub(q_end, q), across = vec3_cross(u, v);
    double length = vec3_length(across);

    m->normal = a->normal[of_a->left];
    m->n = m->n_below = 0;
    m->depth = -near;
    m->is_least = false;
    if (length <= PARALLEL * vec3_length(u) * vec3_length(v))
        return;
    vec3 outward = vec3_add(a->normal[of_a->left], a->normal[of_a->right]);
    m->normal = vec3_scale(across, (vec3_dot(across, outward) < 0.0 ? -1.0 : 1.0) / length);
    vec3 to = vec3_sub(q, p);
    m->depth = -vec3_dot(m->normal, to);
    // Where the lines come nearest: p + s u and q + t v.
    double s = vec3_dot(vec3_cross(to, v), across) / (length * length);
    double t = vec3_dot(vec3_cross(to, u), across) / (length * length);
    vec3 against = mat3_apply_back(&pair->rotation, vec3_scale(m->normal, -1.0));
    vec3 v_own = vec3_sub(hull_vertex(b, of_b->to), hull_vertex(b, of_b->from));
    m->is_least = s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0 &&
                  is_between(u, a->normal[of_a->left], a->normal[of_a->right], m->normal) &&
                  is_between(v_own, b->normal[of_b->left], b->normal[of_b->right], against);
    if (m->depth <= -near || !m->is_least)
        return;
    m->n = 1;
    m->n_below = m->depth > 0.0 ? 1 : 0;
    m->point[0] = (manifold_point){ vec3_along(vec3_along(p, s, u), -0.5 * m->depth, m->normal),
                                    m->depth, CROSSING };
}

void manifold_find(const gjk_pair *pair, manifold_feature feature, double near,
                   manifold *ret_manifold)
{
    if (feature.kind == MANIFOLD_FACE_A) {
        find_at_face(pair->a, feature.of_a, pair->b, &pair->rotation, pair->translation, near,
                     ret_manifold);
    } else if (feature.kind == MANIFOLD_FACE_B) {
        static const mat3 still = { { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } } };
        mat3 back = mat3_between(&pair->rotation, &still);
        vec3 shift = vec3_scale(mat3_apply(&back, pair->translation), -1.0);
        find_at_face(pair->b, feature.of_b, pair->a, &back, shift, near, ret_manifold);
        // Turn a region from b's frame, where its normal points to a, into a's.
        ret_manifold->normal = mat3_apply(&pair->rotation, vec3_scale(ret_manifold->normal, -1.0));
        for (size_t k = 0; k < ret_manifold->n; k++)
            ret_manifold->point[k].at =
                vec3_add(mat3_apply(&pair->rotation, ret_manifold->point[k].at), pair->translation);
    } else {
        find_at_edges(pair, &pair->a->edge[feature.of_a], &pair->b->edge[feature.of_b], near,
                      ret_manifold);
    }
}

void manifold_from_result(const gjk_result *touch, manifold *ret_manifold)
{
    ret_manifold->normal = touch->normal;
    ret_manifold->depth = -touch->distance;
    ret_manifold->is_least = true;
    ret_manifold->n = 1;
    ret_manifold->n_below = touch->distance < 0.0 ? 1 : 0;
    ret_manifold->point[0] = (manifold_point){ vec3_scale(vec3_add(touch->on_a, touch->on_b), 0.5),
                                               -touch->distance, CROSSING };
}

/// The face whose normal is nearest to direction d.
static size_t find_facing(const hull *h, vec3 d, double *ret_facing)
{
    size_t found = 0;

    *ret_facing = -2.0;
    for (size_t face = 0; face < h->n_faces; face++) {
        double facing = vec3_dot(h->normal[face], d);
        if (facing > *ret_facing) {
            *ret_facing = facing;
            found = face;
        }
    }
    return found;
}

/// The edge of a hull between two of the vertices listed. Returns false if there is none.
static bool find_edge(const hull *h, const uint8_t *vertices, int n, uint16_t *ret_edge)
{
    for (size_t e = 0; e < h->n_edges; e++) {
        bool has_from = false, has_to = false;
        for (int k = 0; k < n; k++) {
            has_from |= vertices[k] == h->edge[e].from;
            has_to |= vertices[k] == h->edge[e].to;
        }
        if (has_from && has_to) {
            *ret_edge = (uint16_t)e;
            return true;
        }
    }
    return false;
}

manifold_feature manifold_feature_of(const gjk_pair *pair, const gjk_result *touch)
{
    vec3 against = mat3_apply_back(&pair->rotation, vec3_scale(touch->normal, -1.0));
    double facing_a, facing_b;
    manifold_feature feature = { MANIFOLD_EDGES, 0, 0 };
    uint16_t face_a = (uint16_t)find_facing(pair->a, touch->normal, &facing_a);
    uint16_t face_b = (uint16_t)find_facing(pair->b, against, &facing_b);

    if (fmax(facing_a, facing_b) < SAME_DIRECTION &&
        find_edge(pair->a, touch->of_a, touch->n_vertices, &feature.of_a) &&
        find_edge(pair->b, touch->of_b, touch->n_vertices, &feature.of_b))
        return feature;
    if (facing_a >= SAME_DIRECTION || facing_a >= facing_b)
        return (manifold_feature){ MANIFOLD_FACE_A, face_a, 0 };
    return (manifold_feature){ MANIFOLD_FACE_B, 0, face_b };
}

void manifold_widen(const gjk_pair *pair, double near, manifold *m)
{
    const vec3 normal = m->normal;
    const vec3 against = mat3_apply_back(&pair->rotation, vec3_scale(normal, -1.0));
    double facing_a, facing_b;
    const size_t face_a = find_facing(pair->a, normal, &facing_a);
    const size_t face_b = find_facing(pair->b, against, &facing_b);
    const bool is_of_a = facing_a >= facing_b;
    const double facing = is_of_a ? facing_a : facing_b;
    const manifold_feature face = { is_of_a ? MANIFOLD_FACE_A : MANIFOLD_FACE_B, (uint16_t)face_a,
                                    (uint16_t)face_b };
    manifold region;

    if (fmin(facing_a, facing_b) < NEARLY_OPPOSED)
        return;
    manifold_find(pair, face, near, &region);
    double deepest = -HUGE_VAL;
    for (size_t k = 0; k < region.n; k++) {
        region.point[k].depth /= facing;
        deepest = fmax(deepest, region.point[k].depth);
    }
    if (deepest < m->depth - OVERHANG * near)
        return;
    m->n = region.n;
    m->n_below = region.n_below;
    memcpy(m->point, region.point, region.n * sizeof *region.point);
}

void manifold_on_plane(const hull *h, vec3 x, const mat3 *r, const manifold_plane *plane,
                       double near, manifold *ret_manifold)
{
    vec3 against = mat3_apply_back(r, vec3_scale(plane->normal, -1.0));
    size_t vertex = hull_support(h, against);
    vec3 at = vec3_add(mat3_apply(r, hull_vertex(h, vertex)), x);
    ring polygon;

    ret_manifold->normal = plane->normal;
    ret_manifold->depth = plane->offset - vec3_dot(plane->normal, at);
    ret_manifold->is_least = true;
    ret_manifold->n = ret_manifold->n_below = 0;
    if (ret_manifold->depth <= -near)
        return;
    take_face(h, hull_facing(h, vertex, against), r, x, &polygon);
    if (plane->half_length > 0.0) {
        double middle = vec3_dot(plane->along, plane->middle);
        clip(&polygon, plane->along, middle - plane->half_length);
        clip(&polygon, vec3_scale(plane->along, -1.0), -middle - plane->half_length);
    }
    take_points(&polygon, plane->normal, plane->offset, near, ret_manifold);
    ret_manifold->is_least = is_deepest(ret_manifold, near);
}
