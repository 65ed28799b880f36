#include "core/macro/macro.h"

#include "core/base/memory.h"
#include "core/base/team.h"
#include "core/macro/congested.h"
#include "core/macro/kinds.h"
#include "core/macro/macro_priv.h"
#include "core/macro/muscl.h"
#include "core/macro/tracers.h"
#include "core/scene/belt_range.h"

#include <math.h>
#include <string.h>

enum { ALIGNMENT = 64 }; // of rows and sets, bytes: as by memory_alloc()

static const double cfl_slack = 1e-9; // tolerance for steps that are equal to the bound in decimal

#define X(suffix)                                                                                  \
    macro_sweep_fn macro__sweep_roe_wide_##suffix, macro__sweep_roe_narrow_##suffix,               \
        macro__sweep_muscl_wide_##suffix, macro__sweep_muscl_narrow_##suffix;
CPU_EACH_BUILD(X)
#undef X

macro_sweep_fn *macro__sweep_of(scene_scheme scheme, cpu_level level, bool is_narrow)
{
    // One row a scheme: its sweep for every level, for wide and for narrow grids.
    static macro_sweep_fn *const builds[SCENE_SCHEME_COUNT][CPU_AVX512 + 1][2] = {
#define X(suffix) { macro__sweep_roe_wide_##suffix, macro__sweep_roe_narrow_##suffix },
        [SCENE_SCHEME_ROE] = { CPU_EACH_BUILD(X) },
#undef X
#define X(suffix) { macro__sweep_muscl_wide_##suffix, macro__sweep_muscl_narrow_##suffix },
        [SCENE_SCHEME_MUSCL] = { CPU_EACH_BUILD(X) },
#undef X
    };

    return builds[scheme][level][is_narrow];
}

macro_def macro_def_default(void)
{
    return (macro_def){
        .grid = { .n1 = 200, .n2 = 120, .d1 = 5e-3, .d2 = 5e-3 },
        .dt = 1.25e-3,
        .closure = SCENE_DISPERSIVE,
        .jam_density = 0.93,
        .slip_rate = 10.0,
        .friction = 1.0,
        .dispersion = 0.79,
        .mollifier = 10000.0,
        .heaviside = SCENE_HEAVISIDE_SHARP,
        .heaviside_width = 0.05,
        .n_threads = 1,
    };
}

// The largest factors of the belts at any time, and that off every belt, which is 1.
typedef struct largest_factors {
    size_t n_belts;
    double of[SCENE_BELTS_MAX + 1];
    double of_all;
} largest_factors;

static largest_factors find_largest_factors(const macro_def *def)
{
    largest_factors f = { .n_belts = def->n_belts, .of_all = 1.0 };

    for (size_t k = 0; k < def->n_belts; k++) {
        f.of[k] = belt_range_largest(&def->belts[k]);
        f.of_all = fmax(f.of_all, f.of[k]);
    }
    f.of[def->n_belts] = 1.0;
    return f;
}

// The velocity at face k when its belt is at its fastest.
static double face_velocity(const double *v, const uint16_t *belt, const largest_factors *f,
                            size_t k)
{
    return v == NULL ? 0.0 : v[k] * (f->n_belts > 0 && belt != NULL ? f->of[belt[k]] : 1.0);
}

// How fast cargo goes out over face k at most, by both its velocities; sign 1: toward rising x.
static double face_outflow(const macro_def *def, int axis, const largest_factors *f, size_t k,
                           double sign)
{
    const velocity_field_faces *faces = &def->faces[axis];
    const double slide = sign * face_velocity(faces->v, faces->belt, f, k);

    return faces->loose == NULL
               ? slide
               : fmax(slide, sign * face_velocity(faces->loose, faces->belt, f, k));
}

