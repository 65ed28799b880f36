/// Vectors, rotations and quaternions in space, for the inner loops of the spatial path.
///
/// A mat3 that is a rotation takes coordinates of a body to those of the world: world = r body. A
/// quaternion (w, x, y, z) is the same rotation by mat3_of_quat().

#pragma once

#include <math.h>

/// A vector or a point.
typedef struct vec3 {
    double x; ///< along the belt
    double y; ///< across it
    double z; ///< upwards
} vec3;

/// A matrix by its rows.
typedef struct mat3 {
    vec3 row[3]; ///< row k gives component k of a product
} mat3;

/// A quaternion; a unit one is a rotation.
typedef struct quat {
    double w; ///< real part
    vec3 v;   ///< imaginary part
} quat;

/// Sum, difference, multiple, inner product and cross product of vectors.
static inline vec3 vec3_add(vec3 a, vec3 b)
{
    return (vec3){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline vec3 vec3_sub(vec3 a, vec3 b)
{
    return (vec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline vec3 vec3_scale(vec3 a, double factor)
{
    return (vec3){ a.x * factor, a.y * factor, a.z * factor };
}

static inline double vec3_dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vec3 vec3_cross(vec3 a, vec3 b)
{
    return (vec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/// a + factor b.
static inline vec3 vec3_along(vec3 a, double factor, vec3 b)
{
    return (vec3){ a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z };
}

/// Length of a vector.
static inline double vec3_length(vec3 a)
{
    return sqrt(vec3_dot(a, a));
}

/// The vector of length 1 in the direction of a, which must not be 0.
static inline vec3 vec3_unit(vec3 a)
{
    return vec3_scale(a, 1.0 / vec3_length(a));
}

/// A unit vector at right angles to the unit vector a.
static inline vec3 vec3_aside(vec3 a)
{
    vec3 axis = fabs(a.x) < 0.6 ? (vec3){ 1.0, 0.0, 0.0 } : (vec3){ 0.0, 1.0, 0.0 };

    return vec3_unit(vec3_cross(a, axis));
}

/// m a.
static inline vec3 mat3_apply(const mat3 *m, vec3 a)
{
    return (vec3){ vec3_dot(m->row[0], a), vec3_dot(m->row[1], a), vec3_dot(m->row[2], a) };
}

/// The transpose of m times a: for a rotation, from the world into the body.
static inline vec3 mat3_apply_back(const mat3 *m, vec3 a)
{
    return (vec3){ m->row[0].x * a.x + m->row[1].x * a.y + m->row[2].x * a.z,
                   m->row[0].y * a.x + m->row[1].y * a.y + m->row[2].y * a.z,
                   m->row[0].z * a.x + m->row[1].z * a.y + m->row[2].z * a.z };
}

/// Component k = 0, 1, 2 of a.
static inline double vec3_component(vec3 a, int k)
{
    return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

/// Column k of m: for a rotation, axis k of the body in the world.
static inline vec3 mat3_column(const mat3 *m, int k)
{
    return (vec3){ vec3_component(m->row[0], k), vec3_component(m->row[1], k),
                   vec3_component(m->row[2], k) };
}

/// The transpose of a times b: for rotations, b as seen from a.
static inline mat3 mat3_between(const mat3 *a, const mat3 *b)
{
    mat3 between;

    for (int k = 0; k < 3; k++) {
        vec3 axis = mat3_column(a, k);
        between.row[k] = mat3_apply_back(b, axis);
    }
    return between;
}

/// Product of quaternions: the rotation b, then a.
static inline quat quat_multiply(quat a, quat b)
{
    vec3 across = vec3_cross(a.v, b.v);

    return (quat){ a.w * b.w - vec3_dot(a.v, b.v),
                   vec3_along(vec3_along(across, a.w, b.v), b.w, a.v) };
}

/// The inverse of a unit quaternion.
static inline quat quat_conjugate(quat q)
{
    return (quat){ q.w, { -q.v.x, -q.v.y, -q.v.z } };
}

/// q divided by its length.
static inline quat quat_unit(quat q)
{
    double factor = 1.0 / sqrt(q.w * q.w + vec3_dot(q.v, q.v));

    return (quat){ q.w * factor, vec3_scale(q.v, factor) };
}

/// The rotation of a unit quaternion.
static inline mat3 mat3_of_quat(quat q)
{
    double x = q.v.x, y = q.v.y, z = q.v.z, w = q.w;

    return (
        mat3){ { { 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y) },
                 { 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x) },
                 { 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y) } } };
}

/// The unit quaternion of a rotation.
static inline quat quat_of_mat3(const mat3 *m)
{
    double xx = m->row[0].x, yy = m->row[1].y, zz = m->row[2].z, trace = xx + yy + zz;
    vec3 odd = { m->row[2].y - m->row[1].z, m->row[0].z - m->row[2].x, m->row[1].x - m->row[0].y };
    double xy = m->row[0].y + m->row[1].x, xz = m->row[0].z + m->row[2].x;
    double yz = m->row[1].z + m->row[2].y;
    quat q;

    // Four times the square of the component that is largest, so that no rounding is blown up.
    if (trace >= fmax(xx, fmax(yy, zz)))
        q = (quat){ 1.0 + trace, odd };
    else if (xx >= yy && xx >= zz)
        q = (quat){ odd.x, { 1.0 + xx - yy - zz, xy, xz } };
    else if (yy >= zz)
        q = (quat){ odd.y, { xy, 1.0 + yy - xx - zz, yz } };
    else
        q = (quat){ odd.z, { xz, yz, 1.0 + zz - xx - yy } };
    return quat_unit(q);
}
