// One step of the congested closure: transport, pressure, correction.

#include "core/base/subnormals.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/macro/congested/transport.h"

#include <float.h>
#include <math.h>
#include <string.h>

// A cell less full than this part of rho_j is not active unless it has a pressure.
static const double active_from = 0.25;

static const float tolerance = 6e-3F; // of the density that the iteration leaves above or below C

// What the members of a team share in a step.
typedef struct step_context {
    macro_solver *s;
    congested *c;
} step_context;

enum { MARGIN_CELLS = 4 }; // beside found cells that are active too, because cargo may enter them

// Rows first <= row < last of a member.
typedef struct row_span {
    ptrdiff_t first;
    ptrdiff_t last;
} row_span;

static row_span even_rows(const macro_solver *s, int member, int n_members)
{
    return (row_span){ s->n2 * member / n_members, s->n2 * (member + 1) / n_members };
}

static congested_range hull(congested_range a, congested_range b)
{
    if (a.first >= a.last)
        return b;
    if (b.first >= b.last)
        return a;
    return (congested_range){ a.first < b.first ? a.first : b.first,
                              a.last > b.last ? a.last : b.last };
}

// The range of whole units with cells i_min <= i <= i_max, as far as they are in the grid.
static congested_range range_of_cells(const macro_solver *s, ptrdiff_t i_min, ptrdiff_t i_max)
{
    const ptrdiff_t low = i_min > 0 ? i_min : 0, high = i_max < s->n1 ? i_max : s->n1 - 1;

    return (congested_range){ low / 2 / CONGESTED_UNIT * CONGESTED_UNIT,
                              (high / 2 / CONGESTED_UNIT + 1) * CONGESTED_UNIT };
}

static bool is_empty(const double *block)
{
    bool is_empty = true;

    for (int k = 0; k < BLOCK_CELLS; k++)
        is_empty = is_empty && block[k] == 0.0;
    return is_empty;
}

// The rows of a member such that all have about the same number of active cells.
static row_span active_rows(const congested *c, int member, int n_members)
{
    ptrdiff_t total = 0, reached = 0, row = c->first_row;
    row_span rows = { c->last_row, c->last_row };

    for (ptrdiff_t j = c->first_row; j < c->last_row; j++)
        total += c->range[j].last - c->range[j].first;
    for (; row < c->last_row && reached < total * member / n_members; row++)
        reached += c->range[row].last - c->range[row].first;
    rows.first = row;
    for (; row < c->last_row && (reached < total * (member + 1) / n_members); row++)
        reached += c->range[row].last - c->range[row].first;
    rows.last = member == n_members - 1 ? c->last_row : row;
    return rows;
}

// The cells of a row from the first to the last that are at least this full, as whole units.
static congested_range full_cells(const macro_solver *s, ptrdiff_t row, double least)
{
    const double *star = macro__row(s, s->next.rho, row);
    const block_span span = s->next.span[row];
    ptrdiff_t first = span.first * BLOCK_CELLS, last = span.last * BLOCK_CELLS - 1;

    while (first <= last && star[first] < least)
        first++;
    while (last >= first && star[last] < least)
        last--;
    if (first > last)
        return (congested_range){ 0, 0 };
    return range_of_cells(s, first - MARGIN_CELLS, last + MARGIN_CELLS);
}

// Same from the first to the last that has a pressure.
static congested_range pressed_cells(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    const float *red = congested__row(c, c->pressure[0], row);
    const float *black = congested__row(c, c->pressure[1], row);
    ptrdiff_t first = c->range[row].first, last = c->range[row].last - 1;

    while (first <= last && red[first] == 0.0F && black[first] == 0.0F)
        first++;
    while (last >= first && red[last] == 0.0F && black[last] == 0.0F)
        last--;
    if (first > last)
        return (congested_range){ 0, 0 };
    return range_of_cells(s, 2 * first - MARGIN_CELLS, 2 * last + 1 + MARGIN_CELLS);
}

// Finds the cells of a row that may need a pressure, by `next`, which holds rho*.
static void find_cells(const macro_solver *s, congested *c, ptrdiff_t row)
{
    if (c->n_unskipped == CONGESTED_PRESSED_STEPS)
        c->pressed[0][row] = pressed_cells(s, c, row);
    c->found[row] = hull(full_cells(s, row, active_from * c->jam_density), c->pressed[0][row]);
}

// The active cells of a row: those found in it and in the rows next to it.
static congested_range dilated(const macro_solver *s, const congested_range *found, ptrdiff_t row)
{
    congested_range all = found[row];

    if (row > 0)
        all = hull(all, found[row - 1]);
    if (row + 1 < s->n2)
        all = hull(all, found[row + 1]);
    return all;
}

