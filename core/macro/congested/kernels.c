// The loops over cells of the congested closure, compiled once per instruction set.

#include "core/base/simd_float.h"
#include "core/base/simd_pairs.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/macro/congested/transport.h"

// The law along the belt: slope 1, then `slope`, then none. It is concave, so the least of its pieces; `outer` is the
// second.
static inline simd_float law_along(simd_float g, simd_float outer, simd_float most,
                                   simd_float least)
{
    return simd_float_max(simd_float_min(simd_float_min(g, outer), most), least);
}

// The law across it: a threshold, then two bounds.
static inline simd_float law_across(simd_float g, simd_float threshold, simd_float lower,
                                    simd_float upper)
{
    const simd_float inside = simd_float_min(simd_float_max(g, -threshold), threshold);

    return simd_float_min(simd_float_max(g - inside, lower), upper);
}

// The laws that a loop reads: the uniform ones, those of a forward solver, where each face has one, or both.
// With has_drives both count by what their belt drives cargo by.
typedef enum loop_kind { LOOP_UNIFORM, LOOP_FORWARD, LOOP_OBLIQUE, LOOP_DRIVES } loop_kind;

static inline simd_float law_along_at(const congested_law *l, ptrdiff_t at, simd_float g,
                                      loop_kind kind)
{
    const simd_float outer = g * simd_float_load(l->slope + at) + simd_float_load(l->offset + at);
    const simd_float inner = kind == LOOP_DRIVES ? g * simd_float_load(l->inner + at) : g;

    return law_along(inner, outer, simd_float_load(l->most + at), simd_float_load(l->least + at));
}

static inline simd_float law_across_at(const congested_law *l, ptrdiff_t at, simd_float g,
                                       loop_kind kind)
{
    const simd_float driven = kind == LOOP_DRIVES ? g * simd_float_load(l->sideways + at) : g;

    return law_across(driven, simd_float_load(l->threshold + at), simd_float_load(l->lower + at),
                      simd_float_load(l->upper + at));
}

