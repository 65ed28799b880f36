#include "server/run/supervisor_priv.h"

#include "api/results/events.h"
#include "core/base/check.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"

#include <math.h>
#include <string.h>

enum {
    READ_CHUNK = 256 * 1024,
    FIRST_CHUNK = 4096, // of jobs that wait there may be thousands
};

// Of workers on other machines no longer frame is believed, so that a few wrong bytes do not take the memory: a
// checkpoint, which has no slices, and any other.
#define CHECKPOINT_BYTES_MAX (UINT64_C(1) << 30)
#define FRAME_BYTES_MAX      (UINT64_C(1) << 24)

// The rate follows changes of the last few seconds, not of single reports.
static const double rate_memory_s = 2.0;

// The next progress event comes after this fraction of the time so far, so that a run has some thousand
// events at most, however long it takes: the store has them all.
static const double progress_fraction = 1e-3;

void supervisor__free_items(supervisor__task *task)
{
    snapshots_drop_items(&task->items);
    snapshots_forget(&task->incoming);
}

static bf_status fail_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "the service has no memory to take the run's results");
}

static bf_status add_curve(supervisor__task *task, const frame_curve *c, bf_error *err)
{
    if (c->n_columns != task->n_columns)
        return bf_fail(err, BF_ECORRUPT, "", "the solver sent %u columns, not %zu", c->n_columns,
                       task->n_columns);
    store_item *item = snapshots_add_item(&task->items, API_EVENT_CURVE);
    if (item == NULL)
        return fail_memory(err);
    item->first = c->first;
    item->n = c->n;
    if (buffer_append(&item->t, c->t, c->n * sizeof *c->t) != BF_OK ||
        buffer_append(&item->values, c->values, (size_t)c->n * c->n_columns * sizeof *c->values) !=
            BF_OK)
        return fail_memory(err);
    // Events of trials are hardly ever read: the store makes them of the samples when they are.
    if (task->claimed.run.study[0] != '\0')
        return BF_OK;
    return events_curve(task->claimed.run.id, c, task->claimed.columns.bytes, &item->event, err);
}

key_figures supervisor__figures(const supervisor__task *task)
{
    return (key_figures){ .columns = task->claimed.columns.bytes,
                          .t = task->figures_t,
                          .n = task->figures.n / sizeof(double),
                          .values = (const double *)(const void *)task->figures.bytes };
}

static bf_status take_figures(supervisor__task *task, const frame_figures *f, bf_error *err)
{
    task->has_figures = true;
    task->figures_t = f->t;
    task->figures.n = 0;
    if (buffer_append(&task->figures, f->values, f->n * sizeof *f->values) != BF_OK)
        return fail_memory(err);
    const key_figures figures = supervisor__figures(task);
    return key_figures_check(&figures, err);
}

static bf_status add_figures(supervisor__task *task, bf_error *err)
{
    const key_figures figures = supervisor__figures(task);
    bf_buffer of_run = { 0 };

    if (!task->has_figures)
        return BF_OK;
    store_item *item = snapshots_add_item(&task->items, API_EVENT_FIGURES);
    if (item == NULL)
        return fail_memory(err);
    task->has_figures = false;
    json_out w = json_out_to(&item->figures), w_run = json_out_to(&of_run);
    key_figures_write(&w, &figures);
    key_figures_write_run(&w_run, figures.values);
    bf_status status = json_out_status(&w, err);
    if (status == BF_OK)
        status = json_out_status(&w_run, err);
    BF_CHECK(of_run.n < sizeof item->run_figures);
    if (status == BF_OK) {
        memcpy(item->run_figures, of_run.bytes, of_run.n);
        status = events_figures(task->claimed.run.id, &figures, &item->event, err);
    }
    buffer_fini(&of_run);
    return status;
}

static void update_rate(supervisor__task *task, double now_s)
{
    const double passed_s = now_s - task->rate_s;

    if (!(passed_s > 0.0) || task->progress.step <= task->rate_step)
        return;
    double rate = (double)(task->progress.step - task->rate_step) / passed_s;
    double weight = task->rate == 0.0 ? 1.0 : passed_s / (passed_s + rate_memory_s);
    task->rate += weight * (rate - task->rate);
    task->rate_s = now_s;
    task->rate_step = task->progress.step;
}

