#include "core/advice/prediction_load.h"

#include "core/run/run.h"

#include <math.h>

/// The cells of the coarse run, m: the finest with which the whole run is followed within its budget, from COARSER times the scenario's
/// to CELL_MAX. Where even those are too much work the run is followed for a part.
#define CELL_MAX 0.06
#define COARSER  1.4

/// The budget in cell-steps: this part of what the scenario itself takes, within these limits, and so many times that with the
/// closure `dispersive`, whose cells cost less; and what a step costs besides its cells, and the cells that there may be.
#define WORK_PART        0.05
#define WORK_MIN         1e6
#define WORK_MAX         3e6
#define DISPERSIVE_TIMES 6.0
#define STEP_WORK        300.0
#define CELLS_MAX        1e5

/// The width of the strip along a plate in which velocities vary, m, as runs have it on cells of any size.
#define STRIP 0.05

/// Densities from which on a cell counts as covered, and as saturated.
#define COVERED   0.01
#define SATURATED 0.7

enum {
    BLOCK = 8,      ///< cells of a row that sweeps take at once (core/macro/active_blocks.h)
    MOMENTS = 48,   ///< at which the density is looked at
    QUESTIONS = 50, ///< of the run, for each of which it reports how far it is
};

/// What is present at one time.
typedef struct moment {
    double t;
    double parts;
    double saturated;
    double pairs;
    double area;
    double saturated_area;
    double tracers;
    run_work work; // since the start
} moment;

/// The moments of a run so far, and the work that they took.
typedef struct trace {
    const run *run;
    moment moments[MOMENTS + 4];
    size_t n;
    double cell_area; // m2
    double packing;   // parts/m2
    double step_work, work_max;
    uint64_t step;
    unsigned n_asked;
    double t; // of the end
} trace;

static void take_density(trace *to, const frame_snapshot *f)
{
    const double area = to->cell_area;
    const run_work now = run_work_of(to->run);
    moment m = { .t = f->t, .parts = f->mass, .tracers = now.n_tracers, .work = now };

    for (size_t k = 0; k < (size_t)f->n1 * f->n2; k++) {
        const double rho = (double)f->rho[k];
        m.area += rho >= COVERED ? area : 0.0;
        m.saturated_area += rho >= SATURATED ? area : 0.0;
        m.saturated += rho >= SATURATED ? rho * area * to->packing : 0.0;
        m.pairs += rho * rho * area * to->packing;
    }
    if (to->n < sizeof to->moments / sizeof *to->moments)
        to->moments[to->n++] = m;
}

static bf_status on_frame(void *context, const frame *f, bf_error *err)
{
    trace *to = context;

    (void)err;
    if (f->type == FRAME_SNAPSHOT)
        take_density(to, &f->snapshot);
    if (f->type == FRAME_PROGRESS)
        to->step = f->progress.step;
    if (f->type == FRAME_END)
        to->t = f->end.t;
    return BF_OK;
}

// A report costs as much as some steps.
static unsigned find_requested(void *context)
{
    trace *so_far = context;

    if ((double)so_far->step * so_far->step_work > so_far->work_max)
        return RUN_STOP;
    return so_far->n_asked++ % QUESTIONS == 0 ? RUN_REPORT : RUN_GO_ON;
}

// Cells, and STEP_WORK, times steps of a scenario.
static double work_of(const scene *s, double *ret_step_work)
{
    const bf_grid grid = scene_grid(s);

    *ret_step_work = (double)grid_cells(&grid) + STEP_WORK;
    return *ret_step_work * s->duration / scene_step_stable(s);
}

/// The same scenario on coarse cells. It borrows all arrays.
static scene coarse_of(const scene *s, run_model model, double *ret_step_work, double *ret_work_max)
{
    const double area = (s->domain.x_max - s->domain.x_min) * (s->domain.y_max - s->domain.y_min);
    const double edge = scene_cell_edge(s);
    scene coarse = *s;

    if (model == RUN_MICRO)
        coarse.macro.closure = SCENE_CONGESTED;
    coarse.macro.step = 0.0;
    const double work_max =
        (coarse.macro.closure == SCENE_DISPERSIVE ? DISPERSIVE_TIMES : 1.0) *
        fmin(fmax(WORK_MIN, WORK_PART * work_of(&coarse, ret_step_work)), WORK_MAX);
    coarse.macro.cell = fmax(fmin(COARSER * edge, fmax(CELL_MAX, edge)), sqrt(area / CELLS_MAX));
    double work = work_of(&coarse, ret_step_work);
    while (work > work_max && coarse.macro.cell < CELL_MAX) {
        coarse.macro.cell = fmin(CELL_MAX, 1.1 * coarse.macro.cell);
        work = work_of(&coarse, ret_step_work);
    }
    const double every = s->duration * fmin(1.0, work_max / work) / MOMENTS;
    coarse.output = (scene_output){ .curve_every = every, .snapshot_every = every };
    *ret_work_max = work_max;
    return coarse;
}

