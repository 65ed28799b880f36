#include "core/run/run.h"

#include "core/base/check.h"
#include "core/base/checkpoint.h"
#include "core/base/digest.h"
#include "core/base/memory.h"
#include "core/run/run_priv.h"
#include "core/scene/definition.h"

#include <math.h>
#include <string.h>

enum {
    BATCH = 256, // samples that wait for a frame
    COLUMNS_MAX = SCENE_COUNTERS_MAX + 1,
};

// When something is taken: at the first step at or past each multiple of a period.
typedef struct schedule {
    double every;   // s
    uint64_t index; // of the next multiple
    uint64_t step;  // at which it is due
    uint64_t n;     // how many were taken
} schedule;

// The header of the solver's state in a checkpoint.
typedef struct saved_header {
    uint64_t step;
    uint64_t sample_index, n_samples;
    uint64_t snapshot_index, n_snapshots;
    double parts_start;
    double peak;
} saved_header;

struct run {
    run_model model;
    uint64_t definition; // digest of scenario and model, to which checkpoints belong
    const run_backend *backend;
    void *solver;
    run_plan plan;
    uint64_t step, first_step;
    schedule samples, snapshots;
    double parts_start, peak;
    uint32_t n_columns;
    uint32_t n_waiting; // samples in the arrays below
    double t[BATCH];
    double values[BATCH * COLUMNS_MAX];
    float *rho;
    double *parts;      // rows of FRAME_PARTS
    size_t n_parts_max; // numbers that they have room for
    bf_buffer checkpoint;
};

const char *const run_model_words[] = { "macro", "micro", NULL };

const double run_density_trusted = 1.4;
const double run_overlap_trusted = 0.05;

static const run_backend *const backends[RUN_MODEL_COUNT] = {
    [RUN_MACRO] = &run__macro, [RUN_MICRO] = &run__micro
};

unsigned run_doubts(run_model model, const frame_end *end)
{
    unsigned doubts = 0;

    if (model == RUN_MACRO && end->peak > run_density_trusted)
        doubts |= RUN_DOUBT_DENSITY;
    if (end->overlap_share > run_overlap_trusted)
        doubts |= RUN_DOUBT_OVERLAP;
    return doubts;
}

bf_status run_review_of(const scene *s, run_model model, run_review *ret_review, bf_error *err)
{
    const double step = scene_macro_step(s), positive = scene_step_positive(s);

    *ret_review = (run_review){ .model = model };
    if (model != RUN_MACRO)
        return BF_OK;
    if (step >= positive)
        faults_add(&ret_review->warnings, "/macro/step_s",
                   "the step, %.6g s, is not below %.6g s: densities may become negative", step,
                   positive);
    bf_status status = validity_of(s, &ret_review->validity, err);
    for (size_t k = 0; status == BF_OK && k < ret_review->validity.n; k++)
        faults_add(&ret_review->warnings, ret_review->validity.items[k].pointer, "%s",
                   ret_review->validity.items[k].detail);
    return status;
}

bool run_model_is_available(run_model model)
{
    return model < RUN_MODEL_COUNT && backends[model] != NULL;
}

uint64_t run__steps_until(double t, double dt)
{
    double steps = t / dt;
    double nearest = nearbyint(steps);
    bool is_whole = fabs(steps - nearest) <= 1e-9 + 1e-12 * steps;

    return (uint64_t)(is_whole ? nearest : ceil(steps));
}

void run_check(const scene *s, run_model model, bf_faults *faults)
{
    backends[model]->check_scenario(s, faults);
}

static int reserve_parts(run *r, uint64_t n_rows)
{
    return memory_reserve(&r->parts, &r->n_parts_max, n_rows * r->plan.n_values, sizeof *r->parts);
}

