#include "core/macro/kinds.h"

#include "core/base/memory.h"
#include "core/base/subnormals.h"
#include "core/base/team.h"
#include "core/macro/congested/congested_priv.h"

#include <math.h>
#include <string.h>

struct kinds {
    size_t n;
    double *fractions; // of each cell n, layout of grid.h
    double *carried;   // the same after F_stat'
    double *density;   // of each cell then
    double *slope;     // of each cell: by what its slopes are scaled
    double *fallen; // of each cell n: densities that fell since t = 0; NULL where nothing may fall
};

bf_status kinds_create(const macro_solver *s, size_t n, kinds **ret_kinds)
{
    const size_t n_cells = grid_cells(&s->def.grid);
    kinds *k = memory_alloc(1, sizeof *k);

    if (k == NULL)
        return BF_ENOMEM;
    *k = (kinds){ .n = n,
                  .fractions = memory_alloc(n_cells * n, sizeof *k->fractions),
                  .carried = memory_alloc(n_cells * n, sizeof *k->carried),
                  .density = memory_alloc(n_cells, sizeof *k->density),
                  .slope = memory_alloc(n_cells, sizeof *k->slope),
                  .fallen = s->off != NULL ? memory_alloc(n_cells * n, sizeof *k->fallen) : NULL };
    if (k->fractions == NULL || k->carried == NULL || k->density == NULL || k->slope == NULL ||
        (s->off != NULL && k->fallen == NULL)) {
        kinds_destroy(k);
        return BF_ENOMEM;
    }
    for (size_t c = 0; c < n_cells; c++)
        k->fractions[c * n] = 1.0;
    *ret_kinds = k;
    return BF_OK;
}

kinds *kinds_destroy(kinds *k)
{
    if (k == NULL)
        return NULL;
    memory_free(k->fractions);
    memory_free(k->carried);
    memory_free(k->density);
    memory_free(k->slope);
    memory_free(k->fallen);
    memory_free(k);
    return NULL;
}

// ---- a cell's fractions

// Lets n masses, of which rounding may leave some below 0, be fractions. False: they are all 0, and *ret_fractions as before.
static bool set_fractions(size_t n, const double *masses, double *ret_fractions)
{
    double sum = 0.0;

    for (size_t k = 0; k < n; k++)
        sum += masses[k] > 0.0 ? masses[k] : 0.0;
    for (size_t k = 0; k < n && sum > 0.0; k++)
        ret_fractions[k] = masses[k] > 0.0 ? masses[k] / sum : 0.0;
    return sum > 0.0;
}

static double density_of(const macro_solver *s, size_t cell)
{
    return macro_row(s, cell / (size_t)s->n1)[cell % (size_t)s->n1];
}

const double *macro_fractions(const macro_solver *s, size_t cell)
{
    return s->kinds != NULL ? s->kinds->fractions + cell * s->kinds->n : NULL;
}

void macro_set_fractions(macro_solver *s, size_t cell, const double *fractions)
{
    memcpy(s->kinds->fractions + cell * s->kinds->n, fractions, s->kinds->n * sizeof *fractions);
}

void kinds_mix(macro_solver *s, size_t cell, double density, const double *fractions)
{
    const size_t n = s->kinds->n;
    const double here = density_of(s, cell);
    double *of = s->kinds->fractions + cell * n, masses[SCENE_KINDS_MAX];

    for (size_t k = 0; k < n; k++)
        masses[k] = here * of[k] + density * fractions[k];
    (void)set_fractions(n, masses, of);
}

void macro_take_kind(macro_solver *s, size_t cell, size_t kind, double density)
{
    const size_t n = s->kinds->n;
    const double here = density_of(s, cell);
    double *of = s->kinds->fractions + cell * n, masses[SCENE_KINDS_MAX];
    const double taken = fmin(density, here * of[kind]);

    for (size_t k = 0; k < n; k++)
        masses[k] = here * of[k] - (k == kind ? taken : 0.0);
    // Where the kind is all there is, it stays the cell's kind, of what is then nothing.
    (void)set_fractions(n, masses, of);
    macro_add(s, cell, -taken, NULL);
}