static void add(prediction_load *to, const moment *m, double time)
{
    to->parts += m->parts * time;
    to->saturated += m->saturated * time;
    to->pairs += m->pairs * time;
    to->area += m->area * time;
    to->saturated_area += m->saturated_area * time;
    to->tracers += m->tracers * time;
}

// What grew from one value to another in some time, and grows on as fast for so many times that time.
static double at_end(double begin, double end, double times)
{
    return end + times * (end - begin);
}

// Varied cells lie in strips along plates and edges, in whole blocks that are wider the coarser the cells are. What is left of
// them on cells that are finer by so much, where jams do not take them anyway.
static void narrow_strips(const scene *s, double finer, prediction_load *load)
{
    const double block = BLOCK * scene_cell_edge(s), width = s->n_obstacles > 0 ? STRIP : 0.0;
    const double strips = fmax(load->varied - load->dispersed, 0.0);

    if (strips > 0.0) {
        const double part = strips / load->swept,
                     narrower = (width + block) / (width + finer * block);
        load->varied -= strips * (1.0 - part) * (1.0 - narrower);
    }
}

static prediction_load sum_up(const trace *of, const scene *s, const scene *coarse, bool is_whole)
{
    // The edge of the run's cells by that of the scenario's, and its step by the scenario's.
    const double finer = scene_cell_edge(coarse) / scene_cell_edge(s);
    const double cells = finer * finer * scene_macro_step(coarse) / scene_macro_step(s);
    prediction_load load = { .time = is_whole ? of->t : s->duration };

    for (size_t k = 0; k + 1 < of->n; k++) {
        const double half = 0.5 * (of->moments[k + 1].t - of->moments[k].t);
        add(&load, &of->moments[k], half);
        add(&load, &of->moments[k + 1], half);
    }
    const size_t first = of->n - of->n / 3;
    const double rest = load.time - of->moments[of->n - 1].t;
    for (size_t k = first; k < of->n && rest > 0.0; k++)
        add(&load, &of->moments[k], rest / (double)(of->n - first));
    const moment *begin = &of->moments[first], *end = &of->moments[of->n - 1];
    const double times = end->t > begin->t ? fmax(rest, 0.0) / (end->t - begin->t) : 0.0;
    const run_work *from = &begin->work, *to = &end->work;
    load.relaxed = finer * finer * finer * at_end(from->relaxed, to->relaxed, times);
    load.swept = cells * at_end(from->swept, to->swept, times);
    load.varied = cells * at_end(from->varied, to->varied, times);
    load.dispersed = cells * at_end(from->dispersed, to->dispersed, times);
    narrow_strips(s, finer, &load);
    load.fields = finer * at_end(from->n_fields, to->n_fields, times);
    return load;
}

bf_status prediction_load_of(const scene *s, run_model model, prediction_load *ret_load,
                             bf_error *err)
{
    double step_work, work_max;
    const scene coarse = coarse_of(s, model, &step_work, &work_max);
    const bf_grid grid = scene_grid(&coarse);
    trace t = { .cell_area = grid.d1 * grid.d2,
                .packing = scene_packing_density(s),
                .step_work = step_work,
                .work_max = work_max };
    const run_sink sink = { &t, on_frame, find_requested };
    run *r = NULL;

    bf_status status = run_create(&coarse, RUN_MACRO, 1, &r, err);
    t.run = r;
    if (status == BF_OK)
        status = run_execute(r, &sink, err);
    run_destroy(r);
    if (status == BF_OK)
        *ret_load = sum_up(&t, s, &coarse, (double)t.step * step_work <= work_max);
    return status;
}
