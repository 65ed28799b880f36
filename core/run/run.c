#include "core/run/run.h"

#include "core/base/check.h"
#include "core/base/checkpoint.h"
#include "core/base/digest.h"
#include "core/base/memory.h"
#include "core/observe/columns.h"
#include "core/observe/figures.h"
#include "core/run/control.h"
#include "core/run/run_priv.h"
#include "core/run/schedule.h"
#include "core/scene/definition.h"

#include <math.h>
#include <string.h>

enum { BATCH = 256 }; // samples that wait for a frame

// Results of a kind.
typedef struct series {
    schedule_of of; // when they are taken
    uint64_t step;  // at which the next one is due
    uint64_t n;     // how many were taken
} series;

// The header of the solver's state in a checkpoint.
typedef struct saved_header {
    uint64_t step;
    uint64_t n_samples, n_snapshots;
    double parts_start;
    double peak;
} saved_header;

struct run {
    const scene *scene;
    run_model model;
    uint64_t definition; // digest of scenario and model, to which checkpoints belong
    const run_backend *backend;
    bf_world world;
    void *solver;
    run_plan plan;
    uint64_t step, first_step;
    series samples, snapshots;
    control control;
    figures *figures;
    double *figure_values;                  // of FRAME_FIGURES
    feed_balance balances[SCENE_FEEDS_MAX]; // at the last sample
    frame_end_reason reason;
    double parts_start, peak;
    uint32_t n_columns;
    uint32_t n_waiting; // samples in the arrays below
    double t[BATCH];
    double *values;                // BATCH rows of n_columns
    double *flows;                 // at the last sample, of each counter and outlet; with feeds
    double taken[SCENE_SINKS_MAX]; // at the last sample, by each sink
    float *rho;
    double *parts;      // rows of FRAME_PARTS
    size_t n_parts_max; // numbers that they have room for
    bf_buffer checkpoint;
};

const char *const run_model_words[] = { "macro", "micro", NULL };

static const double rounding_of_parts = 1e-10; // of sums of densities, relative

static const run_backend *const backends[RUN_MODEL_COUNT] = {
    [RUN_MACRO] = &run__macro, [RUN_MICRO] = &run__micro
};

run_work run_work_of(const run *r)
{
    const run_load load = r->backend->measure(r->solver);

    return (run_work){ .relaxed = load.relaxed,
                       .n_fields = load.n_fields,
                       .n_tracers = load.n_tracers,
                       .swept = load.swept,
                       .varied = load.varied,
                       .dispersed = load.dispersed };
}

double run_left(double came, double inside, double fallen)
{
    const double left = came - inside - fallen;

    return fallen > 0.0 && left < rounding_of_parts * came ? 0.0 : left;
}

bool run_model_is_available(run_model model)
{
    return model < RUN_MODEL_COUNT && backends[model] != NULL;
}

void run_check(const scene *s, run_model model, bf_faults *faults)
{
    columns_check(s, faults);
    backends[model]->check_scenario(s, faults);
}

uint64_t run_definition(const scene *s, run_model model)
{
    return digest_add(definition_digest(s), &model, sizeof model);
}

static int reserve_parts(run *r, uint64_t n_rows)
{
    return memory_reserve(&r->parts, &r->n_parts_max, n_rows * r->plan.n_values, sizeof *r->parts);
}

