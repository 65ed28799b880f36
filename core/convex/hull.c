#include "core/convex/hull.h"

#include "core/base/check.h"
#include "core/base/polygon.h"

#include <float.h>
#include <stdbool.h>
#include <string.h>

/// Relative to the size of the hull: what is nearer to a plane or a line lies in it.
#define FLAT 1e-9

void hull_set_points(const double (*points)[3], size_t n, hull *ret_hull)
{
    BF_CHECK(n >= 1 && n <= HULL_VERTICES_MAX);
    memset(ret_hull, 0, sizeof *ret_hull);
    ret_hull->n_vertices = n;
    for (size_t k = 0; k < HULL_VERTICES_MAX; k++) {
        const double *at = points[k < n ? k : 0];
        ret_hull->x[k] = at[0];
        ret_hull->y[k] = at[1];
        ret_hull->z[k] = at[2];
        ret_hull->radius = fmax(ret_hull->radius, vec3_length((vec3){ at[0], at[1], at[2] }));
    }
}

/// Largest side of the box around the vertices.
static double measure_extent(const hull *h)
{
    vec3 low = hull_vertex(h, 0), high = low;

    for (size_t k = 1; k < h->n_vertices; k++) {
        vec3 at = hull_vertex(h, k);
        low = (vec3){ fmin(low.x, at.x), fmin(low.y, at.y), fmin(low.z, at.z) };
        high = (vec3){ fmax(high.x, at.x), fmax(high.y, at.y), fmax(high.z, at.z) };
    }
    return fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
}

/// Plane of the face that was added last, by Newell's sum, which is accurate with short sides.
static void set_plane(hull *h, size_t face)
{
    size_t first = h->first[face], last = h->first[face + 1];
    vec3 anchor = hull_vertex(h, h->corner[first]), sum = { 0.0, 0.0, 0.0 };
    double offset = 0.0;

    for (size_t k = first + 1; k + 1 < last; k++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(hull_vertex(h, h->corner[k]), anchor),
                                       vec3_sub(hull_vertex(h, h->corner[k + 1]), anchor)));
    h->normal[face] = vec3_unit(sum);
    for (size_t k = first; k < last; k++)
        offset += vec3_dot(h->normal[face], hull_vertex(h, h->corner[k]));
    h->offset[face] = offset / (double)(last - first);
}

static void begin_face(hull *h)
{
    h->first[h->n_faces + 1] = h->first[h->n_faces];
}

static void add_corner(hull *h, size_t vertex)
{
    h->corner[h->first[h->n_faces + 1]++] = (uint8_t)vertex;
}

static void end_face(hull *h)
{
    set_plane(h, h->n_faces);
    h->n_faces++;
}

/// The face whose corners run from one vertex to another; n_faces if there is none.
static size_t find_face(const hull *h, uint8_t from, uint8_t to)
{
    for (size_t face = 0; face < h->n_faces; face++) {
        size_t first = h->first[face], last = h->first[face + 1];
        for (size_t k = first; k < last; k++) {
            size_t next = k + 1 < last ? k + 1 : first;
            if (h->corner[k] == from && h->corner[next] == to)
                return face;
        }
    }
    return h->n_faces;
}

/// Record every edge once, and the faces around every vertex. Returns false if the faces do not close
/// up.
static bool find_edges(hull *h)
{
    for (size_t face = 0; face < h->n_faces; face++) {
        size_t first = h->first[face], last = h->first[face + 1];
        for (size_t k = first; k < last; k++) {
            uint8_t from = h->corner[k], to = h->corner[k + 1 < last ? k + 1 : first];
            size_t other = find_face(h, to, from);
            if (other == h->n_faces || other == face)
                return false;
            if (from < to)
                h->edge[h->n_edges++] = (hull_edge){ from, to, (uint8_t)face, (uint8_t)other };
        }
    }
    uint16_t n = 0;
    for (size_t k = 0; k < h->n_vertices; k++) {
        h->around[k] = n;
        for (size_t face = 0; face < h->n_faces; face++)
            for (size_t m = h->first[face]; m < h->first[face + 1]; m++)
                if (h->corner[m] == k)
                    h->fan[n++] = (uint8_t)face;
    }
    h->around[h->n_vertices] = n;
    return 2 * h->n_edges == h->first[h->n_faces] && h->n_vertices + h->n_faces == h->n_edges + 2;
}

