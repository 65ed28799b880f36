#include "core/run/macro_sinks.h"

#include "core/base/memory.h"
#include "core/run/sink_cells.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double whole_part = 1.0;

// What is saved of a sink.
typedef struct sink_state {
    double credit; // that it may take now
    double taken;  // since t = 0
} sink_state;

// A cell of a sink.
typedef struct sink_cell {
    size_t cell;
    uint32_t kinds; // that the sink takes there, a bit each: those that no later sink does
} sink_cell;

struct macro_sinks {
    const scene *scene;
    macro_solver *solver;
    macro_flows *flows;
    bf_grid grid;
    double parts; // in a cell at density 1
    sink_state states[SCENE_SINKS_MAX];
    size_t n_cells[SCENE_SINKS_MAX];
    sink_cell *cells[SCENE_SINKS_MAX]; // of each sink
    double *kept;                      // of each cell, the fraction of what was in it that stayed
};

_Static_assert((int)SCENE_KINDS_MAX <= 32, "each kind has a bit");

static bool stop(void *context, size_t j, size_t first, size_t last)
{
    bool *has_cells = context;

    (void)j;
    (void)first;
    (void)last;
    *has_cells = true;
    return false;
}

void macro_sinks_check(const scene *s, bf_faults *faults)
{
    const double steps = s->n_sinks > 0 ? sink_cells_steps(s) : 0.0;
    sink_cells cells;
    char pointer[BF_POINTER_SIZE];

    if (steps > SCENE_CHECK_STEPS_MAX) {
        faults_add_limit(faults, "/sinks",
                         "%.3g corners of sinks times rows of cells, and cells along obstacles, "
                         "the limit is %.3g",
                         steps, SCENE_CHECK_STEPS_MAX);
        return;
    }
    if (s->n_sinks == 0 || sink_cells_init(s, &cells) != BF_OK)
        return;
    for (size_t k = 0; k < s->n_sinks; k++) {
        bool has_cells = false;
        snprintf(pointer, sizeof pointer, "/sinks/%zu/polygon_m", k);
        if (sink_cells_visit(&cells, &s->sinks[k], stop, &has_cells) == BF_OK && !has_cells)
            faults_add(faults, pointer,
                       "lies between the centres of cells of %.3g m: a density would pass it",
                       scene_cell_edge(s));
    }
    sink_cells_fini(&cells);
}

static uint32_t kinds_of(const scene *s, size_t sink)
{
    uint32_t kinds = 0;

    for (size_t k = 0; k < s->n_cargo; k++)
        kinds |= (uint32_t)sink_takes(&s->sinks[sink], k) << k;
    return kinds;
}

// The search for the cells of a sink; those of later ones were found.
typedef struct finding {
    macro_sinks *of;
    size_t sink;
    uint32_t kinds;    // that the sink takes
    uint32_t *claimed; // of each cell: kinds that later sinks take there
    size_t n, n_max;   // cells found, and for which there is room
    bf_status status;  // BF_ENOMEM: some are missing
} finding;

static bool add_cells(void *context, size_t j, size_t first, size_t last)
{
    finding *f = context;
    sink_cell **cells = &f->of->cells[f->sink];

    if (memory_reserve(cells, &f->n_max, f->n + last - first, sizeof **cells) != 0) {
        f->status = BF_ENOMEM;
        return false;
    }
    for (size_t i = first; i < last; i++) {
        const size_t cell = j * f->of->grid.n1 + i;
        const uint32_t kinds = f->kinds & ~f->claimed[cell];
        f->claimed[cell] |= f->kinds;
        if (kinds != 0)
            (*cells)[f->n++] = (sink_cell){ cell, kinds };
    }
    return true;
}

// Finds the cells of all sinks. BF_ENOMEM: some are missing.
static bf_status find_cells(macro_sinks *m)
{
    const size_t n = grid_cells(&m->grid);
    uint32_t *claimed = memory_alloc(n, sizeof *claimed);
    sink_cells cells;
    bf_status status = sink_cells_init(m->scene, &cells);

    if (claimed == NULL)
        status = BF_ENOMEM;
    for (size_t k = m->scene->n_sinks; k-- > 0 && status == BF_OK;) {
        finding f = { .of = m, .sink = k, .kinds = kinds_of(m->scene, k), .claimed = claimed };
        status = sink_cells_visit(&cells, &m->scene->sinks[k], add_cells, &f);
        if (status == BF_OK)
            status = f.status;
        m->n_cells[k] = f.n;
    }
    sink_cells_fini(&cells);
    memory_free(claimed);
    m->kept = memory_alloc(n, sizeof *m->kept);
    if (m->kept == NULL)
        status = BF_ENOMEM;
    for (size_t cell = 0; cell < n && status == BF_OK; cell++)
        m->kept[cell] = 1.0;
    return status;
}

