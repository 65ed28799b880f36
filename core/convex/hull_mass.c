// Mass properties of a hull: integrals over tetrahedra from one of its vertices to its faces.

#include "core/convex/hull.h"

#include <math.h>

enum { SWEEPS_MAX = 32 };

/// Relative to the largest entry of a tensor: what is smaller off the diagonal is rounding.
#define ROUNDING 1e-13

/// Integrals of 1, of p and of the products of p's components over a body.
typedef struct moments {
    double volume;
    vec3 first;
    mat3 second;
} moments;

static void add_products(mat3 *m, double factor, vec3 a)
{
    m->row[0] = vec3_along(m->row[0], factor * a.x, a);
    m->row[1] = vec3_along(m->row[1], factor * a.y, a);
    m->row[2] = vec3_along(m->row[2], factor * a.z, a);
}

/// Add the tetrahedron of the origin, a, b and c.
static void add_tetrahedron(moments *m, vec3 a, vec3 b, vec3 c)
{
    double sixfold = vec3_dot(a, vec3_cross(b, c));
    vec3 sum = vec3_add(a, vec3_add(b, c));

    m->volume += sixfold / 6.0;
    m->first = vec3_along(m->first, sixfold / 24.0, sum);
    add_products(&m->second, sixfold / 120.0, sum);
    add_products(&m->second, sixfold / 120.0, a);
    add_products(&m->second, sixfold / 120.0, b);
    add_products(&m->second, sixfold / 120.0, c);
}

hull_mass hull_measure(const hull *h)
{
    moments m = { 0 };
    vec3 apex = hull_vertex(h, 0);

    for (size_t face = 0; face < h->n_faces; face++) {
        const uint8_t *corner = &h->corner[h->first[face]];
        size_t n = (size_t)(h->first[face + 1] - h->first[face]);
        for (size_t k = 1; k + 1 < n; k++)
            add_tetrahedron(&m, vec3_sub(hull_vertex(h, corner[0]), apex),
                            vec3_sub(hull_vertex(h, corner[k]), apex),
                            vec3_sub(hull_vertex(h, corner[k + 1]), apex));
    }
    vec3 centre = vec3_scale(m.first, 1.0 / m.volume);
    add_products(&m.second, -m.volume, centre);
    double trace = m.second.row[0].x + m.second.row[1].y + m.second.row[2].z;
    hull_mass mass = { m.volume, vec3_add(apex, centre), m.second };
    for (int k = 0; k < 3; k++)
        mass.inertia.row[k] = vec3_scale(m.second.row[k], -1.0 / m.volume);
    mass.inertia.row[0].x += trace / m.volume;
    mass.inertia.row[1].y += trace / m.volume;
    mass.inertia.row[2].z += trace / m.volume;
    return mass;
}

/// Turn rows and columns p and q of a so that a[p][q] = 0, and the columns of axes with them.
static void rotate(double a[3][3], double axes[3][3], int p, int q)
{
    double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
    double c = 1.0 / sqrt(t * t + 1.0), s = t * c;

    for (int k = 0; k < 3; k++) {
        double left = a[k][p], right = a[k][q];
        a[k][p] = c * left - s * right;
        a[k][q] = s * left + c * right;
    }
    for (int k = 0; k < 3; k++) {
        double left = a[p][k], right = a[q][k];
        a[p][k] = c * left - s * right;
        a[q][k] = s * left + c * right;
        left = axes[k][p];
        right = axes[k][q];
        axes[k][p] = c * left - s * right;
        axes[k][q] = s * left + c * right;
    }
}

mat3 hull_principal_axes(const mat3 *inertia, vec3 *ret_moments)
{
    double a[3][3], axes[3][3] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } };
    double scale = 0.0;

    for (int k = 0; k < 3; k++) {
        for (int m = 0; m < 3; m++)
            a[k][m] = vec3_component(inertia->row[k], m);
        scale = fmax(scale, fabs(a[k][k]));
    }
    for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++)
                if (fabs(a[p][q]) > ROUNDING * scale)
                    rotate(a, axes, p, q);
    }
    *ret_moments = (vec3){ a[0][0], a[1][1], a[2][2] };
    return (mat3){ { { axes[0][0], axes[0][1], axes[0][2] },
                     { axes[1][0], axes[1][1], axes[1][2] },
                     { axes[2][0], axes[2][1], axes[2][2] } } };
}