bf_status run_create(const scene *s, run_model model, int n_threads, run **ret_run, bf_error *err)
{
    if (!run_model_is_available(model))
        return bf_fail(err, BF_EINPUT, "/model", "this build has no solver for that model");
    run *r = memory_alloc(1, sizeof *r);
    if (r == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a run");
    r->scene = s;
    r->model = model;
    r->definition = run_definition(s, model);
    r->backend = backends[model];
    r->n_columns = (uint32_t)columns_count(s);
    r->samples.of = SCHEDULE_CURVE;
    r->snapshots.of = SCHEDULE_SNAPSHOT;
    bf_status status = world_init(&r->world, s, err);
    if (status == BF_OK)
        status = r->backend->create(s, &r->world, n_threads, &r->solver, &r->plan, err);
    if (status == BF_OK) {
        r->control = control_of(s, &r->world, r->backend, &r->plan);
        r->parts_start = r->backend->measure(r->solver).parts;
        r->rho = memory_alloc(grid_cells(&r->plan.grid), sizeof *r->rho);
        r->values = memory_alloc(BATCH * (size_t)r->n_columns, sizeof *r->values);
        r->figure_values = memory_alloc(figure_values(s), sizeof *r->figure_values);
        r->flows =
            memory_alloc(s->n_counters + figure_items(s, FIGURE_OF_OUTLET), sizeof *r->flows);
        if (r->rho == NULL || r->values == NULL || r->figure_values == NULL || r->flows == NULL ||
            reserve_parts(r, r->plan.n_parts) != 0)
            status = bf_fail(err, BF_ENOMEM, "", "no memory for a snapshot");
    }
    if (status == BF_OK)
        status = figures_create(s, r->backend->parts != NULL, &r->figures, err);
    if (status != BF_OK) {
        run_destroy(r);
        return status;
    }
    *ret_run = r;
    return BF_OK;
}

run *run_destroy(run *r)
{
    if (r == NULL)
        return NULL;
    if (r->solver != NULL)
        r->backend->destroy(r->solver);
    world_fini(&r->world);
    control_fini(&r->control);
    figures_destroy(r->figures);
    memory_free(r->figure_values);
    buffer_fini(&r->checkpoint);
    memory_free(r->values);
    memory_free(r->flows);
    memory_free(r->rho);
    memory_free(r->parts);
    memory_free(r);
    return NULL;
}

// Of n results up to the present step, when the next one is due.
static void move_on(const run *r, series *s, uint64_t n)
{
    s->n = n;
    s->step = schedule_next(&r->scene->output, s->of, r->step, r->plan.dt);
}

static bf_status load(run *r, const void *bytes, size_t n, bf_error *err)
{
    checkpoint_reader reader;
    saved_header h;

    bf_status status = checkpoint_open(&reader, bytes, n, CHECKPOINT_RUN, r->definition, err);
    if (status != BF_OK)
        return status;
    if (!checkpoint_read(&reader, &h, sizeof h) || h.step > r->plan.n_steps ||
        !world_load(&r->world, &reader))
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
    if ((status = control_load(&r->control, &reader, err)) != BF_OK)
        return status;
    if (!figures_load(r->figures, &reader))
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint's figures are damaged");
    r->step = r->first_step = h.step;
    r->parts_start = h.parts_start;
    r->peak = h.peak;
    move_on(r, &r->samples, h.n_samples);
    move_on(r, &r->snapshots, h.n_snapshots);
    return r->backend->load(r->solver, &reader, err);
}

bf_status run_resume(const scene *s, run_model model, int n_threads, const void *bytes, size_t n,
                     run **ret_run, bf_error *err)
{
    run *r = NULL;
    bf_status status = run_create(s, model, n_threads, &r, err);

    if (status == BF_OK && (status = load(r, bytes, n, err)) != BF_OK)
        r = run_destroy(r);
    if (status == BF_OK)
        *ret_run = r;
    return status;
}

static double time_now(const run *r)
{
    return (double)r->step * r->plan.dt;
}

static bf_status emit_begin(run *r, const run_sink *sink, bf_error *err)
{
    const frame f = { .type = FRAME_BEGIN,
                      .begin = { .model = (uint32_t)r->model,
                                 .n_columns = r->n_columns,
                                 .n_steps = r->plan.n_steps,
                                 .dt = r->plan.dt,
                                 .duration = (double)r->plan.n_steps * r->plan.dt,
                                 .n_parts = r->plan.n_parts,
                                 .first_step = r->first_step,
                                 .n_values = r->plan.n_values,
                                 .grid = r->plan.grid,
                                 .definition = r->definition } };

    return sink->on_frame(sink->context, &f, err);
}

static bf_status emit_curve(run *r, const run_sink *sink, bf_error *err)
{
    const frame f = { .type = FRAME_CURVE,
                      .curve = { .first = r->samples.n - r->n_waiting,
                                 .n = r->n_waiting,
                                 .n_columns = r->n_columns,
                                 .t = r->t,
                                 .values = r->values } };

    if (r->n_waiting == 0)
        return BF_OK;
    r->n_waiting = 0;
    return sink->on_frame(sink->context, &f, err);
}

static bf_status emit_progress(run *r, const run_sink *sink, bf_error *err)
{
    const frame f = { .type = FRAME_PROGRESS,
                      .progress = {
                          .step = r->step, .n_steps = r->plan.n_steps, .t = time_now(r) } };

    return sink->on_frame(sink->context, &f, err);
}

// Of models that say it apart from their cargo.
static void tell_ages(run *r)
{
    if (r->backend->tell_ages != NULL && r->scene->n_feeds > 0)
        r->backend->tell_ages(r->solver, r->figures);
}

static bf_status emit_figures(run *r, const run_sink *sink, bf_error *err)
{
    tell_ages(r);
    figures_fill(r->figures, r->figure_values);
    const frame f = { .type = FRAME_FIGURES,
                      .figures = { .t = figures_time(r->figures),
                                   .n = figure_values(r->scene),
                                   .values = r->figure_values } };

    return sink->on_frame(sink->context, &f, err);
}

static bf_status emit_checkpoint(run *r, const run_sink *sink, bf_error *err)
{
    const saved_header h = { .step = r->step,
                             .n_samples = r->samples.n,
                             .n_snapshots = r->snapshots.n,
                             .parts_start = r->parts_start,
                             .peak = r->peak };
    checkpoint_writer w;

    r->checkpoint.n = 0;
    checkpoint_begin(&w, &r->checkpoint, CHECKPOINT_RUN, r->definition);
    checkpoint_write(&w, &h, sizeof h);
    world_save(&r->world, &w);
    control_save(&r->control, &w);
    figures_save(r->figures, &w);
    bf_status status = r->backend->save(r->solver, &w, err);
    if (status == BF_OK)
        status = checkpoint_end(&w, err);
    if (status != BF_OK)
        return status;
    const frame f = { .type = FRAME_CHECKPOINT,
                      .bytes = {
                          .step = r->step, .n = r->checkpoint.n, .bytes = r->checkpoint.bytes } };
    return sink->on_frame(sink->context, &f, err);
}

static bf_status emit_end(run *r, bool is_stopped, const run_sink *sink, bf_error *err)
{
    const run_load load = r->backend->measure(r->solver);
    frame f = { .type = FRAME_END,
                .end = { .stopped = is_stopped,
                         .reason = r->reason,
                         .n_steps = r->step,
                         .t = time_now(r),
                         .n_cells = grid_cells(&r->plan.grid),
                         .parts_start = r->parts_start,
                         .parts_end = load.parts,
                         .parts_entered = load.entered,
                         .parts_fallen = load.fallen,
                         .peak = fmax(r->peak, load.peak),
                         .digest = r->backend->digest(r->solver),
                         .n_samples = r->samples.n,
                         .n_snapshots = r->snapshots.n } };

    if (r->backend->fill_end != NULL)
        r->backend->fill_end(r->solver, &f.end);
    return sink->on_frame(sink->context, &f, err);
}

// In the order of columns.h.
static void fill_columns(run *r, const run_load *load, double *values)
{
    const scene *s = r->scene;
    const double left = run_left(r->parts_start + load->entered, load->parts, load->fallen);

    r->backend->count(r->solver, values);
    double over_sides = left;
    if (s->n_sinks > 0)
        r->backend->taken(r->solver, r->taken);
    for (size_t k = 0; k < s->n_sinks; k++)
        over_sides -= r->taken[k];
    if (s->n_feeds > 0)
        r->backend->count_flows(r->solver, values, over_sides, r->flows);
    values += s->n_counters;
    *values++ = left;
    if (s->may_drop)
        *values++ = load->fallen;
    for (size_t k = 0; k < s->n_feeds; k++, values += COLUMNS_OF_FEED) {
        r->balances[k] = r->backend->balance(r->solver, k);
        columns_put_feed(&r->balances[k], values);
    }
    for (size_t k = 0; k < s->n_eyes; k++)
        *values++ = r->control.eyes.states[k].is_blocked;
    for (size_t k = 0; k < figure_items(s, FIGURE_OF_BELT); k++) {
        const size_t belt = figure_belt(s, FIGURE_OF_BELT, k);
        *values++ = vec2_length(s->belts[belt].velocity) *
                    belt_speeds_at(&r->world.belts, belt, time_now(r));
    }
    for (size_t k = 0; k < figure_items(s, FIGURE_OF_FAILURE); k++) {
        size_t failure = 0;
        double until;
        const size_t belt = figure_failure(s, k, &failure);
        *values++ =
            belt_speeds_stopped_by(&r->world.belts, belt, time_now(r), &until) >> failure & 1U;
    }
    for (size_t k = 0; k < figure_items(s, FIGURE_OF_OUTLET); k++)
        *values++ = r->flows[s->n_counters + k];
    for (size_t k = 0; k < s->n_sinks; k++)
        *values++ = r->taken[k];
}

// Takes a sample of the curve; a full batch is emitted.
static bf_status take_sample(run *r, const run_sink *sink, bf_error *err)
{
    double *values = &r->values[r->n_waiting * r->n_columns];
    bf_status status = r->backend->check == NULL ? BF_OK : r->backend->check(r->solver, err);

    if (status != BF_OK)
        return status;
    const run_load load = r->backend->measure(r->solver);
    r->peak = fmax(r->peak, load.peak);
    r->t[r->n_waiting++] = time_now(r);
    fill_columns(r, &load, values);
    const bool may_fall = r->scene->may_drop && r->scene->n_feeds == 0;
    const figures_now now = { .t = time_now(r),
                              .inside = load.parts,
                              .entered = r->parts_start + load.entered,
                              .exited = values[r->scene->n_counters],
                              .fallen = load.fallen,
                              .fallen_in_first =
                                  may_fall ? r->backend->fallen_in(r->solver, 0) : 0.0,
                              .counters = values,
                              .flows = r->flows,
                              .taken = r->taken,
                              .feeds = r->balances };
    if (r->backend->tell_cargo != NULL)
        r->backend->tell_cargo(r->solver, r->figures);
    if (figures_ends_warmup(r->figures, now.t))
        tell_ages(r);
    figures_sample(r->figures, &now);
    if (r->backend->parts == NULL)
        figures_peak(r->figures, load.smooth_peak);
    move_on(r, &r->samples, r->samples.n + 1);
    return r->n_waiting == BATCH ? emit_curve(r, sink, err) : BF_OK;
}

static bf_status emit_parts(run *r, uint64_t n_rows, const run_sink *sink, bf_error *err)
{
    if (r->backend->parts == NULL)
        return BF_OK;
    if (reserve_parts(r, n_rows) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the parts of a snapshot");
    r->backend->parts(r->solver, r->parts);
    const frame f = { .type = FRAME_PARTS,
                      .parts = { .index = r->snapshots.n,
                                 .t = time_now(r),
                                 .n_parts = n_rows,
                                 .n_values = r->plan.n_values,
                                 .rows = r->parts } };
    return sink->on_frame(sink->context, &f, err);
}

static bf_status take_snapshot(run *r, const run_sink *sink, bf_error *err)
{
    bf_status status = emit_curve(r, sink, err);
    run_load load = { 0 };

    if (status == BF_OK)
        status = r->backend->snapshot(r->solver, r->rho, &load, err);
    if (status != BF_OK)
        return status;
    r->peak = fmax(r->peak, load.peak);
    figures_peak(r->figures, load.smooth_peak);
    const frame f = { .type = FRAME_SNAPSHOT,
                      .snapshot = { .index = r->snapshots.n,
                                    .t = time_now(r),
                                    .peak = load.peak,
                                    .mass = load.parts,
                                    .n1 = (uint32_t)r->plan.grid.n1,
                                    .n2 = (uint32_t)r->plan.grid.n2,
                                    .rho = r->rho } };
    status = sink->on_frame(sink->context, &f, err);
    if (status == BF_OK)
        status = emit_parts(r, load.n_rows, sink, err);
    move_on(r, &r->snapshots, r->snapshots.n + 1);
    return status;
}

static bool is_over(const run *r)
{
    return r->step == r->plan.n_steps || r->reason != FRAME_END_DURATION;
}

// Takes what is due at the present step.
static bf_status take_results(run *r, const run_sink *sink, bf_error *err)
{
    const bool is_tick =
        r->control.n_tick > 0 && (r->step % r->control.n_tick == 0 || r->step >= r->plan.n_steps);
    bf_status status = BF_OK;

    figures_belts(r->figures, &r->world.belts, time_now(r));
    if (is_tick)
        status = control_tick(&r->control, r->solver, r->step, r->figures, sink, err);
    if (is_tick && status == BF_OK && control_is_drained(&r->control, r->solver))
        r->reason = FRAME_END_DRAINED;
    if (status == BF_OK && (r->step >= r->samples.step || is_over(r)))
        status = take_sample(r, sink, err);
    if (r->scene->until == SCENE_UNTIL_STEADY && figures_is_steady(r->figures))
        r->reason = FRAME_END_STEADY;
    if (status == BF_OK && (r->step >= r->snapshots.step || is_over(r)))
        status = take_snapshot(r, sink, err);
    return status;
}

// Serves the sink's requests.
static bf_status serve_request(run *r, unsigned request, const run_sink *sink, bf_error *err)
{
    bf_status status = emit_curve(r, sink, err);

    if (status == BF_OK)
        status = emit_progress(r, sink, err);
    if (status == BF_OK)
        status = emit_figures(r, sink, err);
    if (status == BF_OK && (request & RUN_CHECKPOINT) != 0)
        status = emit_checkpoint(r, sink, err);
    if (status == BF_OK && (request & RUN_STOP) != 0)
        status = emit_end(r, true, sink, err);
    return status;
}

bf_status run_execute(run *r, const run_sink *sink, bf_error *err)
{
    bf_status status = emit_begin(r, sink, err);

    if (status == BF_OK && r->samples.n == 0)
        status = take_results(r, sink, err);
    while (status == BF_OK && !is_over(r)) {
        const unsigned request =
            sink->requested == NULL ? RUN_GO_ON : sink->requested(sink->context);
        if (request != RUN_GO_ON) {
            status = serve_request(r, request, sink, err);
            if (status != BF_OK || (request & RUN_STOP) != 0)
                return status;
        }
        // Steps until the next result or tick is due, but not so many that a request waits for long.
        const uint64_t dues[] = { r->snapshots.step, control_next(&r->control, r->step),
                                  r->plan.n_steps, r->step + r->plan.n_advance };
        uint64_t next = r->samples.step;
        for (size_t k = 0; k < sizeof dues / sizeof *dues; k++)
            next = dues[k] < next ? dues[k] : next;
        const uint64_t n = next - r->step;
        status = r->backend->advance(r->solver, n, err);
        r->step += n;
        if (status == BF_OK)
            status = take_results(r, sink, err);
    }
    if (status == BF_OK)
        status = emit_progress(r, sink, err);
    if (status == BF_OK)
        status = emit_figures(r, sink, err);
    return status == BF_OK ? emit_end(r, false, sink, err) : status;
}