// Faces of half cells first <= k < last are those of cells in the unit behind them and in the next row, too, which may be those of
// another member.
static void unsettle(congested *c, ptrdiff_t row, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t j = row; j <= row + 1; j++)
        for (ptrdiff_t k = first; k <= last; k += CONGESTED_UNIT)
            __atomic_store_n(congested__flags(c, c->is_unsettled, j, 0) + k / CONGESTED_UNIT, true,
                             __ATOMIC_RELAXED);
}

// Clears the pressures, thresholds and fluxes of half cells first <= k < last, and the fluxes of black ones through the sides of
// the grid.
static void clear_cells(const macro_solver *s, congested *c, ptrdiff_t row, ptrdiff_t first,
                        ptrdiff_t last)
{
    if (first >= last)
        return;
    const size_t n_bytes = (size_t)(last - first) * sizeof(float);
    for (int colour = 0; colour < 2; colour++)
        memset(congested__row(c, c->pressure[colour], row) + first, 0, n_bytes);
    for (int side = 0; side < CONGESTED_SIDES; side++) {
        const congested_law *l = &c->law[side];
        memset(congested__row(c, l->flux, row) + first, 0, n_bytes);
        memset(congested__row(c, l->threshold, row) + first, 0, n_bytes);
        if (!c->is_forward)
            memset(congested__row(c, l->crosswise, row) + first, 0, n_bytes);
    }
    if (first == 0)
        congested__row(c, c->law[CONGESTED_EAST].flux, row)[-1] = 0.0F;
    if (2 * last == s->n1)
        congested__row(c, c->law[CONGESTED_WEST].flux, row)[last] = 0.0F;
    if (row == 0)
        memset(congested__row(c, c->law[CONGESTED_NORTH].flux, -1) + first, 0, n_bytes);
    if (row == s->n2 - 1)
        memset(congested__row(c, c->law[CONGESTED_SOUTH].flux, s->n2) + first, 0, n_bytes);
    unsettle(c, row, first, last);
}

// Makes a row's active cells those of this step. Cells that are not active any more have no pressure. While no belt moves the
// same ones stay active, so that what is known of their faces stays, too.
static void set_active(const macro_solver *s, congested *c, ptrdiff_t row)
{
    const congested_range before = c->range[row];
    const congested_range now = c->has_moving ? dilated(s, c->found, row) : before;

    if (now.first >= now.last) {
        clear_cells(s, c, row, before.first, before.last);
    } else {
        clear_cells(s, c, row, before.first, before.last < now.first ? before.last : now.first);
        clear_cells(s, c, row, before.first > now.last ? before.first : now.last, before.last);
    }
    c->range[row] = now;
    c->kernels.set_excess(s, c, row);
}

// Where the belt stands nothing moves that could bring a pressure to its density: cells without an open face keep
// their pressures, with which they go on as soon as it moves.
static void hold_pressures(const macro_solver *s, congested *c, ptrdiff_t row)
{
    const congested_range cells = c->range[row];

    for (ptrdiff_t i = 2 * cells.first; i < 2 * cells.last && i < s->n1; i++)
        if (*CONGESTED_FACE1(c, least, i, row) == 0.0F &&
            *CONGESTED_FACE1(c, least, i + 1, row) == 0.0F &&
            *CONGESTED_FACE2(c, least, i, row) == 0.0F &&
            *CONGESTED_FACE2(c, least, i, row + 1) == 0.0F)
            congested__row(c, c->excess[(i + row) & 1], row)[i >> 1] = 0.0F;
}

static void find_rows(const macro_solver *s, congested *c)
{
    c->first_row = 0;
    c->last_row = s->n2;
    while (c->first_row < c->last_row &&
           c->range[c->first_row].first >= c->range[c->first_row].last)
        c->first_row++;
    while (c->last_row > c->first_row &&
           c->range[c->last_row - 1].first >= c->range[c->last_row - 1].last)
        c->last_row--;
}

static double count_active(const congested *c)
{
    ptrdiff_t n = 0;

    for (ptrdiff_t row = c->first_row; row < c->last_row; row++)
        n +=
            2 * (c->range[row].last > c->range[row].first ? c->range[row].last - c->range[row].first
                                                          : 0);
    return (double)n;
}

// One sweep over a member's rows, red before black. A black row follows as soon as the red rows around it are
// relaxed, while the laws of their faces are still in the cache; the first and the last need the neighbours' rows.
static float sweep(const congested *c, row_span rows, bool is_first, team_barrier *barrier)
{
    const congested_kernels *kernels = &c->kernels;
    float largest = kernels->relax(c, rows.first, rows.last, is_first);

    team_barrier_wait(barrier);
    if (rows.first < rows.last)
        largest = fmaxf(largest, kernels->relax_black(c, rows.first, is_first));
    if (rows.last - 1 > rows.first)
        largest = fmaxf(largest, kernels->relax_black(c, rows.last - 1, is_first));
    return largest;
}