void hull_from_outline(const vec2 *outline, size_t n, double bottom, double top, hull *ret_hull)
{
    double points[HULL_VERTICES_MAX][3];

    BF_CHECK(n >= 3 && n <= HULL_POINTS_MAX);
    for (size_t k = 0; k < n; k++) {
        memcpy(points[k], (double[]){ outline[k].x, outline[k].y, bottom }, sizeof points[k]);
        memcpy(points[n + k], (double[]){ outline[k].x, outline[k].y, top }, sizeof points[k]);
    }
    hull_set_points((const double(*)[3])points, 2 * n, ret_hull);
    begin_face(ret_hull);
    for (size_t k = n; k-- > 0;)
        add_corner(ret_hull, k);
    end_face(ret_hull);
    begin_face(ret_hull);
    for (size_t k = 0; k < n; k++)
        add_corner(ret_hull, n + k);
    end_face(ret_hull);
    for (size_t k = 0; k < n; k++) {
        size_t next = (k + 1) % n;
        begin_face(ret_hull);
        add_corner(ret_hull, k);
        add_corner(ret_hull, next);
        add_corner(ret_hull, n + next);
        add_corner(ret_hull, n + k);
        end_face(ret_hull);
    }
    BF_CHECK(find_edges(ret_hull));
}

/// True if vertex k lies on the line between two others.
static bool is_between(const hull *h, size_t k, double tolerance)
{
    vec3 at = hull_vertex(h, k);

    for (size_t i = 0; i < h->n_vertices; i++) {
        for (size_t j = i + 1; j < h->n_vertices; j++) {
            if (i == k || j == k)
                continue;
            vec3 from = hull_vertex(h, i), along = vec3_sub(hull_vertex(h, j), from);
            vec3 to = vec3_sub(at, from);
            double length = vec3_length(along), weight = vec3_dot(to, along) / (length * length);
            if (weight > 0.0 && weight < 1.0 &&
                vec3_length(vec3_cross(to, along)) <= tolerance * length)
                return true;
        }
    }
    return false;
}

static void drop_straight(hull *h, double tolerance)
{
    double kept[HULL_VERTICES_MAX][3];

    for (size_t k = h->n_vertices; k-- > 0;) {
        size_t n_kept = 0;
        if (!is_between(h, k, tolerance))
            continue;
        for (size_t m = 0; m < h->n_vertices; m++)
            if (m != k)
                memcpy(kept[n_kept++], (double[]){ h->x[m], h->y[m], h->z[m] }, sizeof kept[0]);
        hull_set_points((const double(*)[3])kept, n_kept, h);
    }
}

/// True if all vertices lie on one side of the plane of i < j < k, which are the first three of it,
/// so that each face is found once. *ret_normal points outward; marks the vertices of the plane.
static bool is_face(const hull *h, size_t i, size_t j, size_t k, double tolerance, vec3 *ret_normal,
                    bool *ret_is_in_plane)
{
    vec3 anchor = hull_vertex(h, i);
    vec3 across =
        vec3_cross(vec3_sub(hull_vertex(h, j), anchor), vec3_sub(hull_vertex(h, k), anchor));
    double length = vec3_length(across);
    bool has_above = false, has_below = false;

    if (!(length > tolerance * tolerance))
        return false;
    vec3 normal = vec3_scale(across, 1.0 / length);
    for (size_t m = 0; m < h->n_vertices; m++) {
        double height = vec3_dot(normal, vec3_sub(hull_vertex(h, m), anchor));
        ret_is_in_plane[m] = m == i || m == j || m == k || fabs(height) <= tolerance;
        has_above |= !ret_is_in_plane[m] && height > 0.0;
        has_below |= !ret_is_in_plane[m] && height < 0.0;
        if ((has_above && has_below) || (ret_is_in_plane[m] && m < k && m != i && m != j))
            return false;
    }
    *ret_normal = has_above ? vec3_scale(normal, -1.0) : normal;
    return has_above || has_below;
}

/// Add the face of the marked vertices, in order.
static void add_face(hull *h, const bool *is_in_plane, vec3 normal)
{
    vec2 points[HULL_VERTICES_MAX], at[HULL_VERTICES_MAX], ring[HULL_VERTICES_MAX + 1];
    vec3 u = vec3_aside(normal), v = vec3_cross(normal, u);
    size_t n = 0;

    for (size_t k = 0; k < h->n_vertices; k++) {
        at[k] = (vec2){ vec3_dot(u, hull_vertex(h, k)), vec3_dot(v, hull_vertex(h, k)) };
        if (is_in_plane[k])
            points[n++] = at[k];
    }
    size_t n_ring = polygon_convex_hull(points, n, ring);
    begin_face(h);
    for (size_t m = 0; m < n_ring; m++)
        for (size_t k = 0; k < h->n_vertices; k++)
            if (is_in_plane[k] && at[k].x == ring[m].x && at[k].y == ring[m].y)
                add_corner(h, k);
    end_face(h);
}

