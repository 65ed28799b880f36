// The loops over cells of the congested closure, compiled once per instruction set.

#include "core/base/simd_float.h"
#include "core/macro/congested/congested_priv.h"

// The law along the belt: slope 1 up to `free`, then `slope` up to `beyond` more.
static inline simd_float law_along(const congested_law *l, ptrdiff_t k, simd_float g)
{
    const simd_float free = simd_float_load(l->free + k);
    const simd_float outer =
        simd_float_max(g - free, simd_float_all(0.0F)) * simd_float_load(l->slope + k);
    const simd_float all =
        simd_float_min(g, free) + simd_float_min(outer, simd_float_load(l->beyond + k));

    return simd_float_max(all, simd_float_load(l->least + k));
}

// The law across it: a threshold, then two bounds.
static inline simd_float law_across(const congested_law *l, ptrdiff_t k, simd_float g)
{
    const simd_float threshold = simd_float_load(l->threshold + k);
    const simd_float inside = simd_float_min(simd_float_max(g, -threshold), threshold);

    return simd_float_min(simd_float_max(g - inside, simd_float_load(l->lower + k)),
                          simd_float_load(l->upper + k));
}

// G.e of faces by the pressure gradient g along e.
static inline simd_float law(const congested_law *l, ptrdiff_t k, simd_float g, bool is_forward,
                             bool is_x1)
{
    if (is_forward)
        return is_x1 ? law_along(l, k, g) : law_across(l, k, g);
    const simd_float along = simd_float_load(l->along + k), across = simd_float_load(l->across + k);
    const simd_float crosswise = simd_float_load(l->crosswise + k);

    return along * law_along(l, k, along * g - across * crosswise) +
           across * law_across(l, k, across * g + along * crosswise);
}

// The laws at the faces around the cells of a half row, each shifted so that element k belongs to cell k.
typedef struct row_laws {
    congested_law side[CONGESTED_SIDES];
} row_laws;

static inline congested_law shifted(const congested *c, congested_side side, ptrdiff_t row,
                                    ptrdiff_t shift)
{
    const ptrdiff_t at = (row + 1) * c->half_stride + CONGESTED_UNIT + shift;
    congested_law l = c->law[side];

    l.free += at;
    l.slope += at;
    l.beyond += at;
    l.least += at;
    l.threshold += at;
    l.lower += at;
    l.upper += at;
    l.full_slip += at;
    l.gain += at;
    l.at_rest += at;
    l.flux += at;
    if (!c->is_forward) {
        l.along += at;
        l.across += at;
        l.crosswise += at;
    }
    return l;
}

// colour 0: red cells, whose faces are their own; else black ones, whose faces are those of their neighbours.
static inline row_laws laws_of(const congested *c, ptrdiff_t row, int colour)
{
    const ptrdiff_t shift = congested__shift(row);

    if (colour == 0)
        return (row_laws){ { shifted(c, CONGESTED_WEST, row, 0), shifted(c, CONGESTED_EAST, row, 0),
                             shifted(c, CONGESTED_SOUTH, row, 0),
                             shifted(c, CONGESTED_NORTH, row, 0) } };
    return (row_laws){
        { shifted(c, CONGESTED_EAST, row, shift - 1), shifted(c, CONGESTED_WEST, row, shift),
          shifted(c, CONGESTED_NORTH, row - 1, 0), shifted(c, CONGESTED_SOUTH, row + 1, 0) }
    };
}

// The pressures around the cells of a half row.
typedef struct row_pressures {
    float *own;
    const float *west;
    const float *east;
    const float *south;
    const float *north;
} row_pressures;

static inline row_pressures pressures_of(const congested *c, ptrdiff_t row, int colour)
{
    float *other = c->pressure[1 - colour];
    const float *beside = congested__row(c, other, row);
    // Cell k of a half row that begins with cell 0 has its west neighbour at k - 1.
    const ptrdiff_t west = ((row + colour) & 1) == 0 ? -1 : 0;

    return (row_pressures){ .own = congested__row(c, c->pressure[colour], row),
                            .west = beside + west,
                            .east = beside + west + 1,
                            .south = congested__row(c, other, row - 1),
                            .north = congested__row(c, other, row + 1) };
}

