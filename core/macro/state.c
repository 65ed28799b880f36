// Access to the density: set, read, measure, checkpoint.

#include "core/base/check.h"
#include "core/base/checkpoint.h"
#include "core/base/digest.h"
#include "core/macro/congested.h"
#include "core/macro/kinds.h"
#include "core/macro/macro_priv.h"
#include "core/macro/tracers.h"

#include <math.h>
#include <string.h>

void macro__fill_margins(const macro_solver *s, double *row)
{
    const ptrdiff_t end = s->stride - s->margin;

    if (s->n1 % BLOCK_CELLS != 0 || s->def.mirror[1])
        memset(row + s->n1, 0, (size_t)(end - s->n1) * sizeof *row);
    for (ptrdiff_t k = 0; s->def.mirror[0] && k < s->n1 && k < s->along.reach; k++)
        row[-1 - k] = row[k];
    for (ptrdiff_t k = 0; s->def.mirror[1] && k < s->n1 && k < s->along.reach; k++)
        row[s->n1 + k] = row[s->n1 - 1 - k];
}

// The density from which on H is not zero.
static double active_from(const macro_solver *s)
{
    return s->def.heaviside == SCENE_HEAVISIDE_SHARP ? 1.0 : 0.0;
}

// Takes densities, layout of grid.h, as the present state.
static void take_density(macro_solver *s, const char *rho)
{
    const size_t row_bytes = (size_t)s->n1 * sizeof(double);
    const size_t all_bytes = (size_t)(s->n2 * s->stride) * sizeof(double);
    const size_t set_bytes = (size_t)s->n2 * s->n_words * sizeof(uint64_t);
    const double threshold = active_from(s);

    memset(s->now.rho, 0, all_bytes);
    memset(s->next.rho, 0, all_bytes);
    memset(s->now.active, 0, set_bytes);
    memset(s->now.active_first, 0, set_bytes);
    for (ptrdiff_t j = 0; j < s->n2; j++) {
        double *row = macro__row(s, s->now.rho, j);
        block_span span = { 0, 0 };
        memcpy(row, rho + (size_t)j * row_bytes, row_bytes);
        for (ptrdiff_t i = 0; i < s->n1; i++) {
            if (row[i] == 0.0)
                continue;
            if (span.last == 0)
                span.first = i / BLOCK_CELLS;
            span.last = i / BLOCK_CELLS + 1;
            if (row[i] >= threshold)
                block_set_add(macro__set(s, s->now.active, j), i / BLOCK_CELLS);
            if (row[i] >= threshold && i % BLOCK_CELLS == 0)
                block_set_add(macro__set(s, s->now.active_first, j), i / BLOCK_CELLS);
        }
        macro__fill_margins(s, row);
        s->now.span[j] = span;
        s->cost[j] = 1.0 + (double)s->n_blocks;
    }
}

void macro_set_density(macro_solver *s, const double *rho)
{
    take_density(s, (const char *)rho);
    s->steps = 0;
    if (s->fallen != NULL)
        memset(s->fallen, 0, grid_cells(&s->def.grid) * sizeof *s->fallen);
    if (s->congested != NULL)
        congested_reset(s);
    if (s->tracers != NULL)
        tracers_reset(s);
}

void macro_add(macro_solver *s, size_t cell, double density, const double *fractions)
{
    const ptrdiff_t j = (ptrdiff_t)cell / s->n1, i = (ptrdiff_t)cell % s->n1, b = i / BLOCK_CELLS;
    double *row = macro__row(s, s->now.rho, j);

    if (density == 0.0)
        return;
    if (s->kinds != NULL && fractions != NULL)
        kinds_mix(s, cell, density, fractions);
    row[i] += density;
    s->now.span[j] = block_span_hull(s->now.span[j], (block_span){ b, b + 1 });
    if (row[i] >= active_from(s))
        block_set_add(macro__set(s, s->now.active, j), b);
    if (row[i] >= active_from(s) && i % BLOCK_CELLS == 0)
        block_set_add(macro__set(s, s->now.active_first, j), b);
    macro__fill_margins(s, row);
}

void macro_speeds(const macro_solver *s, size_t row, double *ret_speeds)
{
    if (s->tracers != NULL && s->steps > 0)
        cargo_velocity_speeds(s, (ptrdiff_t)row, ret_speeds);
    else
        memset(ret_speeds, 0, s->def.grid.n1 * sizeof *ret_speeds);
}