bf_status macro_sinks_create(const scene *s, macro_solver *solver, macro_flows *flows,
                             macro_sinks **ret_sinks, bf_error *err)
{
    const bf_grid grid = scene_grid(s);
    macro_sinks *m = memory_alloc(1, sizeof *m);

    if (m != NULL)
        *m = (macro_sinks){ .scene = s,
                            .solver = solver,
                            .flows = flows,
                            .grid = grid,
                            .parts = scene_packing_density(s) * grid.d1 * grid.d2 };
    if (m == NULL || find_cells(m) != BF_OK) {
        macro_sinks_destroy(m);
        return bf_fail(err, BF_ENOMEM, "", "no memory for the cells of sinks");
    }
    for (size_t k = 0; k < s->n_sinks; k++)
        m->states[k].credit = whole_part;
    *ret_sinks = m;
    return BF_OK;
}

macro_sinks *macro_sinks_destroy(macro_sinks *m)
{
    if (m == NULL)
        return NULL;
    for (size_t k = 0; k < SCENE_SINKS_MAX; k++)
        memory_free(m->cells[k]);
    memory_free(m->kept);
    memory_free(m);
    return NULL;
}

// The fraction of what is in a cell that a sink may take.
static double eligible(const macro_sinks *m, const sink_cell *at)
{
    const double *fractions = macro_fractions(m->solver, at->cell);
    double fraction = 0.0;

    if (fractions == NULL)
        return 1.0;
    for (size_t k = 0; k < m->scene->n_cargo; k++)
        fraction += (at->kinds >> k & 1U) != 0 ? fractions[k] : 0.0;
    return fmin(fraction, 1.0);
}

// Takes a fraction of what a sink may take out of a cell. Returns the density that it took.
static double take_from(macro_sinks *m, const sink_cell *at, double fraction)
{
    const double *fractions = macro_fractions(m->solver, at->cell);
    const double of_all = fraction * eligible(m, at), density = macro_density(m->solver, at->cell);
    double of_kinds[SCENE_KINDS_MAX];

    m->kept[at->cell] *= 1.0 - of_all;
    if (fractions == NULL || of_all >= 1.0) {
        macro_add(m->solver, at->cell, -of_all * density, NULL);
        return of_all * density;
    }
    memcpy(of_kinds, fractions, m->scene->n_cargo * sizeof *of_kinds);
    for (size_t k = 0; k < m->scene->n_cargo; k++)
        if ((at->kinds >> k & 1U) != 0)
            macro_take_kind(m->solver, at->cell, k, fraction * of_kinds[k] * density);
    return density - macro_density(m->solver, at->cell);
}

void macro_sinks_take(macro_sinks *m)
{
    const double dt = macro_steps(m->solver) > 0 ? scene_macro_step(m->scene) : 0.0;

    for (size_t sink = 0; sink < m->scene->n_sinks; sink++) {
        const double rate = m->scene->sinks[sink].rate;
        sink_state *state = &m->states[sink];
        double inside = 0.0, fraction = 1.0;
        for (size_t k = 0; k < m->n_cells[sink]; k++) {
            const sink_cell *at = &m->cells[sink][k];
            inside += m->parts * macro_density(m->solver, at->cell) * eligible(m, at);
        }
        if (rate != INFINITY) {
            state->credit = fmin(state->credit + rate * dt, fmax(whole_part, rate * dt));
            fraction = inside > state->credit ? state->credit / inside : 1.0;
            state->credit = fmax(state->credit - inside, 0.0);
        }
        for (size_t k = 0; k < m->n_cells[sink]; k++) {
            const sink_cell *at = &m->cells[sink][k];
            const double *fractions = macro_fractions(m->solver, at->cell);
            const double of_all = eligible(m, at);
            double of_taken[SCENE_KINDS_MAX] = { 0.0 };
            for (size_t i = 0; fractions != NULL && of_all > 0.0 && i < m->scene->n_cargo; i++)
                of_taken[i] = (at->kinds >> i & 1U) != 0 ? fractions[i] / of_all : 0.0;
            const double taken = m->parts * take_from(m, at, fraction);
            state->taken += taken;
            if (m->flows != NULL)
                macro_flows_take(m->flows, at->cell, taken, fractions != NULL ? of_taken : NULL);
        }
    }
    macro_let_leave(m->solver, m->kept);
    for (size_t sink = 0; sink < m->scene->n_sinks; sink++)
        for (size_t k = 0; k < m->n_cells[sink]; k++)
            m->kept[m->cells[sink][k].cell] = 1.0;
}

void macro_sinks_taken(const macro_sinks *m, double *ret_parts)
{
    for (size_t k = 0; k < m->scene->n_sinks; k++)
        ret_parts[k] = m->states[k].taken;
}

void macro_sinks_save(const macro_sinks *m, checkpoint_writer *w)
{
    checkpoint_write(w, m->states, m->scene->n_sinks * sizeof *m->states);
}

bool macro_sinks_load(macro_sinks *m, checkpoint_reader *r)
{
    return checkpoint_read(r, m->states, m->scene->n_sinks * sizeof *m->states);
}