void kinds_drop(macro_solver *s, size_t cell, double density)
{
    const size_t n = s->kinds->n;

    for (size_t k = 0; k < n; k++)
        s->kinds->fallen[cell * n + k] += density * s->kinds->fractions[cell * n + k];
}

// The sum over columns and rows of densities, NULL: 1, times what is of a kind.
static double sum_of(const macro_solver *s, const double *of_kinds, bool is_fraction, size_t kind,
                     const size_t columns[2], const size_t rows[2])
{
    const size_t n1 = (size_t)s->n1, n = s->kinds->n;
    double sum = 0.0;

    for (size_t j = rows[0]; j < rows[1]; j++) {
        const double *rho = macro_row(s, j), *of = of_kinds + j * n1 * n + kind;
        for (size_t i = columns[0]; i < columns[1]; i++)
            sum += (is_fraction ? rho[i] : 1.0) * of[i * n];
    }
    return sum * s->def.grid.d1 * s->def.grid.d2;
}

double macro_kind_mass_in(const macro_solver *s, size_t kind, size_t i_min, size_t i_max,
                          size_t j_min, size_t j_max)
{
    return sum_of(s, s->kinds->fractions, true, kind, (size_t[]){ i_min, i_max },
                  (size_t[]){ j_min, j_max });
}

double macro_kind_fallen_in(const macro_solver *s, size_t kind, size_t i_min, size_t i_max,
                            size_t j_min, size_t j_max)
{
    return s->kinds->fallen == NULL
               ? 0.0
               : sum_of(s, s->kinds->fallen, false, kind, (size_t[]){ i_min, i_max },
                        (size_t[]){ j_min, j_max });
}

// ---- a step

// What crosses a face towards rising x, times dt/dx: densities.
typedef struct face_flux {
    double carried; // F_stat'
    double pushed;  // G'
} face_flux;

// A cell and its faces.
typedef struct cell_faces {
    const double *rho; // of the row with which the step began; element 0 is this cell
    face_flux west, east, south, north;
} cell_faces;

// F_stat and G of a face, of velocity v between the densities before and behind it.
static face_flux part_flux(const macro_solver *s, double v, double before, double behind, float g)
{
    const double carried = s->lambda1 * v * (v >= 0.0 ? before : behind);
    const double pushed = s->lambda1 * (double)g, sum = carried + pushed;

    if ((carried > 0.0) == (pushed > 0.0))
        return (face_flux){ carried, pushed };
    return fabs(carried) > fabs(pushed) ? (face_flux){ sum, 0.0 } : (face_flux){ 0.0, sum };
}

static cell_faces faces_of(const macro_solver *s, ptrdiff_t i, ptrdiff_t j)
{
    const congested *c = s->congested;
    const double *rho = macro__row(s, s->next.rho, j) + i;
    const double *v1 = macro__row(s, s->faces1.v, j) + i, *v2 = macro__row(s, s->faces2.v, j) + i;
    const double south = j > 0 ? rho[-s->stride] : 0.0,
                 north = j + 1 < s->n2 ? rho[s->stride] : 0.0;

    return (cell_faces){
        .rho = rho,
        .west =
            part_flux(s, v1[-1], i > 0 ? rho[-1] : 0.0, rho[0], *CONGESTED_FACE1(c, flux, i, j)),
        .east = part_flux(s, v1[0], rho[0], i + 1 < s->n1 ? rho[1] : 0.0,
                          *CONGESTED_FACE1(c, flux, i + 1, j)),
        .south = part_flux(s, v2[0], south, rho[0], *CONGESTED_FACE2(c, flux, i, j)),
        .north = part_flux(s, v2[s->stride], rho[0], north, *CONGESTED_FACE2(c, flux, i, j + 1))
    };
}

// Columns of a row in which a step may have moved cargo: first <= i < last.
static void find_columns(const macro_solver *s, ptrdiff_t j, ptrdiff_t ret_columns[2])
{
    const block_span span = block_span_hull(s->now.span[j], s->next.span[j]);

    ret_columns[0] = span.first * BLOCK_CELLS;
    ret_columns[1] = span.last < s->n_blocks ? span.last * BLOCK_CELLS : s->n1;
}