// The largest rate, 1/s, at which a cell is emptied by the scheme of the congested closure.
static double largest_outflow(const macro_def *def, const largest_factors *f)
{
    const bf_grid *g = &def->grid;
    const bool is_muscl = def->scheme == SCENE_SCHEME_MUSCL;
    double largest = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            const size_t west = j * (g->n1 + 1) + i, south = j * g->n1 + i;
            const size_t before[2] = { west, south }, after[2] = { west + 1, south + g->n1 };
            double rate = 0.0;
            for (int axis = 0; axis < 2; axis++) {
                const double out_before = face_outflow(def, axis, f, before[axis], -1.0);
                const double out_after = face_outflow(def, axis, f, after[axis], 1.0);
                const double in_before = face_outflow(def, axis, f, before[axis], 1.0);
                const double in_after = face_outflow(def, axis, f, after[axis], -1.0);
                // By muscl each side of a cell has a state of its own.
                rate +=
                    (is_muscl ? 2.0 * fmax(fmax(out_before, in_before), fmax(out_after, in_after))
                              : fmax(out_before, 0.0) + fmax(out_after, 0.0)) /
                    (axis == 0 ? g->d1 : g->d2);
            }
            largest = fmax(largest, rate);
        }
    return largest;
}

// See macro.h. In sweeps along one axis after the other a cell loses to one axis at a time, else to both at once.
static double stable_step(const macro_def *def)
{
    const bf_grid *g = &def->grid;
    const largest_factors f = find_largest_factors(def);
    double rate[2];

    if (def->closure == SCENE_CONGESTED)
        return 1.0 / largest_outflow(def, &f);
    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *faces = &def->faces[axis];
        double largest = 0.0;
        for (size_t k = 0; k < grid_faces(g, axis); k++)
            largest = fmax(largest, fabs(face_velocity(faces->v, faces->belt, &f, k)));
        rate[axis] = (def->dispersion * f.of_all + largest) / (axis == 0 ? g->d1 : g->d2);
    }
    return 1.0 / (def->scheme == SCENE_SCHEME_MUSCL ? rate[0] + rate[1] : fmax(rate[0], rate[1]));
}

static ptrdiff_t round_up(ptrdiff_t n)
{
    return (n + BLOCK_CELLS - 1) / BLOCK_CELLS * BLOCK_CELLS;
}

static void lay_out(macro_solver *s, const macro_def *def)
{
    s->def = *def;
    memset(s->def.faces, 0, sizeof s->def.faces);
    s->def.belts = NULL;
    if (def->world != NULL && !def->world->belts.are_constant)
        s->speeds = &def->world->belts;
    mollifier_init(&s->along, def->mollifier, def->grid.d1);
    mollifier_init(&s->across, def->mollifier, def->grid.d2);
    s->lambda1 = def->dt / def->grid.d1;
    s->lambda2 = def->dt / def->grid.d2;
    s->n1 = (ptrdiff_t)def->grid.n1;
    s->n2 = (ptrdiff_t)def->grid.n2;
    s->n_blocks = round_up(s->n1) / BLOCK_CELLS;
    s->n_words = block_set_words(s->n_blocks);
    s->sweep = macro__sweep_of(def->scheme, cpu_best(), s->n_words == 1);
    s->n_stages = def->scheme == SCENE_SCHEME_MUSCL ? MUSCL_STAGES : 1;
    // Block -1 is convolved too, and so is the whole last block.
    s->margin = BLOCK_CELLS + round_up(s->along.reach);
    s->stride = s->margin + s->n_blocks * BLOCK_CELLS + round_up(s->along.reach + 1);
    s->n_ring = 1;
    while (s->n_ring < 2 * s->across.reach + 2)
        s->n_ring *= 2;
    s->n_bands = def->n_threads < s->n2 ? def->n_threads : (int)s->n2;
}

// Memory that arrays are taken from; without bytes they are only counted.
typedef struct arena {
    char *bytes;
    size_t used;
} arena;

