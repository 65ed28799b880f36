#include "tests/reference/direct.h"

#include "tests/reference/schedule.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct direct {
    macro_def def;
    int n1, n2, reach1, reach2;
    double *rho, *other; // n1 * n2
    double *begin;       // n1 * n2
    double *c1, *c2;     // (2 S1 + 1) (2 S2 + 1) cell integrals of the mollifier's gradient
    double *i1, *i2;     // I at (i + 1/2, j) and (i, j + 1/2), i, j >= -1
    double *v1, *v2;     // copies of the definition's arrays
    uint8_t *closed1, *closed2;
    uint16_t *belt1, *belt2;
    unsigned long steps;
};

static double normal_density(double sigma, double x)
{
    return sqrt(sigma / (2.0 * M_PI)) * exp(-0.5 * sigma * x * x);
}

static double normal_share(double sigma, double a, double b)
{
    return 0.5 * (erf(b * sqrt(sigma / 2.0)) - erf(a * sqrt(sigma / 2.0)));
}

static void fill_integrals(direct *d)
{
    const double sigma = d->def.mollifier, d1 = d->def.grid.d1, d2 = d->def.grid.d2;

    for (int p = -d->reach1; p <= d->reach1; p++)
        for (int q = -d->reach2; q <= d->reach2; q++) {
            int at = (p + d->reach1) * (2 * d->reach2 + 1) + q + d->reach2;
            d->c1[at] = (normal_density(sigma, (p + 1) * d1) - normal_density(sigma, p * d1)) *
                        normal_share(sigma, (q - 0.5) * d2, (q + 0.5) * d2);
            d->c2[at] = normal_share(sigma, (p - 0.5) * d1, (p + 0.5) * d1) *
                        (normal_density(sigma, (q + 1) * d2) - normal_density(sigma, q * d2));
        }
}

static int reach_of(double sigma, double edge)
{
    return (int)ceil(4.0 / (sqrt(sigma) * edge) - 1e-9);
}

static void *copy_of(const void *from, size_t n, size_t size)
{
    void *to = calloc(n, size);
    if (from != NULL && to != NULL)
        memcpy(to, from, n * size);
    return to;
}

direct *direct_create(const macro_def *def)
{
    direct *d = calloc(1, sizeof *d);
    if (d == NULL)
        return NULL;
    d->def = *def;
    d->n1 = (int)def->grid.n1;
    d->n2 = (int)def->grid.n2;
    d->reach1 = reach_of(def->mollifier, def->grid.d1);
    d->reach2 = reach_of(def->mollifier, def->grid.d2);
    size_t cells = (size_t)d->n1 * (size_t)d->n2;
    size_t faces1 = (size_t)(d->n1 + 1) * (size_t)d->n2;
    size_t faces2 = (size_t)d->n1 * (size_t)(d->n2 + 1);
    size_t taps = (size_t)(2 * d->reach1 + 1) * (size_t)(2 * d->reach2 + 1);
    size_t corners = (size_t)(d->n1 + 1) * (size_t)(d->n2 + 1);
    d->rho = calloc(cells, sizeof(double));
    d->other = calloc(cells, sizeof(double));
    d->begin = calloc(cells, sizeof(double));
    d->c1 = calloc(taps, sizeof(double));
    d->c2 = calloc(taps, sizeof(double));
    d->i1 = calloc(corners, sizeof(double));
    d->i2 = calloc(corners, sizeof(double));
    d->v1 = copy_of(def->faces[0].v, faces1, sizeof(double));
    d->v2 = copy_of(def->faces[1].v, faces2, sizeof(double));
    d->closed1 = copy_of(def->faces[0].closed, faces1, 1);
    d->closed2 = copy_of(def->faces[1].closed, faces2, 1);
    d->belt1 = copy_of(def->faces[0].belt, faces1, sizeof(uint16_t));
    d->belt2 = copy_of(def->faces[1].belt, faces2, sizeof(uint16_t));
    if (d->rho == NULL || d->other == NULL || d->begin == NULL || d->c1 == NULL || d->c2 == NULL ||
        d->i1 == NULL || d->i2 == NULL || d->v1 == NULL || d->v2 == NULL || d->closed1 == NULL ||
        d->closed2 == NULL || d->belt1 == NULL || d->belt2 == NULL)
        return direct_destroy(d);
    fill_integrals(d);
    return d;
}