// Relaxes red and black cells in turn until the largest residual of a sweep is below the tolerance. Returns the number of sweeps.
static int relax(congested *c, row_span rows, int member, int n_members, team_barrier *barrier)
{
    const float enough = tolerance * c->relaxation;

    for (int k = 0; k < CONGESTED_SWEEPS; k++) {
        congested_slot *slots = c->slots + (k & 1) * n_members;
        float largest = slots[member].residual = sweep(c, rows, k == 0, barrier);
        team_barrier_wait(barrier);
        for (int other = 0; other < n_members; other++)
            largest = slots[other].residual > largest ? slots[other].residual : largest;
        if (largest < enough)
            return k + 1;
    }
    return CONGESTED_SWEEPS;
}

// The fluxes around a cell, towards rising x.
typedef struct cell_faces {
    float *side[CONGESTED_SIDES];
} cell_faces;

static cell_faces faces_of(const congested *c, ptrdiff_t i, ptrdiff_t row)
{
    return (cell_faces){ { CONGESTED_FACE1(c, flux, i, row), CONGESTED_FACE1(c, flux, i + 1, row),
                           CONGESTED_FACE2(c, flux, i, row),
                           CONGESTED_FACE2(c, flux, i, row + 1) } };
}

// Cells of a row whose density the correction may change: active ones and their neighbours.
static congested_range changed_cells(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    congested_range all = dilated(s, c->range, row);

    if (all.first >= all.last)
        return all;
    return range_of_cells(s, 2 * all.first - 1, 2 * all.last);
}

// Finds the cells of a row with a pressure after the relaxation.
static void find_pressed(const macro_solver *s, congested *c, ptrdiff_t row)
{
    for (int k = CONGESTED_PRESSED_STEPS - 1; k > 0; k--)
        c->pressed[k][row] = c->pressed[k - 1][row];
    c->pressed[0][row] = pressed_cells(s, c, row);
}

// The cells of a row that a pressure may reach. A flux depends on the pressures beside its face and, through the gradient along it, on
// those of the step before around its ends, a threshold on the fluxes around its face: none is farther than two rows and MARGIN_CELLS.
// In one step more what has become 0 is written as 0; from then on it is left as it is.
static congested_range disturbed_cells(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    const ptrdiff_t first = row > 2 ? row - 2 : 0, last = row + 3 < s->n2 ? row + 3 : s->n2;
    congested_range all = { 0, 0 };

    if (c->n_unskipped > 0)
        return changed_cells(s, c, row);
    for (int k = 0; k < CONGESTED_PRESSED_STEPS; k++)
        for (ptrdiff_t j = first; j < last; j++)
            all = hull(all, c->pressed[k][j]);
    return all;
}

static void make_flux(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    const congested_range active = c->range[row], disturbed = c->disturbed[row];
    const congested_range cells = { active.first > disturbed.first ? active.first : disturbed.first,
                                    active.last < disturbed.last ? active.last : disturbed.last };

    if (cells.first < cells.last)
        c->kernels.make_flux(s, c, row, cells);
}

// A flux times a part of 1, and 0 where a float would not be exact enough.
static float scaled(float flux, float part)
{
    return fabsf(flux * part) >= FLT_MIN ? flux * part : 0.0F;
}

// A flux between rows of two members may be read by the one while the other, whose cell it leaves, scales it. Scaling keeps its
// sign or makes it 0, and what comes in counts as 0, so the value that is read does not matter.
static float read_flux(const float *flux)
{
    float value;

    __atomic_load(flux, &value, __ATOMIC_RELAXED);
    return value;
}

// Scales what leaves a cell that would lose more than it has. Each flux has one cell that it leaves.
static void limit_cell(const macro_solver *s, const congested *c, ptrdiff_t i, ptrdiff_t row,
                       double rho)
{
    const cell_faces faces = faces_of(c, i, row);
    float flux[CONGESTED_SIDES];
    bool is_leaving[CONGESTED_SIDES];
    double leaving = 0.0;

    for (int side = 0; side < CONGESTED_SIDES; side++) {
        flux[side] = read_flux(faces.side[side]);
        is_leaving[side] = (side & 1) != 0 ? flux[side] > 0.0F : flux[side] < 0.0F;
        leaving += is_leaving[side] ? fabs((double)flux[side]) : 0.0;
    }
    if (s->lambda1 * leaving <= rho * CONGESTED_MOST_LOST)
        return;
    const float part = (float)(rho * CONGESTED_MOST_LOST / (s->lambda1 * leaving) * (1.0 - 1e-6));
    for (int side = 0; side < CONGESTED_SIDES; side++) {
        const float kept = scaled(flux[side], part);
        if (is_leaving[side])
            __atomic_store(faces.side[side], &kept, __ATOMIC_RELAXED);
    }
}