static bf_status add_change(supervisor__task *task, const frame_change *c, bf_error *err)
{
    static const api_event_type types[FRAME_CHANGE_TYPE_COUNT] = {
        [FRAME_CHANGE_EYE] = API_EVENT_EYE,
        [FRAME_CHANGE_ACTION] = API_EVENT_ACTION,
        [FRAME_CHANGE_DRIVE] = API_EVENT_DRIVE,
        [FRAME_CHANGE_BELT] = API_EVENT_BELT,
    };

    if (c->type >= FRAME_CHANGE_TYPE_COUNT)
        return bf_fail(err, BF_ECORRUPT, "", "a change of no known kind");
    store_item *item = snapshots_add_item(&task->items, types[c->type]);
    if (item == NULL)
        return fail_memory(err);
    item->first = c->index;
    return events_change(task->claimed.run.id, c, &item->event, err);
}

// Make the events of the newest progress and key figures, where they are due; older ones in the same batch are out
// of date.
static bf_status add_progress(supervisor__task *task, bf_error *err)
{
    const double now_s = clock_monotonic_s();
    const double wait_s = progress_fraction * supervisor__wall_s(task);

    if (task->has_progress)
        update_rate(task, now_s);
    if (task->reported_s > 0.0 && now_s < task->reported_s + wait_s && !task->has_ended)
        return BF_OK;
    if (task->has_progress) {
        task->reported_s = now_s;
        task->has_progress = false;
        store_item *item = snapshots_add_item(&task->items, API_EVENT_PROGRESS);
        BF_TRY(item == NULL ? fail_memory(err)
                            : events_progress(task->claimed.run.id, &task->progress, task->rate,
                                              &item->event, err));
    }
    return add_figures(task, err);
}

static api_parts parts_of(const frame_begin *begin)
{
    const bool is_fixed = begin->n_values > 0 && !frame_has_ids(begin->n_values);

    return (api_parts){ .n_parts = is_fixed ? begin->n_parts : 0, .n_values = begin->n_values };
}

// Put what has come into task->batch, with the checkpoint that came last (NULL: none).
static bf_status make_batch(supervisor__task *task, const frame_bytes *checkpoint, bf_error *err)
{
    executor *e = task->supervisor->executor;
    BF_TRY(add_progress(task, err));
    uint64_t step = task->progress.step, n_steps = task->begin.n_steps;
    task->batch = (store_batch){
        .run_id = task->claimed.run.id,
        .n = task->items.n,
        .items = task->items.items,
        .progress = n_steps == 0 ? 0.0 : (double)step / (double)n_steps,
        .eta_s = task->rate > 0.0 ? (double)(n_steps - step) / task->rate : (double)NAN,
        .wall_s = supervisor__wall_s(task),
        .cpu_s = supervisor__cpu_s(task),
        .token = e->functions->token == NULL ? 0 : e->functions->token(e, task->job),
        .grid = &task->begin.grid,
        .parts = parts_of(&task->begin),
        .step = checkpoint == NULL ? 0 : checkpoint->step,
        .checkpoint = checkpoint == NULL ? NULL : checkpoint->bytes,
        .n_checkpoint = checkpoint == NULL ? 0 : checkpoint->n,
    };
    return BF_OK;
}

static bf_status begin_batch(supervisor__task *task, const frame_bytes *checkpoint, bf_error *err)
{
    BF_TRY(make_batch(task, checkpoint, err));
    if (task->batch.n > 0 || checkpoint != NULL)
        supervisor__begin_write(task, SUPERVISOR_WRITE_BATCH);
    return BF_OK;
}

const store_batch *supervisor__last_batch(supervisor__task *task)
{
    bf_error err = { 0 };

    if (!task->failed && make_batch(task, NULL, &err) != BF_OK)
        supervisor__fail(task, &err);
    return task->failed || task->batch.n == 0 ? NULL : &task->batch;
}