direct *direct_destroy(direct *d)
{
    if (d == NULL)
        return NULL;
    free(d->rho);
    free(d->other);
    free(d->begin);
    free(d->c1);
    free(d->c2);
    free(d->i1);
    free(d->i2);
    free(d->v1);
    free(d->v2);
    free(d->closed1);
    free(d->closed2);
    free(d->belt1);
    free(d->belt2);
    free(d);
    return NULL;
}

void direct_set_density(direct *d, const double *rho)
{
    memcpy(d->rho, rho, (size_t)d->n1 * (size_t)d->n2 * sizeof *rho);
}

// The index that the convolution reads at k of n, or -1 for zero.
static int seen(int k, int n, bool mirror_below, bool mirror_above)
{
    if (k < 0)
        return mirror_below && -1 - k < n ? -1 - k : -1;
    if (k >= n)
        return mirror_above && 2 * n - 1 - k >= 0 ? 2 * n - 1 - k : -1;
    return k;
}

static void sum_gradient(const direct *d, int i, int j, double *ret_d1, double *ret_d2)
{
    double d1 = 0.0, d2 = 0.0;

    for (int q = -d->reach2; q <= d->reach2; q++) {
        int row = seen(j - q, d->n2, d->def.mirror[2], d->def.mirror[3]);
        if (row < 0)
            continue;
        for (int p = -d->reach1; p <= d->reach1; p++) {
            int column = seen(i - p, d->n1, d->def.mirror[0], d->def.mirror[1]);
            if (column < 0)
                continue;
            int at = (p + d->reach1) * (2 * d->reach2 + 1) + q + d->reach2;
            d1 += d->rho[row * d->n1 + column] * d->c1[at];
            d2 += d->rho[row * d->n1 + column] * d->c2[at];
        }
    }
    *ret_d1 = d1;
    *ret_d2 = d2;
}

static void fill_push(direct *d)
{
    for (int j = -1; j < d->n2; j++)
        for (int i = -1; i < d->n1; i++) {
            double d1, d2;
            sum_gradient(d, i, j, &d1, &d2);
            double root = sqrt(1.0 + d1 * d1 + d2 * d2);
            d->i1[(j + 1) * (d->n1 + 1) + i + 1] = -d->def.dispersion * d1 / root;
            d->i2[(j + 1) * (d->n1 + 1) + i + 1] = -d->def.dispersion * d2 / root;
        }
}

static double h_rho(const direct *d, double rho)
{
    switch (d->def.heaviside) {
    case SCENE_HEAVISIDE_SHARP:
        return rho >= 1.0 ? rho : 0.0;
    case SCENE_HEAVISIDE_SMOOTH:
        return rho * (0.5 + atan((rho - 1.0) / d->def.heaviside_width) / M_PI);
    default:
        return rho;
    }
}

// The factor of the speed of the belt under a face.
static double factor(const direct *d, uint16_t belt)
{
    return belt < d->def.n_belts ? schedule_mean(&d->def.belts[belt], d->steps, d->def.dt) : 1.0;
}

static double flux(const direct *d, double near, double far, double v, double dispersion,
                   bool closed)
{
    if (closed)
        return 0.0;
    return (v >= 0.0 ? near : far) * v +
           (dispersion >= 0.0 ? h_rho(d, near) : h_rho(d, far)) * dispersion;
}

// The density of a cell; outside the grid there is nothing.
static double at(const direct *d, const double *rho, int i, int j)
{
    return i < 0 || i >= d->n1 || j < 0 || j >= d->n2 ? 0.0 : rho[j * d->n1 + i];
}

// The flux through the face east or north of cell (i, j), of the densities before and after it.
static double flux1(const direct *d, double near, double far, int i, int j)
{
    int face = j * (d->n1 + 1) + i + 1;
    double f = factor(d, d->belt1[face]);

    return flux(d, near, far, f * d->v1[face], f * d->i1[(j + 1) * (d->n1 + 1) + i + 1],
                d->closed1[face] != 0);
}

static double flux2(const direct *d, double near, double far, int i, int j)
{
    int face = (j + 1) * d->n1 + i;
    double f = factor(d, d->belt2[face]);

    return flux(d, near, far, f * d->v2[face], f * d->i2[(j + 1) * (d->n1 + 1) + i + 1],
                d->closed2[face] != 0);
}

