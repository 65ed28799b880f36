#include "core/advice/prediction_load.h"

#include "core/run/run.h"

#include <math.h>

/// The cells of the coarse run, m: the finest with which the whole run is followed within its budget, from COARSER times the scenario's
/// to CELL_MAX. Where even those are too much work the run is followed for a part.
#define CELL_MAX 0.06
#define COARSER  1.4

/// The budget in cell-steps: this part of what the scenario itself takes, within these limits; and what a step costs besides its
/// cells, and the cells that there may be.
#define WORK_PART 0.05
#define WORK_MIN  1e6
#define WORK_MAX  3e6
#define STEP_WORK 300.0
#define CELLS_MAX 1e5

/// Densities from which on a cell counts as covered, and as saturated.
#define COVERED   0.01
#define SATURATED 0.7

enum {
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
    double relaxed, fields; // since the start
    double tracers;
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
    moment m = { .t = f->t,
                 .parts = f->mass,
                 .relaxed = now.relaxed,
                 .fields = now.n_fields,
                 .tracers = now.n_tracers };

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
static scene coarse_of(const scene *s, double *ret_step_work, double *ret_work_max)
{
    const double area = (s->domain.x_max - s->domain.x_min) * (s->domain.y_max - s->domain.y_min);
    const double edge = scene_cell_edge(s);
    scene coarse = *s;

    coarse.macro.closure = SCENE_CONGESTED;
    coarse.macro.step = 0.0;
    const double work_max =
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

// finer: the edge of the run's cells by that of the scenario's.
static prediction_load sum_up(const trace *of, const scene *s, double finer, bool is_whole)
{
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
    load.relaxed = finer * finer * finer * (end->relaxed + times * (end->relaxed - begin->relaxed));
    load.fields = finer * (end->fields + times * (end->fields - begin->fields));
    return load;
}

bf_status prediction_load_of(const scene *s, prediction_load *ret_load, bf_error *err)
{
    double step_work, work_max;
    const scene coarse = coarse_of(s, &step_work, &work_max);
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
        *ret_load = sum_up(&t, s, scene_cell_edge(&coarse) / scene_cell_edge(s),
                           (double)t.step * step_work <= work_max);
    return status;
}