// G.e of faces by the pressure gradient g along e.
static inline __attribute__((always_inline)) simd_float law(const congested_uniform *uniform,
                                                            const congested_law *l, ptrdiff_t at,
                                                            simd_float g, loop_kind kind,
                                                            bool is_x1)
{
    if (kind == LOOP_UNIFORM && is_x1)
        return law_along(g, g * uniform->slope, simd_float_all(uniform->most),
                         simd_float_all(uniform->least));
    if (kind == LOOP_UNIFORM)
        return law_across(g, simd_float_load(l->threshold + at), simd_float_all(uniform->lower),
                          simd_float_all(uniform->upper));
    if (kind == LOOP_FORWARD)
        return is_x1 ? law_along_at(l, at, g, kind) : law_across_at(l, at, g, kind);
    const simd_float along = simd_float_load(l->along + at);
    const simd_float across = simd_float_load(l->across + at);
    const simd_float crosswise = simd_float_load(l->crosswise + at);

    return along * law_along_at(l, at, along * g - across * crosswise, kind) +
           across * law_across_at(l, at, across * g + along * crosswise, kind);
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

// What the relaxation reads of the solver and of a half row: copies, so that no store to a pressure can change them.
typedef struct half_row {
    congested_uniform uniform;
    float steepness;
    float lambda;
    float relaxation;
    congested_law law[CONGESTED_SIDES]; // of the faces around the cells
    ptrdiff_t at[CONGESTED_SIDES];      // element of the face of cell 0 in it
    row_pressures p;
    const float *excess;
    const float *relaxations; // NULL without has_drives
} half_row;

static inline __attribute__((always_inline)) half_row half_row_of(const congested *c, ptrdiff_t row,
                                                                  int colour)
{
    const congested_row_faces faces = congested__faces(c, row, colour);
    half_row r = { .uniform = c->uniform,
                   .steepness = c->steepness,
                   .lambda = c->lambda,
                   .relaxation = c->relaxation,
                   .p = pressures_of(c, row, colour),
                   .excess = congested__row(c, c->excess[colour], row),
                   .relaxations =
                       c->has_drives ? congested__row(c, c->relaxations[colour], row) : NULL };

    for (int side = 0; side < CONGESTED_SIDES; side++) {
        r.law[side] = *faces.side[side].law;
        r.at[side] = faces.side[side].at;
    }
    return r;
}

// What flows into cells k on through their faces on a side by the drop of the pressure towards rising x.
static inline __attribute__((always_inline)) simd_float flux(const half_row *r, congested_side side,
                                                             ptrdiff_t k, simd_float drop,
                                                             loop_kind kind)
{
    return law(&r->uniform, &r->law[side], r->at[side] + k, drop, kind,
               side == CONGESTED_WEST || side == CONGESTED_EAST);
}

// Relaxes a register of cells; returns the larger of `largest` and of the changes of their pressures on a level belt.
static inline __attribute__((always_inline)) simd_float relax_cells(const half_row *r, ptrdiff_t k,
                                                                    loop_kind kind,
                                                                    simd_float largest)
{
    const simd_float here = simd_float_load(r->p.own + k);
    const simd_float west = simd_float_load(r->p.west + k) - here;
    const simd_float east = here - simd_float_load(r->p.east + k);
    const simd_float south = r->steepness * (simd_float_load(r->p.south + k) - here);
    const simd_float north = r->steepness * (here - simd_float_load(r->p.north + k));
    const simd_float in =
        flux(r, CONGESTED_WEST, k, west, kind) - flux(r, CONGESTED_EAST, k, east, kind) +
        flux(r, CONGESTED_SOUTH, k, south, kind) - flux(r, CONGESTED_NORTH, k, north, kind);
    const simd_float residual = simd_float_load(r->excess + k) + r->lambda * in;
    const simd_float relaxation =
        kind == LOOP_DRIVES ? simd_float_load(r->relaxations + k) : simd_float_all(r->relaxation);
    const simd_float relaxed = simd_float_max(here + relaxation * residual, simd_float_all(0.0F));
    simd_float change = relaxed - here;

    simd_float_store(r->p.own + k, relaxed);
    if (kind == LOOP_DRIVES)
        change *= r->relaxation / relaxation; // as if by the residual alone
    return simd_float_max(largest, simd_float_max(change, -change));
}

// True if a register of cells, from cell k on, is uniform. It has a group, or two, or is half of one.
static inline bool are_uniform(const bool *groups, ptrdiff_t k)
{
    const size_t first = (size_t)k / CONGESTED_GROUP;

    return groups[first] && groups[first + (SIMD_FLOAT_LANES - 1) / CONGESTED_GROUP];
}

// True if no cell of a register, nor one beside it, has a pressure.
static inline bool is_unpressed(const row_pressures *p, ptrdiff_t k)
{
    typedef int32_t lanes __attribute__((vector_size(SIMD_FLOAT_LANES * sizeof(int32_t))));
    const lanes bits = (lanes)simd_float_load(p->own + k) | (lanes)simd_float_load(p->west + k) |
                       (lanes)simd_float_load(p->east + k) | (lanes)simd_float_load(p->south + k) |
                       (lanes)simd_float_load(p->north + k);

    return !simd_float_has_bits((simd_float)bits);
}

// True if the first sweep may give a pressure to a register of cells that has none in it or beside it: its density is too high, or
// gradients along its faces from the step before drive a flux.
static inline bool may_rise(const congested *c, ptrdiff_t row, const half_row *r, ptrdiff_t k,
                            loop_kind kind)
{
    const congested_range disturbed = c->disturbed[row];
    const bool is_driven = kind != LOOP_FORWARD &&
                           (c->n_unskipped > 0 || (disturbed.first <= k && k < disturbed.last));

    return is_driven || simd_float_has_bits(
                            simd_float_max(simd_float_load(r->excess + k), simd_float_all(0.0F)));
}

// `kind` is that of the cells that are not uniform. Cells without a pressure, in them or beside them, that get none in the first
// sweep of a step get none in later ones either, as long as there is none: these are skipped, with the same bits.
static inline __attribute__((always_inline)) simd_float relax_row(const congested *c, ptrdiff_t row,
                                                                  int colour, loop_kind kind,
                                                                  bool is_first, simd_float largest)
{
    const half_row r = half_row_of(c, row, colour);
    const bool *groups = congested__flags(c, c->is_uniform, row, colour);
    bool *unforced = congested__flags(c, c->is_unforced, row, colour);
    const congested_range cells = c->range[row];

    for (ptrdiff_t k = cells.first; k < cells.last; k += SIMD_FLOAT_LANES) {
        bool *is_unforced = unforced + k / SIMD_FLOAT_LANES;
        if (is_first)
            *is_unforced = is_unpressed(&r.p, k);
        if (*is_unforced && !(is_first ? may_rise(c, row, &r, k, kind) : !is_unpressed(&r.p, k)))
            continue;
        if (kind == LOOP_FORWARD && are_uniform(groups, k))
            largest = relax_cells(&r, k, LOOP_UNIFORM, largest);
        else
            largest = relax_cells(&r, k, kind, largest);
        if (is_first)
            *is_unforced = *is_unforced && !simd_float_has_bits(simd_float_load(r.p.own + k));
    }
    return largest;
}

// The loop over rows is in here and not in step.c: a row has some 70 active cells of a colour in a jam, few enough
// that a call for each row, and the largest lane of its changes, would count.
static inline __attribute__((always_inline)) float relax_rows(const congested *c, ptrdiff_t first,
                                                              ptrdiff_t last, loop_kind kind,
                                                              bool is_first)
{
    simd_float largest = simd_float_all(0.0F);

    for (ptrdiff_t row = first; row < last; row++) {
        largest = relax_row(c, row, 0, kind, is_first, largest);
        if (row - 1 > first)
            largest = relax_row(c, row - 1, 1, kind, is_first, largest);
    }
    return simd_float_largest(largest, 0.0F);
}

static float relax_any(const congested *c, ptrdiff_t first, ptrdiff_t last, loop_kind kind,
                       bool is_first)
{
    return is_first ? relax_rows(c, first, last, kind, true)
                    : relax_rows(c, first, last, kind, false);
}

static float relax(const congested *c, ptrdiff_t first, ptrdiff_t last, bool is_first)
{
    return c->is_forward   ? relax_any(c, first, last, LOOP_FORWARD, is_first)
           : c->has_drives ? relax_any(c, first, last, LOOP_DRIVES, is_first)
                           : relax_any(c, first, last, LOOP_OBLIQUE, is_first);
}

static float relax_black(const congested *c, ptrdiff_t row, bool is_first)
{
    const simd_float none = simd_float_all(0.0F);

    return simd_float_largest(c->is_forward   ? relax_row(c, row, 1, LOOP_FORWARD, is_first, none)
                              : c->has_drives ? relax_row(c, row, 1, LOOP_DRIVES, is_first, none)
                                              : relax_row(c, row, 1, LOOP_OBLIQUE, is_first, none),
                              0.0F);
}

// The fluxes through the faces on a side of red cells first <= k < last of a row, in whole registers.
static inline __attribute__((always_inline)) void make_side_flux(const congested *c, ptrdiff_t row,
                                                                 congested_side side,
                                                                 congested_range cells,
                                                                 loop_kind kind)
{
    const congested_side_faces f = congested__faces(c, row, 0).side[side];
    const row_pressures p = pressures_of(c, row, 0);
    const float *beside[CONGESTED_SIDES] = { p.west, p.east, p.south, p.north };
    // Fluxes are taken towards rising x: into the cell on its west and south sides.
    const float sign = side == CONGESTED_WEST || side == CONGESTED_SOUTH ? 1.0F : -1.0F;
    const bool is_x1 = side == CONGESTED_WEST || side == CONGESTED_EAST;
    const float scale = is_x1 ? sign : sign * c->steepness;

    for (ptrdiff_t k = cells.first; k < cells.last; k += SIMD_FLOAT_LANES) {
        const simd_float drop = simd_float_load(beside[side] + k) - simd_float_load(p.own + k);
        simd_float_store(f.law->flux + f.at + k,
                         law(&c->uniform, f.law, f.at + k, scale * drop, kind, is_x1));
    }
}

// Where the cell at a side of the grid is black, the face there is that of a red cell beyond it.
static inline __attribute__((always_inline)) void make_flux_row(const macro_solver *s,
                                                                const congested *c, ptrdiff_t row,
                                                                congested_range cells,
                                                                loop_kind kind)
{
    for (int side = 0; side < CONGESTED_SIDES; side++)
        make_side_flux(c, row, side, cells, kind);
    if (cells.first == 0 && cells.last > 0)
        make_side_flux(c, row, CONGESTED_EAST, (congested_range){ -SIMD_FLOAT_LANES, 0 }, kind);
    if (2 * cells.last == s->n1)
        make_side_flux(c, row, CONGESTED_WEST,
                       (congested_range){ cells.last, cells.last + SIMD_FLOAT_LANES }, kind);
    if (row == 0)
        make_side_flux(c, -1, CONGESTED_NORTH, cells, kind);
    if (row == s->n2 - 1)
        make_side_flux(c, s->n2, CONGESTED_SOUTH, cells, kind);
}

static void make_flux(const macro_solver *s, const congested *c, ptrdiff_t row,
                      congested_range cells)
{
    if (c->is_forward)
        make_flux_row(s, c, row, cells, LOOP_FORWARD);
    else if (c->has_drives)
        make_flux_row(s, c, row, cells, LOOP_DRIVES);
    else
        make_flux_row(s, c, row, cells, LOOP_OBLIQUE);
}

// Slip of cargo against the belt at x1-faces: by how much the correction holds it back.
static inline simd_float slip(congested_side_faces f, ptrdiff_t k, simd_float full)
{
    const simd_float held = -simd_float_load(f.law->flux + f.at + k);
    const simd_float slip = simd_float_min(simd_float_max(held, simd_float_all(0.0F)), full);

    return simd_float_max(slip, simd_float_load(f.law->at_rest + f.at + k));
}

static const float huge_factor = 1e30F; // times the slowest belt's speed is more than any threshold

// The first unit from cell k on, of a row's active ones, whose thresholds may change; the end of the active ones if there is none.
static inline ptrdiff_t next_unsettled(const congested *c, ptrdiff_t row, ptrdiff_t k)
{
    const bool *is_unsettled = congested__flags(c, c->is_unsettled, row, 0);
    const congested_range disturbed = c->disturbed[row];

    while (k < c->range[row].last && !is_unsettled[k / CONGESTED_UNIT] &&
           (k < disturbed.first || k >= disturbed.last))
        k += CONGESTED_UNIT;
    return k;
}

// Brings a register of thresholds to the slip of this step; `beyond` are the faces of the black cells beyond them. True if one changes.
static inline bool make_threshold(const congested_row_faces *faces,
                                  const congested_row_faces *beyond, congested_side side,
                                  ptrdiff_t k)
{
    const congested_side_faces own = faces->side[side];
    float *threshold = own.law->threshold + own.at + k;
    const simd_float full = simd_float_load(own.law->full_slip + own.at + k);
    const simd_float sum =
        slip(faces->side[CONGESTED_WEST], k, full) + slip(faces->side[CONGESTED_EAST], k, full) +
        slip(beyond->side[CONGESTED_WEST], k, full) + slip(beyond->side[CONGESTED_EAST], k, full);
    const simd_float gain = simd_float_load(own.law->gain + own.at + k);
    const simd_float before = simd_float_load(threshold);
    const simd_float after = 0.5F * before + 0.5F * gain * sum;
    // The second is negative unless full is 0: where the belt stands a threshold stays.
    const simd_float made = simd_float_max(after, before - huge_factor * full);

    simd_float_store(threshold, made);
    return simd_float_has_bits((simd_float)(made != before));
}

static void make_thresholds(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    const congested_row_faces faces = congested__faces(c, row, 0);
    const congested_row_faces south = congested__faces(c, row - 1, 1);
    const congested_row_faces north = congested__faces(c, row + 1, 1);
    bool *is_unsettled = congested__flags(c, c->is_unsettled, row, 0);

    for (ptrdiff_t unit = next_unsettled(c, row, c->range[row].first); unit < c->range[row].last;
         unit = next_unsettled(c, row, unit + CONGESTED_UNIT)) {
        bool has_changed = false;
        // On the sides of the grid there is nothing beyond that it could rub against.
        for (ptrdiff_t k = unit; k < unit + CONGESTED_UNIT; k += SIMD_FLOAT_LANES) {
            if (row > 0)
                has_changed |= make_threshold(&faces, &south, CONGESTED_SOUTH, k);
            if (row < s->n2 - 1)
                has_changed |= make_threshold(&faces, &north, CONGESTED_NORTH, k);
        }
        is_unsettled[unit / CONGESTED_UNIT] = has_changed;
    }
}

// What a register of faces of one axis couples with: a face of the other axis that ends at it, k for k.
typedef struct crossing_faces {
    congested_side_faces faces; // element of face 0
    const float *before;        // pressures of the cells before them, towards falling x
    const float *after;         // and behind them
} crossing_faces;

enum { CROSSINGS = 4 }; // of a face

// x where a lane of `mask` is set, else y.
static inline simd chosen(__typeof__((simd){ 0 } > (simd){ 0 }) mask, simd x, simd y)
{
    typedef __typeof__(mask) lanes;

    return (simd)((mask & (lanes)x) | (~mask & (lanes)y));
}

// The gradient along faces and the slip at them, from the faces of the other axis around. `ratio` is that of the cells' edges: a
// constant 1 where they are square, so that nothing is divided by it.
static inline __attribute__((always_inline)) void couple_faces(
    int axis, double ratio, congested_side_faces own, const crossing_faces crossings[CROSSINGS],
    ptrdiff_t k, simd *ret_crosswise, simd *ret_threshold)
{
    const ptrdiff_t at = own.at + k;
    const simd along = simd_load_floats(own.law->along + at);
    const simd across = simd_load_floats(own.law->across + at);
    const simd full = simd_load_floats(own.law->full_slip + at);
    const simd zero = simd_all(0.0);
    const double sign = axis == 0 ? 1.0 : -1.0; // of the left of the normal on the other axis
    const double own_scale = axis == 0 ? 1.0 : ratio, other_scale = axis == 0 ? ratio : 1.0;
    simd gradient = zero, slip = zero;

    for (int n = 0; n < CROSSINGS; n++) {
        const congested_side_faces other = crossings[n].faces;
        const simd drop = simd_float_differences(crossings[n].before + k, crossings[n].after + k);
        const simd parallel =
            along * simd_load_floats(own.law->flux + at) / own_scale -
            across * sign * simd_load_floats(other.law->flux + other.at + k) / other_scale;
        const simd held = simd_max(zero - parallel, zero);
        // A closed face beside one that mostly lies along the belt holds its cargo back.
        const __typeof__(full > full) is_closed =
            simd_load_floats(other.law->least + other.at + k) == zero;
        const __typeof__(full > full) is_held = is_closed & (simd_max(along, -along) < 0.5);
        slip += chosen(is_held | (held > full), full, held);
        gradient += chosen(is_closed, zero, sign * drop);
    }
    const simd threshold = simd_load_floats(own.law->threshold + at);
    // Along x2 the gradient is the drop times the ratio, and at an x2-face it is kept times the ratio: once in each case.
    const simd crosswise = 0.25 * ratio * gradient;
    const simd gain = simd_load_floats(own.law->gain + at);
    // Where the belt stands both stay, like pressures.
    *ret_crosswise = chosen(full == zero, simd_load_floats(own.law->crosswise + at), crosswise);
    *ret_threshold = chosen(full == zero, threshold, 0.5 * threshold + 0.5 * gain * slip);
}

// Stores the lanes of elements first <= k < last of those from k on; true if one changes.
static inline bool store_between(float *at, ptrdiff_t k, ptrdiff_t first, ptrdiff_t last, simd x)
{
    float before[SIMD_LANES];

    memcpy(before, at + k, sizeof before);
    if (first <= k && k + SIMD_LANES <= last) {
        simd_store_floats(at + k, x);
    } else {
        for (int lane = 0; lane < SIMD_LANES; lane++)
            if (first <= k + lane && k + lane < last)
                at[k + lane] = (float)x[lane];
    }
    return memcmp(before, at + k, sizeof before) != 0;
}

// The west (axis 0) or south faces first <= k < last of the cells of a half row, and those of the other axis around each.
typedef struct coupling {
    congested_side_faces own;
    crossing_faces crossings[CROSSINGS];
    ptrdiff_t first;
    ptrdiff_t last;
} coupling;

static inline coupling coupling_of(const macro_solver *s, const congested *c, ptrdiff_t row,
                                   int colour, int axis)
{
    const ptrdiff_t odd = (row + colour) & 1; // cell k of the half row is cell 2 k + odd of the row
    // The cells before the faces, in the other half row of this row or in the row below.
    const congested_row_faces here = congested__faces(c, row, colour);
    const congested_row_faces next = congested__faces(c, axis == 0 ? row : row - 1, 1 - colour);
    const ptrdiff_t shift = axis == 0 ? odd - 1 : 0;
    const congested_side lower = axis == 0 ? CONGESTED_SOUTH : CONGESTED_WEST;
    const congested_side upper = axis == 0 ? CONGESTED_NORTH : CONGESTED_EAST;
    coupling x = { .own = here.side[axis == 0 ? CONGESTED_WEST : CONGESTED_SOUTH],
                   .first = axis == 0 && odd == 0 ? 1 : 0,
                   .last = (s->n1 - odd + 1) / 2 };

    for (int n = 0; n < CROSSINGS; n++) {
        // Of two faces of a cell: those before both cells, then those behind them, or both of one cell and then of the other.
        const bool is_here = axis == 0 ? (n & 1) != 0 : (n >> 1) != 0;
        const bool is_upper = axis == 0 ? (n >> 1) != 0 : (n & 1) != 0;
        const ptrdiff_t cell_row = axis == 0 || is_here ? row : row - 1;
        const row_pressures p = pressures_of(c, cell_row, is_here ? colour : 1 - colour);
        const ptrdiff_t by = is_here ? 0 : shift;
        const float *beside = axis == 0  ? (is_upper ? p.north : p.south)
                              : is_upper ? p.east
                                         : p.west;
        x.crossings[n].faces = (is_here ? here : next).side[is_upper ? upper : lower];
        x.crossings[n].faces.at += by;
        x.crossings[n].before = (is_upper ? p.own : beside) + by;
        x.crossings[n].after = (is_upper ? beside : p.own) + by;
    }
    return x;
}

// Couples a unit of faces; true if a threshold changes.
static inline __attribute__((always_inline)) bool couple_unit(const coupling *x, int axis,
                                                              double ratio, ptrdiff_t unit)
{
    const congested_law *law = x->own.law;
    bool has_changed = false;

    for (ptrdiff_t k = unit; k < unit + CONGESTED_UNIT; k += SIMD_LANES) {
        simd crosswise, threshold;
        couple_faces(axis, ratio, x->own, x->crossings, k, &crosswise, &threshold);
        store_between(law->crosswise + x->own.at, k, x->first, x->last, crosswise);
        has_changed |= store_between(law->threshold + x->own.at, k, x->first, x->last, threshold);
    }
    return has_changed;
}

static inline __attribute__((always_inline)) void couple_row(const macro_solver *s,
                                                             const congested *c, ptrdiff_t row,
                                                             double ratio)
{
    const ptrdiff_t last = c->range[row].last;
    ptrdiff_t unit = next_unsettled(c, row, c->range[row].first);
    bool *is_unsettled = congested__flags(c, c->is_unsettled, row, 0);
    coupling west[2], south[2]; // of both colours

    if (unit >= last)
        return;
    for (int colour = 0; colour < 2; colour++) {
        west[colour] = coupling_of(s, c, row, colour, 0);
        if (row > 0)
            south[colour] = coupling_of(s, c, row, colour, 1);
    }
    for (; unit < last; unit = next_unsettled(c, row, unit + CONGESTED_UNIT)) {
        bool has_changed = false;
        for (int colour = 0; colour < 2; colour++) {
            has_changed |= couple_unit(&west[colour], 0, ratio, unit);
            if (row > 0)
                has_changed |= couple_unit(&south[colour], 1, ratio, unit);
        }
        is_unsettled[unit / CONGESTED_UNIT] = has_changed;
    }
}

static void make_coupling(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    if (c->ratio == 1.0F)
        couple_row(s, c, row, 1.0);
    else
        couple_row(s, c, row, (double)c->ratio);
}

// The fluxes of the faces around the cells of a half row, element k for cell k.
typedef struct row_fluxes {
    const float *side[CONGESTED_SIDES];
} row_fluxes;

static inline row_fluxes fluxes_of(const congested *c, ptrdiff_t row, int colour)
{
    const congested_row_faces faces = congested__faces(c, row, colour);
    row_fluxes fluxes;

    for (int side = 0; side < CONGESTED_SIDES; side++)
        fluxes.side[side] = faces.side[side].law->flux + faces.side[side].at;
    return fluxes;
}

// The half cells k < end of these cells whose places 2 k and 2 k + 1 a row of the density has.
static inline ptrdiff_t last_in_row(const macro_solver *s, congested_range cells)
{
    const ptrdiff_t n = (s->n1 + 2 * BLOCK_CELLS - 1) / (2 * BLOCK_CELLS) * BLOCK_CELLS;

    return cells.last < n ? cells.last : n;
}

// The target density of cells (congested.h): rho_j, or what they have above it, which relaxes under a pressure.
static inline simd target_of(const congested *c, simd rho, simd pressure, double kept)
{
    typedef __typeof__(pressure > pressure) lanes;
    const lanes is_pressed = pressure > simd_all(0.0);
    const simd part =
        (simd)((is_pressed & (lanes)simd_all(kept)) | (~is_pressed & (lanes)simd_all(1.0)));

    return simd_max(rho * part, simd_all(c->jam_density));
}

static void set_excess(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    const double kept = 1.0 - CONGESTED_RELAXING_RATE * s->def.dt;
    const congested_range cells = c->range[row];
    const ptrdiff_t end = last_in_row(s, cells);
    const double *rho = macro__row(s, s->now.rho, row), *star = macro__row(s, s->next.rho, row);
    const int even = (int)(row & 1), odd = 1 - even; // colours of cells 2 k and 2 k + 1
    const float *p_even = congested__row(c, c->pressure[even], row);
    const float *p_odd = congested__row(c, c->pressure[odd], row);
    float *excess_even = congested__row(c, c->excess[even], row);
    float *excess_odd = congested__row(c, c->excess[odd], row);

    for (ptrdiff_t k = cells.first; k < end; k += SIMD_LANES) {
        const simd low = simd_load(star + 2 * k), high = simd_load(star + 2 * k + SIMD_LANES);
        const simd low_rho = simd_load(rho + 2 * k), high_rho = simd_load(rho + 2 * k + SIMD_LANES);
        const simd even_target =
            target_of(c, simd_even(low_rho, high_rho), simd_load_floats(p_even + k), kept);
        const simd odd_target =
            target_of(c, simd_odd(low_rho, high_rho), simd_load_floats(p_odd + k), kept);
        simd_store_floats(excess_even + k, simd_even(low, high) - even_target);
        simd_store_floats(excess_odd + k, simd_odd(low, high) - odd_target);
    }
    for (ptrdiff_t k = s->n1 / 2; k < cells.last; k++) {
        if (2 * k >= s->n1)
            excess_even[k] = -1.0F;
        excess_odd[k] = 2 * k + 1 >= s->n1 ? -1.0F : excess_odd[k];
    }
}

// dt div G of cells k to k + SIMD_LANES - 1 of a half row.
static inline simd loss(const macro_solver *s, const row_fluxes *f, ptrdiff_t k)
{
    const simd along = simd_load_floats(f->side[CONGESTED_EAST] + k) -
                       simd_load_floats(f->side[CONGESTED_WEST] + k);
    const simd across = simd_load_floats(f->side[CONGESTED_NORTH] + k) -
                        simd_load_floats(f->side[CONGESTED_SOUTH] + k);

    return s->lambda1 * along + s->lambda1 * across;
}

static void correct(const macro_solver *s, const congested *c, ptrdiff_t row, congested_range cells)
{
    const row_fluxes even = fluxes_of(c, row, (int)(row & 1));
    const row_fluxes odd = fluxes_of(c, row, 1 - (int)(row & 1));
    const ptrdiff_t end = last_in_row(s, cells);
    double *rho = macro__row(s, s->next.rho, row);

    for (ptrdiff_t k = cells.first; k < end; k += SIMD_LANES) {
        const simd of_even = loss(s, &even, k), of_odd = loss(s, &odd, k);
        double *low = rho + 2 * k, *high = low + SIMD_LANES;
        simd_store(low, simd_load(low) - simd_pairs_low(of_even, of_odd));
        simd_store(high, simd_load(high) - simd_pairs_high(of_even, of_odd));
    }
    // Beyond the grid there is no cargo.
    for (ptrdiff_t i = s->n1; i < 2 * end; i++)
        rho[i] = 0.0;
}

// By how much more cells k to k + SIMD_LANES - 1 of a half row lose through all their faces than they may.
static inline simd overdraft(const macro_solver *s, const row_fluxes *f, ptrdiff_t k, simd rho)
{
    const simd leaving = simd_positive(-simd_load_floats(f->side[CONGESTED_WEST] + k)) +
                         simd_positive(simd_load_floats(f->side[CONGESTED_EAST] + k)) +
                         simd_positive(-simd_load_floats(f->side[CONGESTED_SOUTH] + k)) +
                         simd_positive(simd_load_floats(f->side[CONGESTED_NORTH] + k));

    return s->lambda1 * leaving - rho * CONGESTED_MOST_LOST;
}

static bool is_overdrawn(const macro_solver *s, const congested *c, ptrdiff_t row,
                         congested_range cells)
{
    const row_fluxes even = fluxes_of(c, row, (int)(row & 1));
    const row_fluxes odd = fluxes_of(c, row, 1 - (int)(row & 1));
    const ptrdiff_t end = last_in_row(s, cells);
    const double *rho = macro__row(s, s->next.rho, row);
    simd largest = simd_all(0.0);
    bool is_over = false;

    for (ptrdiff_t k = cells.first; k < end; k += SIMD_LANES) {
        const simd low = simd_load(rho + 2 * k), high = simd_load(rho + 2 * k + SIMD_LANES);
        largest = simd_max(largest, overdraft(s, &even, k, simd_even(low, high)));
        largest = simd_max(largest, overdraft(s, &odd, k, simd_odd(low, high)));
    }
    for (int lane = 0; lane < SIMD_LANES; lane++)
        is_over = is_over || largest[lane] > 0.0;
    return is_over;
}

const congested_kernels congested__kernels = { .relax = relax,
                                               .relax_black = relax_black,
                                               .make_flux = make_flux,
                                               .transport = congested__transport_upwind,
                                               .muscl_states_x2 = congested__muscl_states_x2,
                                               .muscl_flux_x2 = congested__muscl_flux_x2,
                                               .muscl_update = congested__muscl_update,
                                               .set_excess = set_excess,
                                               .correct = correct,
                                               .is_overdrawn = is_overdrawn,
                                               .make_thresholds = make_thresholds,
                                               .make_coupling = make_coupling };