// The scheme as printed: first order, swept along x1 into `other` and from there along x2.
static double roe_flux1(const direct *d, int i, int j)
{
    return flux1(d, at(d, d->rho, i, j), at(d, d->rho, i + 1, j), i, j);
}

static double roe_flux2(const direct *d, int i, int j)
{
    return flux2(d, at(d, d->other, i, j), at(d, d->other, i, j + 1), i, j);
}

static void roe_step(direct *d)
{
    const double lambda1 = d->def.dt / d->def.grid.d1, lambda2 = d->def.dt / d->def.grid.d2;

    fill_push(d);
    for (int j = 0; j < d->n2; j++)
        for (int i = 0; i < d->n1; i++)
            d->other[j * d->n1 + i] =
                d->rho[j * d->n1 + i] - lambda1 * (roe_flux1(d, i, j) - roe_flux1(d, i - 1, j));
    for (int j = 0; j < d->n2; j++)
        for (int i = 0; i < d->n1; i++)
            d->rho[j * d->n1 + i] =
                d->other[j * d->n1 + i] - lambda2 * (roe_flux2(d, i, j) - roe_flux2(d, i, j - 1));
}

// The argument of smallest size if all have one sign, else 0.
static double minmod(double a, double b, double c)
{
    if (a > 0.0 && b > 0.0 && c > 0.0)
        return fmin(a, fmin(b, c));
    return a < 0.0 && b < 0.0 && c < 0.0 ? fmax(a, fmax(b, c)) : 0.0;
}

static double limited(double before, double here, double after)
{
    return minmod(1.5 * (here - before), 0.5 * (after - before), 1.5 * (after - here));
}

// The slope of cell (i, j) along an axis; 0 where one of its two faces is closed.
static double slope1(const direct *d, int i, int j)
{
    if (i < 0 || i >= d->n1)
        return 0.0;
    const uint8_t *faces = &d->closed1[j * (d->n1 + 1) + i];
    return faces[0] != 0 || faces[1] != 0
               ? 0.0
               : limited(at(d, d->rho, i - 1, j), at(d, d->rho, i, j), at(d, d->rho, i + 1, j));
}

static double slope2(const direct *d, int i, int j)
{
    if (j < 0 || j >= d->n2)
        return 0.0;
    return d->closed2[j * d->n1 + i] != 0 || d->closed2[(j + 1) * d->n1 + i] != 0
               ? 0.0
               : limited(at(d, d->rho, i, j - 1), at(d, d->rho, i, j), at(d, d->rho, i, j + 1));
}

static double muscl_flux1(const direct *d, int i, int j)
{
    return flux1(d, at(d, d->rho, i, j) + 0.5 * slope1(d, i, j),
                 at(d, d->rho, i + 1, j) - 0.5 * slope1(d, i + 1, j), i, j);
}

static double muscl_flux2(const direct *d, int i, int j)
{
    return flux2(d, at(d, d->rho, i, j) + 0.5 * slope2(d, i, j),
                 at(d, d->rho, i, j + 1) - 0.5 * slope2(d, i, j + 1), i, j);
}

// other = rho + dt L(rho), both axes at once.
static void euler(direct *d)
{
    const double lambda1 = d->def.dt / d->def.grid.d1, lambda2 = d->def.dt / d->def.grid.d2;

    fill_push(d);
    for (int j = 0; j < d->n2; j++)
        for (int i = 0; i < d->n1; i++)
            d->other[j * d->n1 + i] = d->rho[j * d->n1 + i] -
                                      lambda1 * (muscl_flux1(d, i, j) - muscl_flux1(d, i - 1, j)) -
                                      lambda2 * (muscl_flux2(d, i, j) - muscl_flux2(d, i, j - 1));
}

// Heun's method: the mean of the density and of what two forward steps make of it.
static void muscl_step(direct *d)
{
    const size_t n = (size_t)d->n1 * (size_t)d->n2;

    memcpy(d->begin, d->rho, n * sizeof *d->begin);
    euler(d);
    memcpy(d->rho, d->other, n * sizeof *d->rho);
    euler(d);
    for (size_t k = 0; k < n; k++)
        d->rho[k] = 0.5 * d->begin[k] + 0.5 * d->other[k];
}

void direct_step(direct *d)
{
    if (d->def.scheme == SCENE_SCHEME_MUSCL)
        muscl_step(d);
    else
        roe_step(d);
    d->steps++;
}

const double *direct_density(const direct *d)
{
    return d->rho;
}