static inline double positive(double x)
{
    return x > 0.0 ? x : 0.0;
}

// By what the slopes of the cells of a row are scaled, and the densities after F_stat'.
static void prepare_row(const macro_solver *s, ptrdiff_t j)
{
    kinds *k = s->kinds;
    ptrdiff_t columns[2];

    find_columns(s, j, columns);
    for (ptrdiff_t i = columns[0]; i < columns[1]; i++) {
        const cell_faces f = faces_of(s, i, j);
        const double rho = f.rho[0];
        const double out[4] = { positive(-f.west.carried), positive(f.east.carried),
                                positive(-f.south.carried), positive(f.north.carried) };
        double leaving = 0.0, weight = 0.0;
        for (int side = 0; side < 4; side++) {
            leaving += out[side];
            weight += out[side] * (1.0 - out[side] / (rho > 0.0 ? rho : 1.0));
        }
        const double staying = rho - leaving;
        k->density[j * s->n1 + i] =
            rho - (f.east.carried - f.west.carried) - (f.north.carried - f.south.carried);
        k->slope[j * s->n1 + i] = staying >= weight ? 1.0 : positive(staying) / weight;
    }
}

// The limiter superbee of the differences before and behind a cell, by their sum.
static double superbee(double before, double behind)
{
    if (!(before * behind > 0.0))
        return 0.0;
    const double a = fabs(before), b = fabs(behind);
    return fmax(fmin(2.0 * a, b), fmin(a, 2.0 * b)) / (a + b);
}

// Adds to masses what of each kind a face takes out of the cell `from`, times `sign`. The flux goes `along` 1 or -1 cells
// on in an axis, and v are the velocities of that axis's faces of the cell, before and behind.
static void add_sloped(const macro_solver *s, ptrdiff_t i, ptrdiff_t j, int axis, ptrdiff_t along,
                       double flux, double sign, double *masses)
{
    const kinds *k = s->kinds;
    const ptrdiff_t at = axis == 0 ? i : j, end = axis == 0 ? s->n1 : s->n2;
    const ptrdiff_t step = axis == 0 ? 1 : s->n1, cell = j * s->n1 + i;
    const ptrdiff_t row_step = axis == 0 ? 1 : s->stride;
    const double *rho = macro__row(s, s->next.rho, j) + i;
    const double *v =
        (axis == 0 ? macro__row(s, s->faces1.v, j) - 1 : macro__row(s, s->faces2.v, j)) + i;
    const double *here = k->fractions + cell * (ptrdiff_t)k->n;
    double theta = 0.0;

    if (at > 0 && at + 1 < end && rho[-row_step] > 0.0 && rho[row_step] > 0.0 &&
        v[0] * v[row_step] > 0.0) {
        const double *before = here - step * (ptrdiff_t)k->n,
                     *behind = here + step * (ptrdiff_t)k->n;
        theta = 1.0;
        for (size_t m = 0; m < k->n && theta > 0.0; m++)
            if (before[m] != here[m] || behind[m] != here[m])
                theta = fmin(theta, superbee(here[m] - before[m], behind[m] - here[m]));
        const double scale = 0.5 * (1.0 - flux / rho[0]) * theta * k->slope[cell] * (double)along;
        for (size_t m = 0; m < k->n; m++)
            masses[m] += sign * flux * (here[m] + scale * (behind[m] - before[m]));
        return;
    }
    for (size_t m = 0; m < k->n; m++)
        masses[m] += sign * flux * here[m];
}