double macro_flux(const macro_solver *s, size_t i, size_t j, scene_side side)
{
    if (s->tracers == NULL || s->steps == 0)
        return 0.0;
    return cargo_velocity_flux(s, (ptrdiff_t)i, (ptrdiff_t)j, side);
}

bool macro_is_off(const macro_solver *s, size_t cell)
{
    return s->off != NULL && s->off[cell] != 0;
}

double macro_belt_factor(const macro_solver *s, size_t belt)
{
    return s->speeds == NULL ? 1.0
                             : belt_speeds_mean(s->speeds, belt, (double)s->steps * s->def.dt,
                                                (double)(s->steps + 1) * s->def.dt);
}

const double *macro_row(const macro_solver *s, size_t j)
{
    return macro__row(s, s->now.rho, (ptrdiff_t)j);
}

double macro_density(const macro_solver *s, size_t cell)
{
    return macro_row(s, cell / s->def.grid.n1)[cell % s->def.grid.n1];
}

void macro_copy_density_float(const macro_solver *s, float *rho)
{
    const size_t n1 = s->def.grid.n1;

    for (size_t j = 0; j < s->def.grid.n2; j++) {
        const double *row = macro_row(s, j);
        for (size_t i = 0; i < n1; i++)
            rho[j * n1 + i] = (float)row[i];
    }
}

// Sum of row[i_min .. i_max - 1] in BLOCK_CELLS interleaved partial sums, the same on every processor.
static double sum_row(const double *row, size_t i_min, size_t i_max)
{
    double part[BLOCK_CELLS] = { 0 }, sum = 0.0;
    size_t i = i_min;

    for (; i + BLOCK_CELLS <= i_max; i += BLOCK_CELLS)
        for (size_t k = 0; k < BLOCK_CELLS; k++)
            part[k] += row[i + k];
    for (; i < i_max; i++)
        sum += row[i];
    for (size_t k = 0; k < BLOCK_CELLS; k++)
        sum += part[k];
    return sum;
}

double macro_mass_in(const macro_solver *s, size_t i_min, size_t i_max, size_t j_min, size_t j_max)
{
    double sum = 0.0;

    for (size_t j = j_min; j < j_max; j++)
        if (s->now.span[j].first < s->now.span[j].last)
            sum += sum_row(macro_row(s, j), i_min, i_max);
    return sum * s->def.grid.d1 * s->def.grid.d2;
}

double macro_fallen_in(const macro_solver *s, size_t i_min, size_t i_max, size_t j_min,
                       size_t j_max)
{
    double sum = 0.0;

    for (size_t j = j_min; s->fallen != NULL && j < j_max; j++)
        sum += sum_row(s->fallen + j * s->def.grid.n1, i_min, i_max);
    return sum * s->def.grid.d1 * s->def.grid.d2;
}

static double peak_of_row(const double *row, size_t n)
{
    double part[BLOCK_CELLS] = { 0 }, peak = 0.0;
    size_t i = 0;

    for (; i + BLOCK_CELLS <= n; i += BLOCK_CELLS)
        for (size_t k = 0; k < BLOCK_CELLS; k++)
            part[k] = row[i + k] > part[k] ? row[i + k] : part[k];
    for (; i < n; i++)
        peak = row[i] > peak ? row[i] : peak;
    for (size_t k = 0; k < BLOCK_CELLS; k++)
        peak = part[k] > peak ? part[k] : peak;
    return peak;
}

macro_totals macro_measure(const macro_solver *s)
{
    const bf_grid *g = &s->def.grid;
    macro_totals totals = { .mass = macro_mass_in(s, 0, g->n1, 0, g->n2),
                            .fallen = macro_fallen_in(s, 0, g->n1, 0, g->n2),
                            .relaxed = s->congested != NULL ? congested_relaxed(s) : 0.0,
                            .n_fields = (double)s->n_fields };

    for (int k = 0; k < s->n_bands; k++) {
        totals.swept.all += s->bands[k].swept.all;
        totals.swept.varied += s->bands[k].swept.varied;
        totals.swept.dispersed += s->bands[k].swept.dispersed;
    }
    for (size_t j = 0; j < g->n2; j++)
        if (s->now.span[j].first < s->now.span[j].last)
            totals.peak = fmax(totals.peak, peak_of_row(macro_row(s, j), g->n1));
    return totals;
}