static void limit_row(const macro_solver *s, const congested *c, ptrdiff_t row)
{
    const double *rho = macro__row(s, s->next.rho, row);
    const congested_range cells = c->disturbed[row];

    for (ptrdiff_t i = 2 * cells.first; i < 2 * cells.last && i < s->n1; i++)
        limit_cell(s, c, i, row, rho[i]);
}

// rho = rho* - dt div G in a row, and where its cargo is then.
static void correct_row(macro_solver *s, const congested *c, ptrdiff_t row)
{
    const congested_range cells = c->disturbed[row];
    double *rho = macro__row(s, s->next.rho, row);
    block_span span = s->next.span[row];

    if (cells.first < cells.last) {
        c->kernels.correct(s, c, row, cells);
        span = block_span_hull(
            span, (block_span){ 2 * cells.first / BLOCK_CELLS, 2 * cells.last / BLOCK_CELLS });
        span.last = span.last < s->n_blocks ? span.last : s->n_blocks;
    }
    while (span.first < span.last && is_empty(rho + span.first * BLOCK_CELLS))
        span.first++;
    while (span.first < span.last && is_empty(rho + (span.last - 1) * BLOCK_CELLS))
        span.last--;
    s->next.span[row] = span;
}

// A member's part of the limiter: what leaves a cell is at most what it has.
static void limit(const step_context *x, row_span rows, int member, int n_members,
                  team_barrier *barrier)
{
    const macro_solver *s = x->s;
    congested *c = x->c;
    bool is_limited = false;

    c->slots[member].is_limited = false;
    for (ptrdiff_t row = rows.first; row < rows.last; row++)
        if (c->kernels.is_overdrawn(s, c, row, c->disturbed[row]))
            c->slots[member].is_limited = true;
    team_barrier_wait(barrier);
    for (int k = 0; k < n_members; k++)
        is_limited = is_limited || c->slots[k].is_limited;
    if (!is_limited)
        return;
    for (ptrdiff_t row = rows.first; row < rows.last; row++)
        limit_row(s, c, row);
    team_barrier_wait(barrier);
}

// A member's part of a step.
static void step_member(void *context, int member, int n_members, team_barrier *barrier)
{
    const step_context *x = context;
    macro_solver *s = x->s;
    congested *c = x->c;
    const row_span all = even_rows(s, member, n_members);
    const uint64_t arithmetic = subnormals_flush();

    congested__transport(s, member, all.first, all.last, barrier);
    for (ptrdiff_t row = all.first; row < all.last; row++)
        find_cells(s, c, row);
    team_barrier_wait(barrier);
    for (ptrdiff_t row = all.first; row < all.last; row++) {
        set_active(s, c, row);
        if (c->has_standing)
            hold_pressures(s, c, row);
    }
    team_barrier_wait(barrier);
    if (member == 0)
        find_rows(s, c);
    team_barrier_wait(barrier);
    const row_span active = active_rows(c, member, n_members);
    const int n_sweeps = relax(c, active, member, n_members, barrier);
    if (member == 0)
        c->relaxed += n_sweeps * count_active(c);
    for (ptrdiff_t row = all.first; row < all.last; row++)
        find_pressed(s, c, row);
    team_barrier_wait(barrier);
    for (ptrdiff_t row = all.first; row < all.last; row++)
        c->disturbed[row] = disturbed_cells(s, c, row);
    team_barrier_wait(barrier);
    for (ptrdiff_t row = active.first; row < active.last; row++)
        make_flux(s, c, row);
    team_barrier_wait(barrier);
    limit(x, all, member, n_members, barrier);
    for (ptrdiff_t row = all.first; row < all.last; row++)
        correct_row(s, c, row);
    for (ptrdiff_t row = active.first; row < active.last; row++)
        if (c->is_forward)
            c->kernels.make_thresholds(s, c, row);
        else
            c->kernels.make_coupling(s, c, row);
    subnormals_restore(arithmetic);
}

void congested_step(macro_solver *s)
{
    step_context x = { s, s->congested };

    team_run(s->def.n_threads, step_member, &x);
    if (s->congested->n_unskipped > 0 && !s->congested->has_standing)
        s->congested->n_unskipped--;
}