// The excess of a register of cells with the correction of the present pressures.
static inline simd_float residual_of(const congested *c, const row_laws *laws,
                                     const row_pressures *p, const float *excess, ptrdiff_t k,
                                     bool is_forward)
{
    const simd_float here = simd_float_load(p->own + k);
    const simd_float west = simd_float_load(p->west + k) - here;
    const simd_float east = here - simd_float_load(p->east + k);
    const simd_float south = simd_float_load(p->south + k) - here;
    const simd_float north = here - simd_float_load(p->north + k);
    const simd_float in =
        law(&laws->side[CONGESTED_WEST], k, west * c->inverse_dx, is_forward, true) -
        law(&laws->side[CONGESTED_EAST], k, east * c->inverse_dx, is_forward, true) +
        law(&laws->side[CONGESTED_SOUTH], k, south * c->inverse_dx, is_forward, false) -
        law(&laws->side[CONGESTED_NORTH], k, north * c->inverse_dx, is_forward, false);

    return simd_float_load(excess + k) + c->lambda * in;
}

static inline float relax_row(const congested *c, ptrdiff_t row, int colour, bool is_forward)
{
    const row_laws laws = laws_of(c, row, colour);
    const row_pressures p = pressures_of(c, row, colour);
    const float *excess = congested__row(c, c->excess[colour], row);
    const simd_float none = simd_float_all(0.0F);
    simd_float largest = none;

    for (ptrdiff_t k = c->range[row].first; k < c->range[row].last; k += SIMD_FLOAT_LANES) {
        const simd_float here = simd_float_load(p.own + k);
        const simd_float residual = residual_of(c, &laws, &p, excess, k, is_forward);
        const simd_float relaxed = simd_float_max(here + c->relaxation * residual, none);
        const simd_float change = relaxed - here;
        largest = simd_float_max(largest, simd_float_max(change, -change));
        simd_float_store(p.own + k, relaxed);
    }
    return simd_float_largest(largest, 0.0F);
}

static float relax(const congested *c, ptrdiff_t row, int colour)
{
    return c->is_forward ? relax_row(c, row, colour, true) : relax_row(c, row, colour, false);
}

static inline void make_flux_row(const congested *c, ptrdiff_t row, bool is_forward)
{
    const row_laws laws = laws_of(c, row, 0);
    const row_pressures p = pressures_of(c, row, 0);
    const float *beside[CONGESTED_SIDES] = { p.west, p.east, p.south, p.north };

    for (int side = 0; side < CONGESTED_SIDES; side++) {
        const congested_law *l = &laws.side[side];
        // Fluxes are taken towards rising x: into the cell on its west and south sides.
        const float sign = side == CONGESTED_WEST || side == CONGESTED_SOUTH ? 1.0F : -1.0F;
        const bool is_x1 = side == CONGESTED_WEST || side == CONGESTED_EAST;
        for (ptrdiff_t k = c->range[row].first; k < c->range[row].last; k += SIMD_FLOAT_LANES) {
            const simd_float drop = simd_float_load(beside[side] + k) - simd_float_load(p.own + k);
            simd_float_store(l->flux + k,
                             law(l, k, sign * drop * c->inverse_dx, is_forward, is_x1));
        }
    }
}

static void make_flux(const congested *c, ptrdiff_t row)
{
    if (c->is_forward)
        make_flux_row(c, row, true);
    else
        make_flux_row(c, row, false);
}

// Slip of cargo against the belt at x1-faces: by how much the correction holds it back.
static inline simd_float slip(const congested_law *l, ptrdiff_t k, simd_float full)
{
    const simd_float held = -simd_float_load(l->flux + k);
    const simd_float slip = simd_float_min(simd_float_max(held, simd_float_all(0.0F)), full);

    return simd_float_max(slip, simd_float_load(l->at_rest + k));
}

static const float huge_factor = 1e30F; // times the slowest belt's speed is more than any threshold