static bf_status allocate_results(run *r, bf_error *err)
{
    r->rho = memory_alloc(grid_cells(&r->plan.grid), sizeof *r->rho);
    if (r->rho == NULL || reserve_parts(r, r->plan.n_parts) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a snapshot");
    return BF_OK;
}

bf_status run_create(const scene *s, run_model model, int n_threads, run **ret_run, bf_error *err)
{
    if (!run_model_is_available(model))
        return bf_fail(err, BF_EINPUT, "/model", "this build has no solver for that model");
    run *r = memory_alloc(1, sizeof *r);
    if (r == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for a run");
    r->model = model;
    r->definition = digest_add(definition_digest(s), &model, sizeof model);
    r->backend = backends[model];
    r->n_columns = (uint32_t)s->n_counters + 1;
    r->samples.every = s->output.curve_every;
    r->snapshots.every = s->output.snapshot_every;
    bf_status status = r->backend->create(s, n_threads, &r->solver, &r->plan, err);
    if (status == BF_OK) {
        r->parts_start = r->backend->measure(r->solver).parts;
        status = allocate_results(r, err);
    }
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
    buffer_fini(&r->checkpoint);
    memory_free(r->rho);
    memory_free(r->parts);
    memory_free(r);
    return NULL;
}

// Moves a schedule on to its first multiple that lies after a step.
static void move_past(schedule *s, uint64_t step, double dt)
{
    while (s->step <= step)
        s->step = run__steps_until((double)++s->index * s->every, dt);
}

static void restore_schedule(schedule *s, uint64_t index, uint64_t n, double dt)
{
    s->index = index;
    s->n = n;
    s->step = run__steps_until((double)index * s->every, dt);
}

bf_status run_resume(run *r, const void *bytes, size_t n, bf_error *err)
{
    checkpoint_reader reader;
    saved_header h;

    bf_status status = checkpoint_open(&reader, bytes, n, CHECKPOINT_RUN, r->definition, err);
    if (status != BF_OK)
        return status;
    if (!checkpoint_read(&reader, &h, sizeof h) || h.step > r->plan.n_steps)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
    status = r->backend->load(r->solver, reader.at, reader.n_left, err);
    if (status != BF_OK)
        return status;
    r->step = r->first_step = h.step;
    r->parts_start = h.parts_start;
    r->peak = h.peak;
    restore_schedule(&r->samples, h.sample_index, h.n_samples, r->plan.dt);
    restore_schedule(&r->snapshots, h.snapshot_index, h.n_snapshots, r->plan.dt);
    return BF_OK;
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
                                 .grid = r->plan.grid } };

    return sink->take(sink->context, &f, err);
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
    return sink->take(sink->context, &f, err);
}

static bf_status emit_progress(run *r, const run_sink *sink, bf_error *err)
{
    const frame f = { .type = FRAME_PROGRESS,
                      .progress = {
                          .step = r->step, .n_steps = r->plan.n_steps, .t = time_now(r) } };

    return sink->take(sink->context, &f, err);
}

static bf_status emit_checkpoint(run *r, const run_sink *sink, bf_error *err)
{
    const saved_header h = { .step = r->step,
                             .sample_index = r->samples.index,
                             .n_samples = r->samples.n,
                             .snapshot_index = r->snapshots.index,
                             .n_snapshots = r->snapshots.n,
                             .parts_start = r->parts_start,
                             .peak = r->peak };
    checkpoint_writer w;

    r->checkpoint.n = 0;
    checkpoint_begin(&w, &r->checkpoint, CHECKPOINT_RUN, r->definition);
    checkpoint_write(&w, &h, sizeof h);
    bf_status status = r->backend->save(r->solver, &r->checkpoint, err);
    if (status == BF_OK)
        status = checkpoint_end(&w, err);
    if (status != BF_OK)
        return status;
    const frame f = { .type = FRAME_CHECKPOINT,
                      .bytes = {
                          .step = r->step, .n = r->checkpoint.n, .bytes = r->checkpoint.bytes } };
    return sink->take(sink->context, &f, err);
}

