// rho* = rho - dt div(rho v) of a member's rows, v = v_stat + w (v_T - v_stat): by the scheme roe one step with upwind
// fluxes, both axes at once; by muscl Heun's method with the states of muscl.h,
//
//     rho' = rho + dt L(rho)                       stage 0, into congested.stage
//     rho* = rho/2 + (rho' + dt L(rho'))/2         stage 1, into `next`
//
// where no stage has a bound on the density: the correction that follows is of rho* alone.

#include "core/macro/congested/transport.h"

#include <math.h>
#include <string.h>

// Blocks of a row in which a stage may leave cargo: cargo moves by a cell at most.
static block_span reached(const macro_solver *s, const macro_state *from, ptrdiff_t row)
{
    if (row < 0 || row >= s->n2)
        return (block_span){ 0, 0 };
    const double *rho = macro__row(s, from->rho, row);
    block_span span = from->span[row];

    if (span.first < span.last && span.first > 0 && rho[span.first * BLOCK_CELLS] != 0.0)
        span.first--;
    if (span.first < span.last && span.last < s->n_blocks &&
        rho[span.last * BLOCK_CELLS - 1] != 0.0)
        span.last++;
    if (row > 0)
        span = block_span_hull(span, from->span[row - 1]);
    if (row + 1 < s->n2)
        span = block_span_hull(span, from->span[row + 1]);
    return span;
}

// Beyond the grid there is no cargo, whatever the width of a register.
static void clear_behind(const macro_solver *s, double *rho)
{
    memset(rho + s->n1, 0, (size_t)(s->n_blocks * BLOCK_CELLS - s->n1) * sizeof *rho);
}

static void transport_upwind(macro_solver *s, const congested *c, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t row = first; row < last; row++) {
        const block_span span = reached(s, &s->now, row);
        double *star = macro__row(s, s->next.rho, row);
        memset(star - s->margin, 0, (size_t)s->stride * sizeof *star);
        if (span.first < span.last)
            c->kernels.transport(s, row, span.first * BLOCK_CELLS, span.last * BLOCK_CELLS, star);
        clear_behind(s, star);
        s->next.span[row] = span;
    }
}

// The states of row r at its x2-faces, then the flux through those south of it, which needs the states of row r - 1.
static void make_flux_x2(const macro_solver *s, const congested *c, const congested_stage *stage,
                         ptrdiff_t r)
{
    const block_span flux =
        block_span_hull(reached(s, stage->from, r - 1), reached(s, stage->from, r));

    c->kernels.muscl_states_x2(s, stage, r, block_span_hull(flux, reached(s, stage->from, r + 1)));
    c->kernels.muscl_flux_x2(s, stage, r, flux);
}

static void transport_stage(const macro_solver *s, const congested *c, const congested_stage *stage,
                            ptrdiff_t first, ptrdiff_t last)
{
    if (first >= last)
        return;
    c->kernels.muscl_states_x2(
        s, stage, first - 1,
        block_span_hull(reached(s, stage->from, first - 1), reached(s, stage->from, first)));
    make_flux_x2(s, c, stage, first);
    for (ptrdiff_t row = first; row < last; row++) {
        const block_span span = reached(s, stage->from, row);
        double *rho = macro__row(s, stage->to->rho, row);
        make_flux_x2(s, c, stage, row + 1);
        memset(rho - s->margin, 0, (size_t)s->stride * sizeof *rho);
        if (span.first < span.last)
            c->kernels.muscl_update(s, stage, row, span);
        clear_behind(s, rho);
        stage->to->span[row] = span;
    }
}

// The density of a cell, and 0 beyond the grid.
static double density_at(const macro_solver *s, ptrdiff_t i, ptrdiff_t j)
{
    return j >= 0 && j < s->n2 ? macro__row(s, s->now.rho, j)[i] : 0.0;
}

// How much of a cell's cargo is loose: as much as the cells ahead lack of rho_j, of which its belt leads to one along each axis.
// There is no room behind a closed face, and nothing to tell beyond the grid and where no belt moves.
static double loose_part(const macro_solver *s, const congested *c, const scene_belt *belt,
                         ptrdiff_t i, ptrdiff_t j)
{
    const bf_grid *g = &s->def.grid;
    const vec2 centre = { g->lower1 + ((double)i + 0.5) * g->d1,
                          g->lower2 + ((double)j + 0.5) * g->d2 };
    const vec2 v = belt_velocity(belt, centre);
    const double speed[2] = { v.x, v.y };
    double loose = 0.0;

    if (i < 0 || i >= s->n1 || j < 0 || j >= s->n2 || (v.x == 0.0 && v.y == 0.0))
        return 1.0;
    const double here = density_at(s, i, j);
    for (int axis = 0; axis < 2; axis++) {
        const ptrdiff_t up = speed[axis] > 0.0, by = up ? 1 : -1;
        const ptrdiff_t at = axis == 0 ? j * (s->n1 + 1) + i + up : (j + up) * s->n1 + i;
        const double ahead = axis == 0 ? density_at(s, i + by, j) : density_at(s, i, j + by);
        const double room = c->aperture[axis][at] > 0.0 ? fmax(c->jam_density - ahead, 0.0) : 0.0;
        loose += fabs(speed[axis]) * (room < here ? room / here : 1.0);
    }
    return loose / (fabs(v.x) + fabs(v.y));
}

// The velocities across the faces of a row in slide zones, for this step. What is loose goes on with its belt, and what finds no
// room ahead slides along the plate.
static void loosen_row(const macro_solver *s, const congested *c, int axis, ptrdiff_t row)
{
    const congested_range faces = c->sliding[axis][row];
    const ptrdiff_t n_columns = s->n1 + (axis == 0);
    double *v = axis == 0 ? macro__row(s, s->faces1.v, row) - 1 : macro__row(s, s->faces2.v, row);

    for (ptrdiff_t i = faces.first; i < faces.last; i++) {
        const size_t at = (size_t)(row * n_columns + i), belt = c->belt[axis][at];
        const double slide = c->slide[axis][at], loose = c->loose[axis][at];
        if (loose == slide)
            continue;
        // What crosses the face comes from the cell before it or from the one behind it.
        const ptrdiff_t before = slide > 0.0 || (slide == 0.0 && loose > 0.0);
        const double part = axis == 0 ? loose_part(s, c, &c->belts[belt], i - before, row)
                                      : loose_part(s, c, &c->belts[belt], i, row - before);
        v[i] = s->factors[belt] * (slide + part * (loose - slide));
    }
}

void congested__transport(macro_solver *s, int member, ptrdiff_t first, ptrdiff_t last,
                          team_barrier *barrier)
{
    congested *c = s->congested;

    for (ptrdiff_t row = first; row < last; row++) {
        loosen_row(s, c, 0, row);
        loosen_row(s, c, 1, row);
    }
    if (first < last && last == s->n2)
        loosen_row(s, c, 1, last);
    team_barrier_wait(barrier);

    if (s->def.scheme == SCENE_SCHEME_ROE) {
        transport_upwind(s, c, first, last);
        return;
    }
    congested_rows *rows = &c->rows[member];
    transport_stage(s, c, &(congested_stage){ &s->now, &c->stage, NULL, rows }, first, last);
    // The second stage reads two rows of the members beside this one.
    team_barrier_wait(barrier);
    transport_stage(s, c, &(congested_stage){ &c->stage, &s->next, &s->now, rows }, first, last);
}