// Carries the fractions of a row by F_stat'.
static void carry_row(const macro_solver *s, ptrdiff_t j)
{
    const kinds *k = s->kinds;
    ptrdiff_t columns[2];

    find_columns(s, j, columns);
    for (ptrdiff_t i = columns[0]; i < columns[1]; i++) {
        const cell_faces f = faces_of(s, i, j);
        const double rho = f.rho[0];
        const size_t cell = (size_t)(j * s->n1 + i);
        const double *here = k->fractions + cell * k->n;
        double masses[SCENE_KINDS_MAX];
        for (size_t m = 0; m < k->n; m++)
            masses[m] = rho * here[m];
        // Over each face: the flux out of this cell, which may be negative.
        const double out[4] = { -f.west.carried, f.east.carried, -f.south.carried,
                                f.north.carried };
        for (int side = 0; side < 4; side++) {
            const int axis = side >> 1;
            const ptrdiff_t along = (side & 1) != 0 ? 1 : -1;
            if (out[side] > 0.0)
                add_sloped(s, i, j, axis, along, out[side], -1.0, masses);
            else if (out[side] < 0.0)
                add_sloped(s, i + (axis == 0 ? along : 0), j + (axis == 1 ? along : 0), axis,
                           -along, -out[side], 1.0, masses);
        }
        if (!set_fractions(k->n, masses, k->carried + cell * k->n))
            memcpy(k->carried + cell * k->n, here, k->n * sizeof *here);
    }
}

// Carries the fractions of a row by G'.
static void correct_row(const macro_solver *s, ptrdiff_t j)
{
    const kinds *k = s->kinds;
    const ptrdiff_t steps[4] = { -1, 1, -s->n1, s->n1 };
    ptrdiff_t columns[2];

    find_columns(s, j, columns);
    for (ptrdiff_t i = columns[0]; i < columns[1]; i++) {
        const cell_faces f = faces_of(s, i, j);
        const ptrdiff_t cell = j * s->n1 + i;
        const double *here = k->carried + cell * (ptrdiff_t)k->n;
        const double out[4] = { -f.west.pushed, f.east.pushed, -f.south.pushed, f.north.pushed };
        double masses[SCENE_KINDS_MAX];
        for (size_t m = 0; m < k->n; m++)
            masses[m] = k->density[cell] * here[m];
        for (int side = 0; side < 4; side++) {
            if (out[side] == 0.0)
                continue;
            const ptrdiff_t there = cell + steps[side];
            // Over the border of the grid nothing comes in.
            const bool is_border = side < 2 ? i + steps[side] < 0 || i + steps[side] >= s->n1
                                            : there < 0 || there >= s->n1 * s->n2;
            const double *from =
                out[side] > 0.0 || is_border ? here : k->carried + there * (ptrdiff_t)k->n;
            for (size_t m = 0; m < k->n; m++)
                masses[m] -= out[side] * from[m];
        }
        if (!set_fractions(k->n, masses, k->fractions + cell * (ptrdiff_t)k->n))
            memcpy(k->fractions + cell * (ptrdiff_t)k->n, here, k->n * sizeof *here);
    }
}

static void follow_member(void *context, int member, int n_members, team_barrier *barrier)
{
    macro_solver *s = context;
    const ptrdiff_t first = s->n2 * member / n_members, last = s->n2 * (member + 1) / n_members;
    const uint64_t arithmetic = subnormals_flush();

    for (ptrdiff_t j = first; j < last; j++)
        prepare_row(s, j);
    team_barrier_wait(barrier);
    for (ptrdiff_t j = first; j < last; j++)
        carry_row(s, j);
    team_barrier_wait(barrier);
    for (ptrdiff_t j = first; j < last; j++)
        correct_row(s, j);
    subnormals_restore(arithmetic);
}

void kinds_follow(macro_solver *s)
{
    team_run(s->def.n_threads, follow_member, s);
}

void kinds_save(const macro_solver *s, checkpoint_writer *w)
{
    const size_t n = grid_cells(&s->def.grid) * s->kinds->n;

    checkpoint_write(w, s->kinds->fractions, n * sizeof *s->kinds->fractions);
    if (s->kinds->fallen != NULL)
        checkpoint_write(w, s->kinds->fallen, n * sizeof *s->kinds->fallen);
}

bool kinds_load(macro_solver *s, checkpoint_reader *r)
{
    const size_t n = grid_cells(&s->def.grid) * s->kinds->n;

    return checkpoint_read(r, s->kinds->fractions, n * sizeof *s->kinds->fractions) &&
           (s->kinds->fallen == NULL ||
            checkpoint_read(r, s->kinds->fallen, n * sizeof *s->kinds->fallen));
}
