#include "core/compare/compare.h"

#include "core/base/memory.h"
#include "core/compare/compare_priv.h"

#include <math.h>

// Where the mass of a density lies along the axes, in units of cells.
typedef struct marginals {
    double *x; // n1 columns
    double *y; // n2 rows
    double mass;
} marginals;

static void gather(const bf_grid *grid, const float *rho, marginals *m)
{
    for (size_t j = 0; j < grid->n2; j++) {
        const float *row = rho + j * grid->n1;
        double sum = 0.0;
        for (size_t i = 0; i < grid->n1; i++) {
            m->x[i] += (double)row[i];
            sum += (double)row[i];
        }
        m->y[j] = sum;
        m->mass += sum;
    }
}

// The integral of the distance of both shares over n cells of width d. Within a cell each share is a
// line, as the density is constant there.
static double carry(const double *a, double mass_a, const double *b, double mass_b, size_t n,
                    double d)
{
    double share_a = 0.0, share_b = 0.0, gap = 0.0, sum = 0.0;

    if (!(mass_a > 0.0) || !(mass_b > 0.0))
        return NAN;
    for (size_t k = 0; k < n; k++) {
        share_a += a[k] / mass_a;
        share_b += b[k] / mass_b;
        double next_gap = share_a - share_b;
        sum += compare__area(d, gap, next_gap);
        gap = next_gap;
    }
    return sum;
}

static void compare_cells(const float *a, const float *b, size_t n, compare_distance *d)
{
    double gaps = 0.0, all = 0.0;

    for (size_t k = 0; k < n; k++) {
        gaps += fabs((double)a[k] - (double)b[k]);
        all += fabs((double)a[k]) + fabs((double)b[k]);
    }
    d->mean_abs = gaps / (double)n;
    d->l1 = all > 0.0 ? gaps / all : (double)NAN;
}

bf_status compare_densities(const bf_grid *grid, const float *a, const float *b,
                            compare_distance *ret_distance, bf_error *err)
{
    size_t n1 = grid->n1, n2 = grid->n2;
    double *sums = memory_alloc(2 * (n1 + n2), sizeof *sums);
    compare_distance d;

    if (sums == NULL)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    marginals of_a = { .x = sums, .y = sums + n1 };
    marginals of_b = { .x = sums + n1 + n2, .y = sums + 2 * n1 + n2 };
    gather(grid, a, &of_a);
    gather(grid, b, &of_b);
    compare_cells(a, b, grid_cells(grid), &d);
    d.emd_x = carry(of_a.x, of_a.mass, of_b.x, of_b.mass, n1, grid->d1);
    d.emd_y = carry(of_a.y, of_a.mass, of_b.y, of_b.mass, n2, grid->d2);
    memory_free(sums);
    *ret_distance = d;
    return BF_OK;
}
