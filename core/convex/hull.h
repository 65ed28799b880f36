/// Convex bodies as hulls of points: faces, edges, the farthest point in a direction, and the mass
/// properties of a uniform body: volume, centre of mass, tensor of inertia and principal axes.
///
/// Units    m; inertia is per mass, m2.
/// Layout   corners of a face run counter-clockwise as seen from outside; those of face f are
///          corner[k] for first[f] <= k < first[f + 1]. Faces are whole: no two of them lie in one
///          plane.

#pragma once

#include "core/base/status.h"
#include "core/base/vec2.h"
#include "core/base/vec3.h"

#include <stddef.h>
#include <stdint.h>

enum {
    HULL_POINTS_MAX = 64, ///< points that a hull is made of, corners of an outline
    HULL_VERTICES_MAX = 2 * HULL_POINTS_MAX,    ///< a prism has its outline twice
    HULL_FACES_MAX = 2 * HULL_VERTICES_MAX - 4, ///< by Euler's formula, all triangles
    HULL_EDGES_MAX = 3 * HULL_VERTICES_MAX - 6, ///< same
    HULL_CORNERS_MAX = 2 * HULL_EDGES_MAX,      ///< of all faces together
    HULL_LANES = 8,                             ///< vertices are padded to a multiple of this
    HULL_CYLINDER_SIDES = 32,                   ///< the polygon that stands for a circle
};

/// An edge between two faces.
typedef struct hull_edge {
    uint8_t from;  ///< vertex
    uint8_t to;    ///< vertex
    uint8_t left;  ///< face whose corners run from `from` to `to`
    uint8_t right; ///< face on the other side
} hull_edge;

/// A hull. One without faces (hull_set_points()) is a cloud of points that stands for their hull:
/// enough for gjk.h, whatever its dimension.
typedef struct hull {
    size_t n_vertices;                        ///< 1 to HULL_VERTICES_MAX
    _Alignas(64) double x[HULL_VERTICES_MAX]; ///< of the vertices; then vertex 0 as padding
    _Alignas(64) double y[HULL_VERTICES_MAX]; ///< same
    _Alignas(64) double z[HULL_VERTICES_MAX]; ///< same
    size_t n_faces;                           ///< 0, or 4 and more
    vec3 normal[HULL_FACES_MAX];              ///< of faces, outward, of length 1
    double offset[HULL_FACES_MAX];            ///< normal . p for points p of the face
    uint16_t first[HULL_FACES_MAX + 1];       ///< see Layout
    uint8_t corner[HULL_CORNERS_MAX];         ///< vertices, see Layout
    size_t n_edges;                           ///< each once
    hull_edge edge[HULL_EDGES_MAX];           ///< see there
    uint16_t around[HULL_VERTICES_MAX + 1];   ///< faces around vertex k: fan[around[k]] and on
    uint8_t fan[HULL_CORNERS_MAX];            ///< faces, see around
    double radius;                            ///< of the ball around the origin that holds it
} hull;

/// Mass properties of a uniform body of mass 1 in the shape of a hull.
typedef struct hull_mass {
    double volume; ///< m3
    vec3 centre;   ///< of mass, m
    mat3 inertia;  ///< about the centre, per mass, m2
} hull_mass;

/// Vertex k.
static inline vec3 hull_vertex(const hull *h, size_t k)
{
    return (vec3){ h->x[k], h->y[k], h->z[k] };
}

/// The points alone, 1 to HULL_VERTICES_MAX of them, without faces.
void hull_set_points(const double (*points)[3], size_t n, hull *ret_hull);

/// The convex hull of 4 to HULL_POINTS_MAX points; those inside it, or inside a face or an edge,
/// are dropped. BF_EINPUT: they enclose no volume, or so little that faces cannot be distinguished.
BF_MUST_CHECK bf_status hull_from_points(const double (*points)[3], size_t n, hull *ret_hull,
                                         bf_error *err);

/// An upright prism on a convex counter-clockwise outline of 3 to HULL_POINTS_MAX corners
/// without straight ones, from z = bottom to z = top.
void hull_from_outline(const vec2 *outline, size_t n, double bottom, double top, hull *ret_hull);

/// An upright cylinder around the origin as a prism of HULL_CYLINDER_SIDES sides, whose corners lie on the
/// circle.
void hull_from_cylinder(double radius, double height, hull *ret_hull);

/// Volume, centre of mass and inertia of a hull with faces.
hull_mass hull_measure(const hull *h);

/// Diagonalise a symmetric matrix. The columns of the result, a rotation, are its axes; the
/// identity if it is diagonal to rounding. *ret_moments are its eigenvalues in the same order.
mat3 hull_principal_axes(const mat3 *inertia, vec3 *ret_moments);

/// Change to the frame with its origin in centre and its axes the columns of axes.
void hull_move(hull *h, vec3 centre, const mat3 *axes);

/// A vertex that is farthest in direction d, the first one of several.
size_t hull_support(const hull *h, vec3 d);

/// Of the faces around a vertex the one whose normal is nearest to direction d.
size_t hull_facing(const hull *h, size_t vertex, vec3 d);