static void make_thresholds(const congested *c, ptrdiff_t row)
{
    const ptrdiff_t shift = 1 - congested__shift(row);
    const congested_law west = shifted(c, CONGESTED_WEST, row, 0);
    const congested_law east = shifted(c, CONGESTED_EAST, row, 0);

    for (int side = CONGESTED_SOUTH; side <= CONGESTED_NORTH; side++) {
        const ptrdiff_t other = side == CONGESTED_SOUTH ? row - 1 : row + 1;
        const congested_law own = shifted(c, (congested_side)side, row, 0);
        const congested_law other_west = shifted(c, CONGESTED_EAST, other, shift - 1);
        const congested_law other_east = shifted(c, CONGESTED_WEST, other, shift);
        for (ptrdiff_t k = c->range[row].first; k < c->range[row].last; k += SIMD_FLOAT_LANES) {
            const simd_float full = simd_float_load(own.full_slip + k);
            const simd_float sum = slip(&west, k, full) + slip(&east, k, full) +
                                   slip(&other_west, k, full) + slip(&other_east, k, full);
            const simd_float before = simd_float_load(own.threshold + k);
            const simd_float after = 0.5F * before + 0.5F * simd_float_load(own.gain + k) * sum;
            // The second is negative unless full is 0: where the belt stands a threshold stays.
            simd_float_store(own.threshold + k, simd_float_max(after, before - huge_factor * full));
        }
    }
}

// The fluxes of the faces around the cells of a half row, element k for cell k.
typedef struct row_fluxes {
    const float *side[CONGESTED_SIDES];
} row_fluxes;

static inline row_fluxes fluxes_of(const congested *c, ptrdiff_t row, int colour)
{
    const row_laws laws = laws_of(c, row, colour);
    row_fluxes fluxes;

    for (int side = 0; side < CONGESTED_SIDES; side++)
        fluxes.side[side] = laws.side[side].flux;
    return fluxes;
}

static void correct(const macro_solver *s, const congested *c, ptrdiff_t row, int colour,
                    congested_range cells)
{
    const row_fluxes f = fluxes_of(c, row, colour);
    const ptrdiff_t odd = (row + colour) & 1;
    double *rho = macro__row(s, s->next.rho, row);

    for (ptrdiff_t k = cells.first; k < cells.last && 2 * k + odd < s->n1; k++) {
        const double along = (double)f.side[CONGESTED_EAST][k] - (double)f.side[CONGESTED_WEST][k];
        const double across =
            (double)f.side[CONGESTED_NORTH][k] - (double)f.side[CONGESTED_SOUTH][k];
        rho[2 * k + odd] -= s->lambda1 * along + s->lambda2 * across;
    }
}

static bool is_overdrawn(const macro_solver *s, const congested *c, ptrdiff_t row, int colour,
                         congested_range cells)
{
    const row_fluxes f = fluxes_of(c, row, colour);
    const ptrdiff_t odd = (row + colour) & 1;
    const double *rho = macro__row(s, s->next.rho, row);
    bool is_over = false;

    for (ptrdiff_t k = cells.first; k < cells.last && 2 * k + odd < s->n1; k++) {
        const double west = (double)f.side[CONGESTED_WEST][k];
        const double east = (double)f.side[CONGESTED_EAST][k];
        const double south = (double)f.side[CONGESTED_SOUTH][k];
        const double north = (double)f.side[CONGESTED_NORTH][k];
        const double leaving = (west < 0.0 ? -west : 0.0) + (east > 0.0 ? east : 0.0) +
                               (south < 0.0 ? -south : 0.0) + (north > 0.0 ? north : 0.0);
        is_over |= s->lambda1 * leaving > rho[2 * k + odd] * (1.0 - 1e-9);
    }
    return is_over;
}

const congested_kernels congested__kernels = { .relax = relax,
                                               .make_flux = make_flux,
                                               .transport = congested__transport_upwind,
                                               .muscl_states_x2 = congested__muscl_states_x2,
                                               .muscl_flux_x2 = congested__muscl_flux_x2,
                                               .muscl_update = congested__muscl_update,
                                               .correct = correct,
                                               .is_overdrawn = is_overdrawn,
                                               .make_thresholds = make_thresholds };
