#include "core/macro/cargo_velocity.h"

#include "core/base/memory.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/macro/tracers.h"

#include <math.h>
#include <string.h>

// From less no velocity is told: the quotient would be rounding.
static const double least_density = 1e-12;

bf_status cargo_velocity_init(const macro_solver *s, cargo_velocity_record *record)
{
    if (s->def.closure == SCENE_CONGESTED)
        return BF_OK;
    record->u1 = memory_alloc((size_t)(s->n2 * s->stride), sizeof *record->u1);
    record->u2 = memory_alloc((size_t)((s->n2 + 1) * s->stride), sizeof *record->u2);
    return record->u1 != NULL && record->u2 != NULL ? BF_OK : BF_ENOMEM;
}

void cargo_velocity_fini(cargo_velocity_record *record)
{
    memory_free(record->u1);
    memory_free(record->u2);
}

// v where u is v but for rounding.
static inline double unless_equal(double v, double u)
{
    return fabs(u - v) > 1e-6 * fabs(v) ? u : v;
}

// Of a flux F = F_stat + g through a face of static velocity v, between the densities before and behind it.
static inline double across(double v, double g, double left, double right)
{
    if (g == 0.0)
        return v;
    const double flux = v * (v >= 0.0 ? left : right) + g, rho = flux > 0.0 ? left : right;
    return rho > least_density ? unless_equal(v, flux / rho) : 0.0;
}

// What velocities of a row's faces are made of with `congested`; element i is that of cell i, those of colours of half cells.
typedef struct row_source {
    const double *rho; // with which the step began
    const double *rho_south;
    const double *rho_north;
    const double *v1;
    const double *v2_south;
    const double *v2_north;
    const float *own[CONGESTED_SIDES]; // fluxes of the correction at the faces of red cells
    const float *south;                // those at the southern faces of black cells
    const float *north;                // same at their northern faces
} row_source;

static row_source source_of(const macro_solver *s, ptrdiff_t j)
{
    const congested *c = s->congested;
    const double *nothing = s->zero_row + s->margin, *rho = macro__row(s, s->next.rho, j);
    row_source x = { .rho = rho,
                     .rho_south = j > 0 ? rho - s->stride : nothing,
                     .rho_north = j + 1 < s->n2 ? rho + s->stride : nothing,
                     .v1 = macro__row(s, s->faces1.v, j),
                     .v2_south = macro__row(s, s->faces2.v, j),
                     .v2_north = macro__row(s, s->faces2.v, j + 1),
                     .south = congested__row(c, c->law[CONGESTED_NORTH].flux, j - 1),
                     .north = congested__row(c, c->law[CONGESTED_SOUTH].flux, j + 1) };

    for (int side = 0; side < CONGESTED_SIDES; side++)
        x.own[side] = congested__row(c, c->law[side].flux, j);
    return x;
}

// Across the x1-face west of cell i of row j, which may be n1.
static inline double across_west(const row_source *x, ptrdiff_t i, ptrdiff_t j)
{
    const bool is_red = ((i + j) & 1) == 0;
    const float g = is_red ? x->own[CONGESTED_WEST][i >> 1] : x->own[CONGESTED_EAST][(i - 1) >> 1];

    return across(x->v1[i - 1], (double)g, x->rho[i - 1], x->rho[i]);
}

static inline double across_south(const row_source *x, ptrdiff_t i, ptrdiff_t j)
{
    const float g = (((i + j) & 1) == 0 ? x->own[CONGESTED_SOUTH] : x->south)[i >> 1];

    return across(x->v2_south[i], (double)g, x->rho_south[i], x->rho[i]);
}

static inline double across_north(const row_source *x, ptrdiff_t i, ptrdiff_t j)
{
    const float g = (((i + j) & 1) == 0 ? x->own[CONGESTED_NORTH] : x->north)[i >> 1];

    return across(x->v2_north[i], (double)g, x->rho[i], x->rho_north[i]);
}

cargo_velocity cargo_velocity_of(const macro_solver *s, ptrdiff_t i, ptrdiff_t j)
{
    if (s->congested != NULL) {
        const row_source x = source_of(s, j);
        return (cargo_velocity){ across_west(&x, i, j), across_west(&x, i + 1, j),
                                 across_south(&x, i, j), across_north(&x, i, j) };
    }
    const double *u1 = macro__row(s, s->tracers->record.u1, j);
    const double *u2 = macro__row(s, s->tracers->record.u2, j);
    return (cargo_velocity){ u1[i - 1], u1[i], u2[i], u2[i + s->stride] };
}

double cargo_velocity_flux(const macro_solver *s, ptrdiff_t i, ptrdiff_t j, scene_side side)
{
    const ptrdiff_t to_i = i + (side == SCENE_EAST) - (side == SCENE_WEST);
    const ptrdiff_t to_j = j + (side == SCENE_NORTH) - (side == SCENE_SOUTH);
    const bool is_inside = to_i >= 0 && to_i < s->n1 && to_j >= 0 && to_j < s->n2;
    const double here = macro__row(s, s->next.rho, j)[i];
    const double there = is_inside ? macro__row(s, s->next.rho, to_j)[to_i] : 0.0;

    if (here <= 0.0 && there <= 0.0)
        return 0.0;
    const cargo_velocity u = cargo_velocity_of(s, i, j);
    const double out[SCENE_SIDE_COUNT] = { [SCENE_WEST] = -u.west,
                                           [SCENE_EAST] = u.east,
                                           [SCENE_SOUTH] = -u.south,
                                           [SCENE_NORTH] = u.north };
    return out[side] * (out[side] > 0.0 ? here : there);
}

// fmax() is a call, and this is asked of all cells at every sample.
static inline double positive(double x)
{
    return x > 0.0 ? x : 0.0;
}

static inline double speed_of(double west, double east, double south, double north)
{
    const double out1 = positive(east) + positive(-west), out2 = positive(north) + positive(-south);

    return sqrt(out1 * out1 + out2 * out2);
}

void cargo_velocity_speeds(const macro_solver *s, ptrdiff_t j, double *ret_speeds)
{
    if (s->congested != NULL) {
        const row_source x = source_of(s, j);
        double west = across_west(&x, 0, j);
        for (ptrdiff_t i = 0; i < s->n1; i++) {
            const double east = across_west(&x, i + 1, j);
            ret_speeds[i] = speed_of(west, east, across_south(&x, i, j), across_north(&x, i, j));
            west = east;
        }
        return;
    }
    const double *u1 = macro__row(s, s->tracers->record.u1, j);
    const double *u2 = macro__row(s, s->tracers->record.u2, j);
    for (ptrdiff_t i = 0; i < s->n1; i++)
        ret_speeds[i] = speed_of(u1[i - 1], u1[i], u2[i], u2[i + s->stride]);
}

void cargo_velocity_put(const macro_solver *s, const macro_faces *faces,
                        const cargo_velocity_fluxes *of, ptrdiff_t row, double *rows)
{
    const double *v = macro__row(s, faces->v, row);
    double *u = macro__row(s, rows, row);
    ptrdiff_t b = -1;
    block_span run;

    memcpy(u - s->margin, v - s->margin, (size_t)s->stride * sizeof *u);
    while (block_set_next_run(of->blocks, s->n_words, &b, &run))
        for (ptrdiff_t i = run.first * BLOCK_CELLS; i < run.last * BLOCK_CELLS; i++) {
            const double flux = of->flux[i], rho = flux > 0.0 ? of->left[i] : of->right[i];
            if (flux != 0.0)
                u[i] = unless_equal(v[i], flux / (rho > least_density ? rho : least_density));
        }
}
