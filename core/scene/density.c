#include "core/scene/density.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

/// Number of e-foldings after which a part adds less than 2^-53 of its peak.
#define CUT (53.0 * M_LN2)

/// Columns or rows first .. end - 1.
typedef struct span {
    size_t first;
    size_t end;
} span;

/// The cells of one axis whose centres lie near a place.
static span find_span(double lower, double d, size_t n, double at, double radius)
{
    double first = ceil((at - radius - lower) / d - 0.5);
    double end = floor((at + radius - lower) / d - 0.5) + 1.0;

    return (span){ (size_t)fmin(fmax(first, 0.0), (double)n),
                   (size_t)fmin(fmax(end, 0.0), (double)n) };
}

/// Add factor * weights to a row. Its own function, so that it is turned into SIMD.
static void add_scaled(double *restrict row, const double *restrict weights, size_t n,
                       double factor)
{
    for (size_t i = 0; i < n; i++)
        row[i] += factor * weights[i];
}

static void add_part(const bf_grid *g, double sigma0, double peak, scene_pose at, double *weights,
                     double *rho)
{
    double radius = sqrt(2.0 * CUT / sigma0);
    span columns = find_span(g->lower1, g->d1, g->n1, at.x, radius);
    span rows = find_span(g->lower2, g->d2, g->n2, at.y, radius);

    for (size_t i = columns.first; i < columns.end; i++) {
        double off = grid_x1(g, i) - at.x;
        weights[i] = exp(-0.5 * sigma0 * off * off);
    }
    for (size_t j = rows.first; j < rows.end; j++) {
        double off = grid_x2(g, j) - at.y, left = radius * radius - off * off;
        span in_row = find_span(g->lower1, g->d1, g->n1, at.x, sqrt(fmax(left, 0.0)));
        if (in_row.first < in_row.end)
            add_scaled(rho + j * g->n1 + in_row.first, weights + in_row.first,
                       in_row.end - in_row.first, peak * exp(-0.5 * sigma0 * off * off));
    }
}

double density_cells(double sigma0, double cell_area, double n_cells)
{
    return fmin(2.0 * M_PI * CUT / (sigma0 * cell_area), n_cells);
}

bf_status density_from_parts(const bf_grid *grid, double packing, double sigma0,
                             const scene_pose *poses, size_t n, double *rho, bf_error *err)
{
    double *weights = memory_alloc(grid->n1, sizeof *weights);

    if (weights == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the density of the parts");
    memset(rho, 0, grid_cells(grid) * sizeof *rho);
    for (size_t k = 0; k < n; k++)
        add_part(grid, sigma0, sigma0 / (2.0 * M_PI * packing), poses[k], weights, rho);
    memory_free(weights);
    return BF_OK;
}
