#include "core/run/macro_flows.h"

#include "core/base/memory.h"
#include "core/observe/figure.h"

#include <math.h>

// Of a counter; since the last sample but for content, fallen and left.
typedef struct counter_flow {
    double content; // at the last sample
    double fallen;  // until the last sample
    double added;   // by feeds
    double taken;   // by sinks
    double out;
    double in;
    double left; // since t = 0
} counter_flow;

typedef struct outlet_flow {
    double out;  // since the last sample
    double left; // since t = 0
} outlet_flow;

struct macro_flows {
    const scene *scene;
    const macro_solver *solver;
    const uint16_t *belt_of;
    bf_grid grid;
    double packing; // parts/m2 at density 1
    double dt;      // of a step, s
    size_t n_outlets;
    double left; // the domain until the last sample
    counter_cells cells[SCENE_COUNTERS_MAX];
    counter_flow counters[SCENE_COUNTERS_MAX];
    outlet_flow outlets[SCENE_BELTS_MAX];
    size_t outlet_of[SCENE_BELTS_MAX + 1];
};

bf_status macro_flows_create(const scene *s, const macro_solver *solver, const uint16_t *belt_of,
                             macro_flows **ret_flows, bf_error *err)
{
    macro_flows *f = memory_alloc(1, sizeof *f);

    if (f == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for what leaves counters");
    f->scene = s;
    f->solver = solver;
    f->belt_of = belt_of;
    f->grid = scene_grid(s);
    f->packing = scene_packing_density(s);
    f->dt = scene_macro_step(s);
    f->n_outlets = figure_items(s, FIGURE_OF_OUTLET);
    for (size_t k = 0; k <= s->n_sections; k++)
        f->outlet_of[k] = figure_outlet(s, k);
    for (size_t k = 0; k < s->n_counters; k++) {
        f->cells[k] = counter_cells_of(&s->counters[k], &f->grid);
        f->counters[k].content =
            f->packing * macro_flows_mass_in(solver, s->counters[k].kind, &f->cells[k]);
    }
    *ret_flows = f;
    return BF_OK;
}

double macro_flows_mass_in(const macro_solver *solver, uint32_t kind, const counter_cells *c)
{
    return kind == SCENE_KIND_ANY
               ? macro_mass_in(solver, c->i_min, c->i_max, c->j_min, c->j_max)
               : macro_kind_mass_in(solver, kind, c->i_min, c->i_max, c->j_min, c->j_max);
}

double macro_flows_fallen_in(const macro_solver *solver, uint32_t kind, const counter_cells *c)
{
    return kind == SCENE_KIND_ANY
               ? macro_fallen_in(solver, c->i_min, c->i_max, c->j_min, c->j_max)
               : macro_kind_fallen_in(solver, kind, c->i_min, c->i_max, c->j_min, c->j_max);
}

macro_flows *macro_flows_destroy(macro_flows *f)
{
    memory_free(f);
    return NULL;
}

// What leaves a cell over a side in the steps that a flux stands for.
static double over(const macro_flows *f, size_t i, size_t j, scene_side side)
{
    const double edge = side == SCENE_WEST || side == SCENE_EAST ? f->grid.d2 : f->grid.d1;
    const double dt = (double)macro_flux_steps(f->solver) * f->dt;

    return macro_flux(f->solver, i, j, side) * edge * dt * f->packing;
}

// The fraction of a kind in what goes over a side of a cell, out of it or into it.
static double fraction_over(const macro_flows *f, uint32_t kind, size_t i, size_t j,
                            scene_side side, bool is_out)
{
    const size_t n1 = f->grid.n1, n2 = f->grid.n2, cell = j * n1 + i;
    const bool is_border = (side == SCENE_WEST && i == 0) || (side == SCENE_EAST && i + 1 == n1) ||
                           (side == SCENE_SOUTH && j == 0) || (side == SCENE_NORTH && j + 1 == n2);
    const size_t there = side == SCENE_WEST    ? cell - 1
                         : side == SCENE_EAST  ? cell + 1
                         : side == SCENE_SOUTH ? cell - n1
                                               : cell + n1;

    if (kind == SCENE_KIND_ANY)
        return 1.0;
    return macro_fractions(f->solver, is_out || is_border ? cell : there)[kind];
}

static void add_border(macro_flows *f, size_t counter, size_t i, size_t j, scene_side side)
{
    counter_flow *c = &f->counters[counter];
    const double all = over(f, i, j, side);
    const double out =
        all * fraction_over(f, f->scene->counters[counter].kind, i, j, side, all > 0.0);

    c->out += fmax(out, 0.0);
    c->in += fmax(-out, 0.0);
}

static void add_to_outlet(macro_flows *f, size_t i, size_t j, scene_side side)
{
    const size_t outlet = f->outlet_of[f->belt_of[j * f->grid.n1 + i]];

    if (outlet < f->n_outlets)
        f->outlets[outlet].out += fmax(over(f, i, j, side), 0.0);
}

void macro_flows_follow(macro_flows *f)
{
    if (macro_steps(f->solver) % macro_flux_steps(f->solver) != 0)
        return;
    for (size_t k = 0; k < f->scene->n_counters; k++) {
        const counter_cells *cells = &f->cells[k];
        if (cells->i_min >= cells->i_max || cells->j_min >= cells->j_max)
            continue;
        for (size_t j = cells->j_min; j < cells->j_max; j++) {
            add_border(f, k, cells->i_min, j, SCENE_WEST);
            add_border(f, k, cells->i_max - 1, j, SCENE_EAST);
        }
        for (size_t i = cells->i_min; i < cells->i_max; i++) {
            add_border(f, k, i, cells->j_min, SCENE_SOUTH);
            add_border(f, k, i, cells->j_max - 1, SCENE_NORTH);
        }
    }
    if (f->n_outlets > 0) {
        const scene_edge *edges = f->scene->edges;
        for (size_t j = 0; j < f->grid.n2; j++) {
            if (edges[SCENE_WEST] == SCENE_EDGE_OUTFLOW)
                add_to_outlet(f, 0, j, SCENE_WEST);
            if (edges[SCENE_EAST] == SCENE_EDGE_OUTFLOW)
                add_to_outlet(f, f->grid.n1 - 1, j, SCENE_EAST);
        }
        for (size_t i = 0; i < f->grid.n1; i++) {
            if (edges[SCENE_SOUTH] == SCENE_EDGE_OUTFLOW)
                add_to_outlet(f, i, 0, SCENE_SOUTH);
            if (edges[SCENE_NORTH] == SCENE_EDGE_OUTFLOW)
                add_to_outlet(f, i, f->grid.n2 - 1, SCENE_NORTH);
        }
    }
}

// What of parts with these fractions of the kinds a counter counts in a cell; NULL: kinds are not told apart.
static double counted(const macro_flows *f, size_t counter, size_t cell, double parts,
                      const double *fractions)
{
    const uint32_t kind = f->scene->counters[counter].kind;
    const counter_cells *c = &f->cells[counter];
    const size_t i = cell % f->grid.n1, j = cell / f->grid.n1;

    if (i < c->i_min || i >= c->i_max || j < c->j_min || j >= c->j_max)
        return 0.0;
    return kind == SCENE_KIND_ANY || fractions == NULL ? parts : parts * fractions[kind];
}

void macro_flows_add(macro_flows *f, size_t cell, double parts, const double *fractions)
{
    for (size_t k = 0; k < f->scene->n_counters; k++)
        f->counters[k].added += counted(f, k, cell, parts, fractions);
}

void macro_flows_take(macro_flows *f, size_t cell, double parts, const double *fractions)
{
    for (size_t k = 0; k < f->scene->n_counters; k++)
        f->counters[k].taken += counted(f, k, cell, parts, fractions);
}

void macro_flows_settle(macro_flows *f, const double *contents, double left, double *ret_flows)
{
    const size_t n_counters = f->scene->n_counters;
    double all = 0.0;

    for (size_t k = 0; k < n_counters; k++) {
        counter_flow *c = &f->counters[k];
        const counter_cells *in = &f->cells[k];
        const double fallen =
            f->packing * macro_flows_fallen_in(f->solver, f->scene->counters[k].kind, in);
        const double net = c->content + c->added - c->taken - (fallen - c->fallen) - contents[k];
        const double settled = c->out + c->in, of_out = settled > 0.0 ? c->out / settled : 1.0;
        c->left += fmax(c->out + of_out * (net - (c->out - c->in)), 0.0) + c->taken;
        c->content = contents[k];
        c->fallen = fallen;
        c->added = c->taken = c->out = c->in = 0.0;
        ret_flows[k] = f->counters[k].left;
    }
    for (size_t k = 0; k < f->n_outlets; k++)
        all += f->outlets[k].out;
    for (size_t k = 0; k < f->n_outlets; k++) {
        outlet_flow *o = &f->outlets[k];
        if (all > 0.0) {
            o->left += o->out / all * (left - f->left);
            o->out = 0.0;
        }
        ret_flows[n_counters + k] = o->left;
    }
    // Where nothing crossed the borders in a step that was looked at, the next sample has it.
    f->left = all > 0.0 ? left : f->left;
}

void macro_flows_save(const macro_flows *f, checkpoint_writer *w)
{
    checkpoint_write(w, &f->left, sizeof f->left);
    checkpoint_write(w, f->counters, f->scene->n_counters * sizeof *f->counters);
    checkpoint_write(w, f->outlets, f->n_outlets * sizeof *f->outlets);
}

bool macro_flows_load(macro_flows *f, checkpoint_reader *r)
{
    return checkpoint_read(r, &f->left, sizeof f->left) &&
           checkpoint_read(r, f->counters, f->scene->n_counters * sizeof *f->counters) &&
           checkpoint_read(r, f->outlets, f->n_outlets * sizeof *f->outlets);
}