void supervisor__finish_batch(supervisor__task *task)
{
    snapshots_drop_items(&task->items);
    task->moved_ms += clock_monotonic_ms() - task->write.begin_ms; // the job may have waited
    if (task->write.status == BF_OK)
        return;
    task->is_store_error = !task->failed && supervisor__may_work_later(task->write.status);
    if (!task->failed && task->write.status == BF_ECORRUPT)
        (void)supervisor__attribute_fault(task, &task->write.error);
    supervisor__fail(task, &task->write.error);
}

static bf_status take_begin(supervisor__task *task, const frame_begin *begin, bf_error *err)
{
    if (begin->n_columns != task->n_columns)
        return bf_fail(err, BF_ECORRUPT, "", "the solver sends %u columns, not %zu",
                       begin->n_columns, task->n_columns);
    task->begin = *begin;
    task->has_begun = true;
    BF_TRY(supervisor__check_claims(task, false, err));
    task->moved_ms = clock_monotonic_ms();
    supervisor__forget_trouble(task->supervisor);
    task->progress = (frame_progress){ .step = begin->first_step, .n_steps = begin->n_steps };
    task->rate_step = begin->first_step;
    task->rate_s = clock_monotonic_s();
    return BF_OK;
}

static void count_steps(const supervisor__task *task, uint64_t step)
{
    if (step > task->progress.step)
        metrics_add(METRICS_SOLVER_STEPS, task->claimed.run.model,
                    (int64_t)(step - task->progress.step));
}

static bf_status take_progress(supervisor__task *task, const frame_progress *p, bf_error *err)
{
    if (p->n_steps != task->begin.n_steps || p->step > p->n_steps)
        return bf_fail(err, BF_ECORRUPT, "", "the solver has lost count of its steps");
    if (p->step > task->progress.step)
        task->moved_ms = clock_monotonic_ms();
    count_steps(task, p->step);
    task->progress = *p;
    task->has_progress = true;
    return BF_OK;
}

static bool is_in_order(const supervisor__task *task, const frame *f)
{
    if (task->has_ended || f->type == FRAME_JOB || f->type == FRAME_RESUME)
        return false;
    if (f->type == FRAME_ERROR)
        return true;
    return (f->type == FRAME_BEGIN) != task->has_begun && snapshots_may_come(&task->incoming, f);
}

static bf_status fail_order(bf_error *err)
{
    return bf_fail(err, BF_ECORRUPT, "", "the solver sent frames out of order");
}

static bf_status on_frame(supervisor__task *task, const frame *f, bf_error *err)
{
    if (!is_in_order(task, f))
        return fail_order(err);
    switch (f->type) {
    case FRAME_BEGIN:
        return take_begin(task, &f->begin, err);
    case FRAME_CURVE:
        return add_curve(task, &f->curve, err);
    case FRAME_SLICE:
    case FRAME_SNAPSHOT:
    case FRAME_PARTS:
        return snapshots_take(&task->incoming, task->claimed.run.id, &task->begin, f, &task->items,
                              err);
    case FRAME_CHANGE:
        return add_change(task, &f->change, err);
    case FRAME_PROGRESS:
        return take_progress(task, &f->progress, err);
    case FRAME_CHECKPOINT:
        return begin_batch(task, &f->bytes, err); // its bytes stand in output only now
    case FRAME_FIGURES:
        return take_figures(task, &f->figures, err);
    case FRAME_END:
        count_steps(task, f->end.n_steps);
        task->end = f->end;
        task->has_ended = true;
        return BF_OK;
    default:
        task->error = f->error;
        task->failed = true;
        return BF_OK;
    }
}

// The frame that has begun at n_decoded may be as long as its header says.
static bf_status check_length(const supervisor__task *task, bf_error *err)
{
    const char *header = task->output.bytes + task->n_decoded;
    const size_t n = task->output.n - task->n_decoded;
    frame_type type = FRAME_TYPE_COUNT;
    const uint64_t length = n == 0 ? 0 : frame_length(header, n, &type);

    if (length <= FRAME_BYTES_MAX || !supervisor__has_workers(task->supervisor) ||
        (length <= CHECKPOINT_BYTES_MAX && type == FRAME_CHECKPOINT))
        return BF_OK;
    return bf_fail(err, BF_ECORRUPT, "", "a frame would have %llu bytes",
                   (unsigned long long)length);
}