bf_status macro_check(const macro_solver *s, bf_error *err)
{
    const bf_grid *g = &s->def.grid;

    // A value that is not finite makes the sum so.
    if (isfinite(macro_mass_in(s, 0, g->n1, 0, g->n2)))
        return s->congested != NULL ? congested_check(s, err) : BF_OK;
    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            if (!isfinite(macro_row(s, j)[i]))
                return bf_fail(err, BF_ENUMERIC, "",
                               "density %g at x = %.6g m, y = %.6g m after step %llu (t = %.6g s)",
                               macro_row(s, j)[i], grid_x1(g, i), grid_x2(g, j),
                               (unsigned long long)s->steps, macro_time(s));
    return bf_fail(err, BF_ENUMERIC, "", "the density's sum overflows after step %llu (t = %.6g s)",
                   (unsigned long long)s->steps, macro_time(s));
}

// With the closure congested, for a cell or two of way. With the other one cargo disperses in every second step or so, and steps
// that were left out would choose among them.
uint64_t macro_flux_steps(const macro_solver *s)
{
    return s->congested != NULL ? 4 : 1;
}

uint64_t macro_steps(const macro_solver *s)
{
    return s->steps;
}

double macro_time(const macro_solver *s)
{
    return (double)s->steps * s->def.dt;
}

uint64_t macro_digest(const macro_solver *s)
{
    uint64_t digest = digest_add(DIGEST_START, &s->steps, sizeof s->steps);

    for (size_t j = 0; j < s->def.grid.n2; j++)
        digest = digest_add(digest, macro_row(s, j), s->def.grid.n1 * sizeof(double));
    if (s->kinds != NULL)
        digest = digest_add(digest, macro_fractions(s, 0),
                            grid_cells(&s->def.grid) * s->def.n_kinds * sizeof(double));
    return digest;
}

bf_status macro_save(const macro_solver *s, bf_buffer *out, bf_error *err)
{
    enum { SMALL_STATE_BYTES = 65536 }; // of all else
    const size_t n_arrays = grid_cells(&s->def.grid) * sizeof(double) * (1 + s->def.n_kinds) +
                            (s->fallen != NULL ? grid_cells(&s->def.grid) * sizeof(double) : 0) +
                            (s->congested != NULL ? congested_state_size(s) : 0);
    checkpoint_writer w;

    // Room for the large arrays at once, so that they are not moved while they are written. If there is none, a write
    // fails.
    (void)buffer_reserve(out, n_arrays + SMALL_STATE_BYTES);
    checkpoint_begin(&w, out, CHECKPOINT_MACRO, 0);
    checkpoint_write(&w, &s->steps, sizeof s->steps);
    for (size_t j = 0; j < s->def.grid.n2; j++)
        checkpoint_write(&w, macro_row(s, j), s->def.grid.n1 * sizeof(double));
    if (s->fallen != NULL)
        checkpoint_write(&w, s->fallen, grid_cells(&s->def.grid) * sizeof *s->fallen);
    if (s->tracers != NULL)
        tracers_save(s, &w);
    if (s->kinds != NULL)
        kinds_save(s, &w);
    if (s->congested != NULL)
        congested_save(s, &w);
    return checkpoint_end(&w, err);
}

bf_status macro_load(macro_solver *s, const void *bytes, size_t n, bf_error *err)
{
    checkpoint_reader r;

    BF_CHECK(s->steps == 0);
    bf_status status = checkpoint_open(&r, bytes, n, CHECKPOINT_MACRO, 0, err);
    if (status != BF_OK)
        return status;
    const size_t n_bytes = grid_cells(&s->def.grid) * sizeof(double);
    const bool has_steps = checkpoint_read(&r, &s->steps, sizeof s->steps);
    const char *rho = has_steps ? checkpoint_read_items(&r, 1, n_bytes) : NULL;
    if (rho != NULL)
        take_density(s, rho);
    if (rho == NULL || (s->fallen != NULL && !checkpoint_read(&r, s->fallen, n_bytes)) ||
        (s->tracers != NULL && !tracers_load(s, &r)) || (s->kinds != NULL && !kinds_load(s, &r)) ||
        (s->congested != NULL && !congested_load(s, &r)) || r.n_left != 0)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint has a wrong length");
    return BF_OK;
}