/// Find all faces. Returns false if there are more than a hull can have.
static bool find_faces(hull *h, double tolerance)
{
    bool is_in_plane[HULL_VERTICES_MAX];
    vec3 normal;

    for (size_t i = 0; i < h->n_vertices; i++) {
        for (size_t j = i + 1; j < h->n_vertices; j++) {
            for (size_t k = j + 1; k < h->n_vertices; k++) {
                if (!is_face(h, i, j, k, tolerance, &normal, is_in_plane))
                    continue;
                if (h->n_faces == 2 * h->n_vertices - 4)
                    return false;
                if (h->first[h->n_faces] + h->n_vertices > HULL_CORNERS_MAX)
                    return false;
                add_face(h, is_in_plane, normal);
            }
        }
    }
    return h->n_faces >= 4;
}

/// Remove the vertices that are corners of no face, and renumber the others.
static void drop_inner(hull *h)
{
    static const size_t nowhere = HULL_VERTICES_MAX;
    size_t number[HULL_VERTICES_MAX], n = 0;

    for (size_t k = 0; k < h->n_vertices; k++)
        number[k] = nowhere;
    for (size_t m = 0; m < h->first[h->n_faces]; m++)
        number[h->corner[m]] = 0;
    for (size_t k = 0; k < h->n_vertices; k++) {
        if (number[k] == nowhere)
            continue;
        number[k] = n;
        h->x[n] = h->x[k];
        h->y[n] = h->y[k];
        h->z[n] = h->z[k];
        n++;
    }
    for (size_t m = 0; m < h->first[h->n_faces]; m++)
        h->corner[m] = (uint8_t)number[h->corner[m]];
    h->n_vertices = n;
    for (size_t k = n; k < HULL_VERTICES_MAX; k++) {
        h->x[k] = h->x[0];
        h->y[k] = h->y[0];
        h->z[k] = h->z[0];
    }
}

bf_status hull_from_points(const double (*points)[3], size_t n, hull *ret_hull, bf_error *err)
{
    hull h;

    BF_CHECK(n >= 1 && n <= HULL_POINTS_MAX);
    hull_set_points(points, n, &h);
    double tolerance = FLAT * measure_extent(&h);
    drop_straight(&h, tolerance);
    bool is_closed = h.n_vertices >= 4 && find_faces(&h, tolerance);
    if (is_closed)
        drop_inner(&h);
    if (!is_closed || !find_edges(&h))
        return bf_fail(err, BF_EINPUT, "",
                       "is degenerate: the faces of the hull cannot be told apart");
    *ret_hull = h;
    return BF_OK;
}

void hull_from_cylinder(double radius, double height, hull *ret_hull)
{
    vec2 outline[HULL_CYLINDER_SIDES];

    for (size_t k = 0; k < HULL_CYLINDER_SIDES; k++) {
        double angle = 2.0 * M_PI * ((double)k + 0.5) / (double)HULL_CYLINDER_SIDES;
        outline[k] = (vec2){ radius * cos(angle), radius * sin(angle) };
    }
    hull_from_outline(outline, HULL_CYLINDER_SIDES, -0.5 * height, 0.5 * height, ret_hull);
}

void hull_move(hull *h, vec3 centre, const mat3 *axes)
{
    h->radius = 0.0;
    for (size_t k = 0; k < HULL_VERTICES_MAX; k++) {
        vec3 at = mat3_apply_back(axes, vec3_sub(hull_vertex(h, k), centre));
        h->x[k] = at.x;
        h->y[k] = at.y;
        h->z[k] = at.z;
        h->radius = fmax(h->radius, vec3_length(at));
    }
    for (size_t face = 0; face < h->n_faces; face++)
        set_plane(h, face);
}

size_t hull_support(const hull *h, vec3 d)
{
    _Alignas(64) double along[HULL_VERTICES_MAX];
    double best[HULL_LANES];
    size_t n = (h->n_vertices + HULL_LANES - 1) / HULL_LANES * HULL_LANES, found = 0;

    for (size_t lane = 0; lane < HULL_LANES; lane++)
        best[lane] = -DBL_MAX;
    for (size_t k = 0; k < n; k += HULL_LANES) {
        for (size_t lane = 0; lane < HULL_LANES; lane++) {
            double r = d.x * h->x[k + lane] + d.y * h->y[k + lane] + d.z * h->z[k + lane];
            along[k + lane] = r;
            best[lane] = r > best[lane] ? r : best[lane];
        }
    }
    for (size_t lane = 1; lane < HULL_LANES; lane++)
        best[0] = best[lane] > best[0] ? best[lane] : best[0];
    while (found + 1 < h->n_vertices && along[found] != best[0])
        found++;
    return found;
}

size_t hull_facing(const hull *h, size_t vertex, vec3 d)
{
    size_t found = h->fan[h->around[vertex]];
    double best = vec3_dot(h->normal[found], d);

    for (size_t k = h->around[vertex] + 1u; k < h->around[vertex + 1]; k++) {
        double facing = vec3_dot(h->normal[h->fan[k]], d);
        if (facing > best) {
            best = facing;
            found = h->fan[k];
        }
    }
    return found;
}