// Take the whole frames at the start of the job's output, up to a checkpoint, which ends a batch.
static bf_status take_frames(supervisor__task *task, bf_error *err)
{
    const bf_buffer *in = &task->output;
    bf_status status = BF_OK;
    size_t used;
    frame f;

    task->has_frames = true;
    while (status == BF_OK && !task->write.is_pending && !task->failed) {
        status = frame_decode(in->bytes + task->n_decoded, in->n - task->n_decoded, &f, &used, err);
        if (status != BF_OK || used == 0) {
            task->has_frames = false;
            status = status == BF_OK ? check_length(task, err) : status;
            break;
        }
        if (supervisor__count_output(task, f.type, used))
            status = on_frame(task, &f, err);
        task->n_decoded += used; // a multiple of 8, so the next one is aligned
    }
    // What comes last is stored together with the end of the run.
    return status != BF_OK || task->write.is_pending || task->has_ended
               ? status
               : begin_batch(task, NULL, err);
}

// Take what the job has sent, about SUPERVISOR_READ_BYTES at most.
static bf_status read_output(supervisor__task *task, bf_error *err)
{
    executor *e = task->supervisor->executor;
    bf_buffer *output = &task->output;
    size_t n = 0, n_total = 0;
    frame_type type;

    // Room for the whole of a large frame that has begun, so that it is not moved while it comes.
    const uint64_t length = output->n == 0 ? 0 : frame_length(output->bytes, output->n, &type);
    if (length > output->n && buffer_reserve(output, length - output->n + READ_CHUNK) == NULL)
        return fail_memory(err);
    do {
        const size_t capacity = task->state == EXECUTOR_WAITING ? FIRST_CHUNK : READ_CHUNK;
        char *end = buffer_reserve(output, capacity);
        if (end == NULL)
            return fail_memory(err);
        task->state = e->functions->poll(e, task->job, end, capacity, &n, &task->exit);
        // While a job waits for somebody who solves it, its times do not run.
        if (task->state == EXECUTOR_WAITING) {
            task->start_s = 0.0;
        } else if (task->start_s == 0.0) {
            task->start_s = clock_monotonic_s();
            task->moved_ms = clock_monotonic_ms();
        }
        // After a failure only the job's end matters.
        if (!task->failed)
            output->n += n;
        n_total += n;
        task->has_more = n > 0;
    } while (n > 0 && n_total < SUPERVISOR_READ_BYTES);
    return BF_OK;
}

static bool is_over(const supervisor__task *task)
{
    return task->state == EXECUTOR_ENDED || task->state == EXECUTOR_LOST;
}

static bf_status read_frames(supervisor__task *task, bf_error *err)
{
    executor *e = task->supervisor->executor;
    bf_status status = BF_OK;
    char rest[64];
    size_t n = 0;

    // Of a job that has sent its last frame only the end is missing. What came before stays in place: items point into it.
    if (task->has_ended && !task->failed) {
        if (is_over(task))
            return BF_OK;
        task->state = e->functions->poll(e, task->job, rest, sizeof rest, &n, &task->exit);
        task->has_more = false;
        return n == 0 ? BF_OK : fail_order(err);
    }
    buffer_drop(&task->output, task->n_decoded);
    task->n_decoded = 0;
    // Frames that a checkpoint left behind come first, so that output does not grow; what the executor has
    // is then read in the next turn.
    if (task->failed || !task->has_frames)
        status = is_over(task) ? BF_OK : read_output(task, err);
    else
        task->has_more = true;
    return status == BF_OK && !task->failed ? take_frames(task, err) : status;
}

void supervisor__read_frames(supervisor__task *task)
{
    bf_error err = { 0 };

    const bf_status status = read_frames(task, &err);
    if (status == BF_OK)
        return;
    if (status == BF_ECORRUPT && !task->failed)
        (void)supervisor__attribute_fault(task, &err);
    supervisor__fail(task, &err);
}
