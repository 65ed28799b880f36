#include "core/macro/kinds.h"

#include "core/base/memory.h"
#include "core/base/subnormals.h"
#include "core/base/team.h"
#include "core/macro/kinds_priv.h"

#include <math.h>
#include <string.h>

#define X(suffix) extern const kinds_kernels kinds__kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

static kinds_kernels kernels_of(cpu_level level)
{
    static const kinds_kernels *const builds[CPU_AVX512 + 1] = {
#define X(suffix) &kinds__kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };
    return *builds[level];
}

// Lays out the rows. The first ones have a block before their margin, as the faces before the first block have cells before them.
static bf_status init_rows(const macro_solver *s, kinds *k)
{
    const ptrdiff_t n = (ptrdiff_t)k->n, faces = k->plane + s->stride;
    const ptrdiff_t of_thread = (3 + 2 * n) * s->stride;
    const int n_threads = s->def.n_threads;

    k->storage = memory_alloc(
        (size_t)(BLOCK_CELLS + (2 * n + 4) * k->plane + 4 * faces + n_threads * of_thread),
        sizeof *k->storage);
    k->rows = memory_alloc((size_t)n_threads, sizeof *k->rows);
    for (int axis = 0; axis < 2; axis++) {
        k->flows[axis] = memory_alloc((size_t)s->n2 + 1, sizeof *k->flows[axis]);
        k->corrects[axis] = memory_alloc((size_t)s->n2 + 1, sizeof *k->corrects[axis]);
    }
    if (k->storage == NULL || k->rows == NULL || k->flows[0] == NULL || k->flows[1] == NULL ||
        k->corrects[0] == NULL || k->corrects[1] == NULL)
        return BF_ENOMEM;
    k->before = k->storage + BLOCK_CELLS;
    k->carried = k->before + n * k->plane;
    k->density = k->carried + n * k->plane;
    k->inverse = k->density + k->plane;
    double *next = k->inverse + k->plane;
    for (int axis = 0; axis < 2; axis++) {
        k->slope[axis] = next;
        k->flux[axis] = next + k->plane;
        k->correction[axis] = next + k->plane + faces;
        next += k->plane + 2 * faces;
    }
    for (int member = 0; member < n_threads; member++, next += of_thread) {
        double *row = next + s->margin;
        k->rows[member] = (kinds_rows){ row,
                                        row + s->stride,
                                        row + 2 * s->stride,
                                        { row + 3 * s->stride, row + (3 + n) * s->stride } };
    }
    return BF_OK;
}

bf_status kinds_create(const macro_solver *s, size_t n, kinds **ret_kinds)
{
    const size_t n_cells = grid_cells(&s->def.grid);
    kinds *k = memory_alloc(1, sizeof *k);

    if (k == NULL)
        return BF_ENOMEM;
    *k = (kinds){ .n = n,
                  .plane = s->n2 * s->stride,
                  .kernels = kernels_of(cpu_best()),
                  .fractions = memory_alloc(n_cells * n, sizeof *k->fractions),
                  .fallen = s->off != NULL ? memory_alloc(n_cells * n, sizeof *k->fallen) : NULL };
    if (k->fractions == NULL || (s->off != NULL && k->fallen == NULL) || init_rows(s, k) != BF_OK) {
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
    memory_free(k->fallen);
    memory_free(k->storage);
    memory_free(k->rows);
    for (int axis = 0; axis < 2; axis++) {
        memory_free(k->flows[axis]);
        memory_free(k->corrects[axis]);
    }
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
    const double here = macro_density(s, cell);
    double *of = s->kinds->fractions + cell * n, masses[SCENE_KINDS_MAX];

    for (size_t k = 0; k < n; k++)
        masses[k] = here * of[k] + density * fractions[k];
    (void)set_fractions(n, masses, of);
}

void macro_take_kind(macro_solver *s, size_t cell, size_t kind, double density)
{
    const size_t n = s->kinds->n;
    const double here = macro_density(s, cell);
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

static void follow_member(void *context, int member, int n_members, team_barrier *barrier)
{
    macro_solver *s = context;
    const kinds *k = s->kinds;
    kinds_rows *rows = &k->rows[member];
    const ptrdiff_t first = s->n2 * member / n_members, last = s->n2 * (member + 1) / n_members;
    const uint64_t arithmetic = subnormals_flush();

    for (ptrdiff_t j = first; j < last + (last == s->n2); j++)
        k->kernels.split(s, j);
    team_barrier_wait(barrier);
    for (ptrdiff_t j = first; j < last; j++)
        k->kernels.prepare(s, j);
    team_barrier_wait(barrier);
    if (first < last)
        k->kernels.begin(s, first, rows);
    for (ptrdiff_t j = first; j < last; j++)
        k->kernels.carry(s, j, rows);
    team_barrier_wait(barrier);
    for (ptrdiff_t j = first; j < last; j++)
        k->kernels.correct(s, j, rows);
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
