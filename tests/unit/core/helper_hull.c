#include "tests/unit/core/helper_hull.h"

#include "core/base/check.h"

#include <float.h>

double helper_hull_number(bf_random *random, double low, double high)
{
    return low + (high - low) * random_unit(random);
}

static vec3 point_in_ball(bf_random *random)
{
    vec3 at;

    do
        at = (vec3){ helper_hull_number(random, -1.0, 1.0), helper_hull_number(random, -1.0, 1.0),
                     helper_hull_number(random, -1.0, 1.0) };
    while (vec3_dot(at, at) > 1.0);
    return at;
}

mat3 helper_hull_rotation(bf_random *random)
{
    quat q;

    do
        q = (quat){ helper_hull_number(random, -1.0, 1.0), point_in_ball(random) };
    while (q.w * q.w + vec3_dot(q.v, q.v) > 1.0);
    return mat3_of_quat(quat_unit(q));
}

void helper_hull_random(bf_random *random, size_t n, double radius, hull *ret_hull)
{
    double points[HULL_POINTS_MAX][3];

    for (size_t k = 0; k < n; k++) {
        vec3 at = vec3_scale(point_in_ball(random), radius);
        points[k][0] = at.x;
        points[k][1] = at.y;
        points[k][2] = at.z;
    }
    if (n < 4)
        hull_set_points((const double(*)[3])points, n, ret_hull);
    else
        BF_CHECK(hull_from_points((const double(*)[3])points, n, ret_hull, NULL) == BF_OK);
}

void helper_hull_box(double length, double width, double height, hull *ret_hull)
{
    double x = 0.5 * length, y = 0.5 * width;
    const vec2 outline[] = { { -x, -y }, { x, -y }, { x, y }, { -x, y } };

    hull_from_outline(outline, 4, -0.5 * height, 0.5 * height, ret_hull);
}

/// Vertex k of b in a's frame.
static vec3 vertex_of_b(const gjk_pair *p, size_t k)
{
    return vec3_add(mat3_apply(&p->rotation, hull_vertex(p->b, k)), p->translation);
}

/// How far b begins beyond the end of a along a unit vector from a to b.
static double measure_gap(const gjk_pair *p, vec3 d)
{
    double end_a = -DBL_MAX, start_b = DBL_MAX;

    for (size_t k = 0; k < p->a->n_vertices; k++)
        end_a = fmax(end_a, vec3_dot(d, hull_vertex(p->a, k)));
    for (size_t k = 0; k < p->b->n_vertices; k++)
        start_b = fmin(start_b, vec3_dot(d, vertex_of_b(p, k)));
    return start_b - end_a;
}

static double largest_gap(const gjk_pair *p)
{
    double largest = -DBL_MAX;

    for (size_t f = 0; f < p->a->n_faces; f++)
        largest = fmax(largest, measure_gap(p, p->a->normal[f]));
    for (size_t f = 0; f < p->b->n_faces; f++)
        largest = fmax(largest,
                       measure_gap(p, vec3_scale(mat3_apply(&p->rotation, p->b->normal[f]), -1.0)));
    for (size_t i = 0; i < p->a->n_edges; i++) {
        vec3 of_a =
            vec3_sub(hull_vertex(p->a, p->a->edge[i].to), hull_vertex(p->a, p->a->edge[i].from));
        for (size_t j = 0; j < p->b->n_edges; j++) {
            vec3 of_b =
                vec3_sub(vertex_of_b(p, p->b->edge[j].to), vertex_of_b(p, p->b->edge[j].from));
            vec3 across = vec3_cross(of_a, of_b);
            if (vec3_length(across) < 1e-9 * vec3_length(of_a) * vec3_length(of_b))
                continue;
            across = vec3_unit(across);
            largest = fmax(largest, measure_gap(p, across));
            largest = fmax(largest, measure_gap(p, vec3_scale(across, -1.0)));
        }
    }
    return largest;
}

/// Distance from a point to a face, if its foot is in the face; else DBL_MAX.
static double to_face(vec3 at, const vec3 *corners, size_t n, vec3 normal)
{
    for (size_t k = 0; k < n; k++) {
        vec3 side = vec3_sub(corners[(k + 1) % n], corners[k]);
        if (vec3_dot(vec3_cross(side, vec3_sub(at, corners[k])), normal) < 0.0)
            return DBL_MAX;
    }
    return fabs(vec3_dot(normal, vec3_sub(at, corners[0])));
}

static double clamp(double t)
{
    return fmin(1.0, fmax(0.0, t));
}

static double between_segments(vec3 p, vec3 p_end, vec3 q, vec3 q_end)
{
    vec3 u = vec3_sub(p_end, p), v = vec3_sub(q_end, q), w = vec3_sub(p, q);
    double uu = vec3_dot(u, u), uv = vec3_dot(u, v), vv = vec3_dot(v, v), uw = vec3_dot(u, w);
    double vw = vec3_dot(v, w), nearest = DBL_MAX, det = uu * vv - uv * uv;
    const double tries[] = { 0.0, 1.0, det > 0.0 ? clamp((uv * vw - vv * uw) / det) : 0.0 };

    for (size_t k = 0; k < 3; k++) {
        double t = clamp((vw + uv * tries[k]) / vv), s = clamp((uv * t - uw) / uu);
        nearest = fmin(nearest, vec3_length(vec3_sub(vec3_along(p, s, u), vec3_along(q, t, v))));
    }
    return nearest;
}

static double least_distance(const gjk_pair *p)
{
    vec3 corners[HULL_VERTICES_MAX];
    double least = DBL_MAX;

    for (size_t f = 0; f < p->a->n_faces; f++) {
        size_t first = p->a->first[f], n = (size_t)(p->a->first[f + 1] - p->a->first[f]);
        for (size_t k = 0; k < n; k++)
            corners[k] = hull_vertex(p->a, p->a->corner[first + k]);
        for (size_t k = 0; k < p->b->n_vertices; k++)
            least = fmin(least, to_face(vertex_of_b(p, k), corners, n, p->a->normal[f]));
    }
    for (size_t f = 0; f < p->b->n_faces; f++) {
        size_t first = p->b->first[f], n = (size_t)(p->b->first[f + 1] - p->b->first[f]);
        for (size_t k = 0; k < n; k++)
            corners[k] = vertex_of_b(p, p->b->corner[first + k]);
        vec3 normal = mat3_apply(&p->rotation, p->b->normal[f]);
        for (size_t k = 0; k < p->a->n_vertices; k++)
            least = fmin(least, to_face(hull_vertex(p->a, k), corners, n, normal));
    }
    for (size_t i = 0; i < p->a->n_edges; i++)
        for (size_t j = 0; j < p->b->n_edges; j++)
            least = fmin(least, between_segments(hull_vertex(p->a, p->a->edge[i].from),
                                                 hull_vertex(p->a, p->a->edge[i].to),
                                                 vertex_of_b(p, p->b->edge[j].from),
                                                 vertex_of_b(p, p->b->edge[j].to)));
    return least;
}

double helper_hull_distance(const gjk_pair *pair)
{
    double gap = largest_gap(pair);

    return gap <= 0.0 ? gap : least_distance(pair);
}
