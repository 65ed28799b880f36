#include "core/run/macro_sinks.h"

#include "core/base/memory.h"
#include "core/scene/sink.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double whole_part = 1.0;

// What is saved of a sink.
typedef struct sink_state {
    double credit; // that it may take now
    double taken;  // since t = 0
} sink_state;

struct macro_sinks {
    const scene *scene;
    macro_solver *solver;
    macro_flows *flows;
    bf_grid grid;
    double parts;     // in a cell at density 1
    uint8_t *sink_in; // of each cell: its sink, or MACRO_NO_SINK
    size_t n_cells;   // of all sinks
    size_t *cells;    // rising
    sink_state states[SCENE_SINKS_MAX];
};

_Static_assert((int)SCENE_SINKS_MAX < (int)MACRO_NO_SINK, "a byte names a sink");

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
    const bf_grid g = scene_grid(s);
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < s->n_sinks; k++) {
        bool has_cells = false, takes_all = true;
        for (size_t kind = 0; kind < s->n_cargo; kind++)
            takes_all = takes_all && sink_takes(&s->sinks[k], kind);
        snprintf(pointer, sizeof pointer, "/sinks/%zu/kinds", k);
        if (!takes_all)
            faults_add(faults, pointer,
                       "a density has no kinds of which some could be taken: solve it with the "
                       "microscopic model");
        snprintf(pointer, sizeof pointer, "/sinks/%zu/polygon_m", k);
        if (sink_visit_cells(&s->sinks[k], &g, stop, &has_cells) == BF_OK && !has_cells)
            faults_add(faults, pointer,
                       "lies between the centres of cells of %.3g m: a density would pass it",
                       scene_cell_edge(s));
    }
}

// Cells that are given to a sink; those of the sinks before it as well, if it is over them.
typedef struct giving {
    macro_sinks *to;
    uint8_t sink;
} giving;

static bool give_cells(void *context, size_t j, size_t first, size_t last)
{
    const giving *g = context;

    memset(g->to->sink_in + j * g->to->grid.n1 + first, g->sink, last - first);
    return true;
}

// Finds the cells of all sinks. BF_ENOMEM: some are missing.
static bf_status find_cells(macro_sinks *m)
{
    const scene *s = m->scene;
    const size_t n = grid_cells(&m->grid);
    size_t n_cells = 0;

    m->sink_in = memory_alloc(n, sizeof *m->sink_in);
    if (m->sink_in == NULL)
        return BF_ENOMEM;
    memset(m->sink_in, MACRO_NO_SINK, n);
    for (size_t k = 0; k < s->n_sinks; k++) {
        giving g = { m, (uint8_t)k };
        if (sink_visit_cells(&s->sinks[k], &m->grid, give_cells, &g) != BF_OK)
            return BF_ENOMEM;
    }
    for (size_t cell = 0; cell < n; cell++)
        n_cells += m->sink_in[cell] != MACRO_NO_SINK ? 1 : 0;
    m->cells = memory_alloc(n_cells + 1, sizeof *m->cells);
    for (size_t cell = 0; m->cells != NULL && cell < n; cell++)
        if (m->sink_in[cell] != MACRO_NO_SINK)
            m->cells[m->n_cells++] = cell;
    return m->cells != NULL ? BF_OK : BF_ENOMEM;
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
    memory_free(m->sink_in);
    memory_free(m->cells);
    memory_free(m);
    return NULL;
}

static double density_of(const macro_sinks *m, size_t cell)
{
    return macro_row(m->solver, cell / m->grid.n1)[cell % m->grid.n1];
}

void macro_sinks_take(macro_sinks *m)
{
    double inside[SCENE_SINKS_MAX] = { 0 }, shares[SCENE_SINKS_MAX];
    const double dt = macro_steps(m->solver) > 0 ? scene_macro_step(m->scene) : 0.0;

    for (size_t k = 0; k < m->n_cells; k++)
        inside[m->sink_in[m->cells[k]]] += m->parts * density_of(m, m->cells[k]);
    for (size_t k = 0; k < m->scene->n_sinks; k++) {
        const double rate = m->scene->sinks[k].rate;
        double *credit = &m->states[k].credit;
        shares[k] = 1.0;
        if (rate == INFINITY)
            continue;
        *credit = fmin(*credit + rate * dt, whole_part);
        if (inside[k] > *credit)
            shares[k] = *credit / inside[k];
        *credit -= fmin(inside[k], *credit);
    }
    for (size_t k = 0; k < m->n_cells; k++) {
        const size_t cell = m->cells[k], sink = m->sink_in[cell];
        const double taken = shares[sink] * density_of(m, cell);
        macro_add(m->solver, cell, -taken);
        m->states[sink].taken += m->parts * taken;
        if (m->flows != NULL)
            macro_flows_take(m->flows, cell, m->parts * taken);
    }
    macro_let_leave(m->solver, m->sink_in, shares);
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