static bf_status emit_end(run *r, bool is_stopped, const run_sink *sink, bf_error *err)
{
    const run_load load = r->backend->measure(r->solver);
    frame f = { .type = FRAME_END,
                .end = { .stopped = is_stopped,
                         .n_steps = r->step,
                         .t = time_now(r),
                         .n_cells = grid_cells(&r->plan.grid),
                         .parts_start = r->parts_start,
                         .parts_end = load.parts,
                         .peak = fmax(r->peak, load.peak),
                         .digest = r->backend->digest(r->solver),
                         .n_samples = r->samples.n,
                         .n_snapshots = r->snapshots.n } };

    if (r->backend->fill_end != NULL)
        r->backend->fill_end(r->solver, &f.end);
    return sink->take(sink->context, &f, err);
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
    r->backend->count(r->solver, values);
    values[r->n_columns - 1] = r->parts_start + load.entered - load.parts;
    r->samples.n++;
    move_past(&r->samples, r->step, r->plan.dt);
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
    return sink->take(sink->context, &f, err);
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
    const frame f = { .type = FRAME_SNAPSHOT,
                      .snapshot = { .index = r->snapshots.n,
                                    .t = time_now(r),
                                    .peak = load.peak,
                                    .mass = load.parts,
                                    .n1 = (uint32_t)r->plan.grid.n1,
                                    .n2 = (uint32_t)r->plan.grid.n2,
                                    .rho = r->rho } };
    status = sink->take(sink->context, &f, err);
    if (status == BF_OK)
        status = emit_parts(r, load.n_rows, sink, err);
    r->snapshots.n++;
    move_past(&r->snapshots, r->step, r->plan.dt);
    return status;
}

// Takes what is due at the present step.
static bf_status take_results(run *r, const run_sink *sink, bf_error *err)
{
    const bool is_end = r->step == r->plan.n_steps;
    bf_status status = BF_OK;

    if (r->step >= r->samples.step || is_end)
        status = take_sample(r, sink, err);
    if (status == BF_OK && (r->step >= r->snapshots.step || is_end))
        status = take_snapshot(r, sink, err);
    return status;
}

// Serves the sink's requests.
static bf_status serve_request(run *r, unsigned request, const run_sink *sink, bf_error *err)
{
    bf_status status = emit_curve(r, sink, err);

    if (status == BF_OK)
        status = emit_progress(r, sink, err);
    if (status == BF_OK && (request & RUN_CHECKPOINT) != 0)
        status = emit_checkpoint(r, sink, err);
    if (status == BF_OK && (request & RUN_STOP) != 0)
        status = emit_end(r, true, sink, err);
    return status;
}

// Steps until the next result is due, but not so many that a request waits for long.
static uint64_t count_steps(const run *r)
{
    uint64_t next = r->samples.step < r->snapshots.step ? r->samples.step : r->snapshots.step;
    uint64_t n = (next < r->plan.n_steps ? next : r->plan.n_steps) - r->step;

    return n < r->plan.n_advance ? n : r->plan.n_advance;
}

bf_status run_execute(run *r, const run_sink *sink, bf_error *err)
{
    bf_status status = emit_begin(r, sink, err);

    if (status == BF_OK && r->step == 0)
        status = take_results(r, sink, err);
    while (status == BF_OK && r->step < r->plan.n_steps) {
        const unsigned request =
            sink->requested == NULL ? RUN_GO_ON : sink->requested(sink->context);
        if (request != RUN_GO_ON) {
            status = serve_request(r, request, sink, err);
            if (status != BF_OK || (request & RUN_STOP) != 0)
                return status;
        }
        const uint64_t n = count_steps(r);
        status = r->backend->advance(r->solver, n, err);
        r->step += n;
        if (status == BF_OK)
            status = take_results(r, sink, err);
    }
    if (status == BF_OK)
        status = emit_progress(r, sink, err);
    return status == BF_OK ? emit_end(r, false, sink, err) : status;
}