static void *take(arena *a, size_t n, size_t size)
{
    void *array = a->bytes != NULL ? a->bytes + a->used : NULL;

    a->used += (n * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    return array;
}

static double *take_row(arena *a, const macro_solver *s)
{
    double *row = take(a, (size_t)s->stride, sizeof *row);

    return row != NULL ? row + s->margin : NULL;
}

static uint64_t *take_set(arena *a, const macro_solver *s)
{
    return take(a, s->n_words, sizeof(uint64_t));
}

static void lay_out_band(const macro_solver *s, macro_band *band, arena *a)
{
    uint64_t **const sets[] = { &band->ahead,   &band->active_faces, &band->wanted,
                                &band->missing, &band->unexpected,   &band->todo,
                                &band->special, &band->empty };

    const size_t n = (size_t)s->n_ring;
    band->ring = take(a, n, sizeof *band->ring);
    band->gradient_ring = take(a, 2 * n, sizeof *band->gradient_ring);
    band->integral_ring = take(a, 2 * n, sizeof *band->integral_ring);
    band->gradient_rows = take(a, n, sizeof *band->gradient_rows);
    band->integral_rows = take(a, n, sizeof *band->integral_rows);
    for (size_t k = 0; k < n; k++) {
        const macro_ring_row row = { take_row(a, s), take_row(a, s), take_set(a, s) };
        if (a->bytes == NULL)
            continue;
        band->ring[k] = row;
        band->gradient_ring[k] = band->gradient_ring[k + n] = row.gradient1;
        band->integral_ring[k] = band->integral_ring[k + n] = row.integral1;
    }
    band->expected = take(a, (size_t)s->n2 * s->n_words, sizeof *band->expected);
    band->near = take(a, (size_t)(s->n2 + 4 * s->across.reach) * s->n_words, sizeof *band->near);
    for (int k = 0; k < 2; k++) {
        band->dispersion[k] = (macro_dispersion_row){ .i1 = take_row(a, s),
                                                      .i2 = take_row(a, s),
                                                      .done = take_set(a, s) };
        band->states2[k] = (macro_face_states){ take_row(a, s), take_row(a, s) };
        band->outside[k] = take_row(a, s);
        band->outside_active[k] = take_set(a, s);
        band->outside_first[k] = take_set(a, s);
        band->flux2[k] = take_row(a, s);
        band->flux2_set[k] = take_set(a, s);
    }
    band->states1 = (macro_face_states){ take_row(a, s), take_row(a, s) };
    band->flux1 = take_row(a, s);
    for (size_t k = 0; k < sizeof sets / sizeof *sets; k++)
        *sets[k] = take_set(a, s);
}

static bf_status band_init(const macro_solver *s, macro_band *band)
{
    arena counted = { NULL, 0 };

    band->solver = s;
    lay_out_band(s, band, &counted);
    band->bytes = memory_alloc(counted.used, 1);
    lay_out_band(s, band, &(arena){ band->bytes, 0 });
    return band->bytes != NULL ? BF_OK : BF_ENOMEM;
}

static bf_status init_state(const macro_solver *s, macro_state *state)
{
    state->rho = memory_alloc((size_t)(s->n2 * s->stride), sizeof *state->rho);
    state->span = memory_alloc((size_t)s->n2, sizeof *state->span);
    state->active = memory_alloc((size_t)s->n2 * s->n_words, sizeof *state->active);
    state->active_first = memory_alloc((size_t)s->n2 * s->n_words, sizeof *state->active_first);
    return state->rho != NULL && state->span != NULL && state->active != NULL &&
                   state->active_first != NULL
               ? BF_OK
               : BF_ENOMEM;
}

static bf_status init_arrays(macro_solver *s, const macro_def *def)
{
    const size_t n_cells = grid_cells(&def->grid);

    s->zero_row = memory_alloc((size_t)s->stride, sizeof *s->zero_row);
    s->cost = memory_alloc((size_t)s->n2, sizeof *s->cost);
    s->bands = memory_alloc((size_t)s->n_bands, sizeof *s->bands);
    s->factors = memory_alloc(def->n_belts + 1, sizeof *s->factors);
    s->factors_next = memory_alloc(def->n_belts + 1, sizeof *s->factors_next);
    if (s->zero_row == NULL || s->cost == NULL || s->bands == NULL || s->factors == NULL ||
        s->factors_next == NULL || init_state(s, &s->now) != BF_OK ||
        init_state(s, &s->next) != BF_OK || macro__faces_init(s, def) != BF_OK)
        return BF_ENOMEM;
    for (size_t k = 0; k <= def->n_belts; k++)
        s->factors[k] = 1.0;
    if (def->off != NULL) {
        s->off = memory_alloc(n_cells, sizeof *s->off);
        s->fallen = memory_alloc(n_cells, sizeof *s->fallen);
        if (s->off == NULL || s->fallen == NULL)
            return BF_ENOMEM;
        memcpy(s->off, def->off, n_cells);
    }
    if ((def->tracer_portion > 0.0 && tracers_create(s, &s->tracers) != BF_OK) ||
        (def->n_kinds > 0 && kinds_create(s, def->n_kinds, &s->kinds) != BF_OK))
        return BF_ENOMEM;
    if (def->closure == SCENE_CONGESTED)
        return congested_create(s, def, &s->congested);
    for (int k = 0; k < s->n_bands; k++)
        if (band_init(s, &s->bands[k]) != BF_OK)
            return BF_ENOMEM;
    return BF_OK;
}

bf_status macro_create(const macro_def *def, macro_solver **ret_solver, bf_error *err)
{
    const double stable = stable_step(def);

    if (!(def->dt <= stable * (1.0 + cfl_slack)))
        return bf_fail(err, BF_EINPUT, "/macro/step_s",
                       "a step of %.9g s is unstable; the largest stable one (CFL) is %.9g s",
                       def->dt, stable);
    macro_solver *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a solver");
    lay_out(s, def);
    if (init_arrays(s, def) != BF_OK) {
        macro_destroy(s);
        return bf_fail(err, BF_ENOMEM, "/macro/cell_m", "no memory for a grid of %zu x %zu cells",
                       def->grid.n1, def->grid.n2);
    }
    *ret_solver = s;
    return BF_OK;
}

static void fini_state(macro_state *state)
{
    memory_free(state->rho);
    memory_free(state->span);
    memory_free(state->active);
    memory_free(state->active_first);
}

macro_solver *macro_destroy(macro_solver *s)
{
    if (s == NULL)
        return NULL;
    for (int k = 0; s->bands != NULL && k < s->n_bands; k++)
        memory_free(s->bands[k].bytes);
    memory_free(s->bands);
    congested_destroy(s->congested);
    tracers_destroy(s->tracers);
    kinds_destroy(s->kinds);
    macro__faces_fini(s);
    fini_state(&s->now);
    fini_state(&s->next);
    memory_free(s->factors);
    memory_free(s->factors_next);
    memory_free(s->off);
    memory_free(s->fallen);
    memory_free(s->cost);
    memory_free(s->zero_row);
    memory_free(s);
    return NULL;
}

static void sweep_band(void *context, size_t k)
{
    macro_solver *s = context;

    s->sweep(&s->bands[k]);
}

static void swap_states(macro_solver *s)
{
    const macro_state before = s->now;

    s->now = s->next;
    s->next = before;
}

// Lets fall what is in cells off every belt.
static void drop_row(macro_solver *s, ptrdiff_t j)
{
    double *row = macro__row(s, s->now.rho, j), *fallen = s->fallen + j * s->n1;
    const uint8_t *off = s->off + j * s->n1;
    const block_span span = s->now.span[j];
    const ptrdiff_t first = span.first > 0 ? span.first * BLOCK_CELLS : 0;
    const ptrdiff_t end = span.last < s->n_blocks ? span.last * BLOCK_CELLS : s->n1;

    for (ptrdiff_t i = first; i < end; i++) {
        if (off[i] == 0)
            continue;
        if (s->kinds != NULL)
            kinds_drop(s, (size_t)(j * s->n1 + i), row[i]);
        fallen[i] += row[i];
        row[i] = 0.0;
    }
    macro__fill_margins(s, row);
}

void macro_step(macro_solver *s)
{
    const bool has_changed = macro__faces_update(s);

    if (s->congested != NULL) {
        if (has_changed)
            congested_update(s);
        congested_step(s);
        swap_states(s);
        if (s->kinds != NULL)
            kinds_follow(s);
    } else {
        for (s->stage = 0; s->stage < s->n_stages; s->stage++) {
            s->records = s->tracers != NULL && s->stage == 0;
            // Divides the rows into bands of about equal work.
            double total = 0.0, reached = 0.0;
            ptrdiff_t row = 0;
            for (ptrdiff_t j = 0; j < s->n2; j++)
                total += s->cost[j];
            for (int k = 0; k < s->n_bands; k++) {
                ptrdiff_t rows_left_for_others = s->n_bands - 1 - k;
                s->bands[k].first = row;
                do
                    reached += s->cost[row++];
                while (row < s->n2 - rows_left_for_others &&
                       reached < total * (k + 1) / s->n_bands);
                s->bands[k].last = row;
            }
            s->bands[s->n_bands - 1].last = s->n2;
            team_for(s->n_bands, (size_t)s->n_bands, sweep_band, s);
            swap_states(s);
        }
    }
    for (ptrdiff_t j = 0; s->off != NULL && j < s->n2; j++)
        drop_row(s, j);
    s->steps++;
    if (s->tracers != NULL)
        tracers_follow(s);
}
