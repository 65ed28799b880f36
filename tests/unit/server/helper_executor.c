#include "tests/unit/server/helper_executor.h"
#include "tests/unit/server/helper_await.h"

#include "server/base/clock.h"
#include "server/base/lock.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

struct executor_job {
    char id[EXECUTOR_ID_SIZE];
    helper_job seen;
    executor_state state; // once the bytes are taken
    executor_end end;
    bf_buffer bytes;
    bool ignores_stops;
    double cpu_s;
};

struct helper_executor {
    executor base;
    lock lock; // guards all below
    lock_condition changed;
    executor_job jobs[HELPER_JOBS_MAX];
    size_t n_jobs;
    unsigned n_refused;
    bf_status refusal;
    bool ignores_stops;
    size_t chunk;
    unsigned n_failures; // that jobs told of
    size_t room;
};

static void wake(helper_executor *e)
{
    uint64_t one = 1;

    assert_int_equal(write(e->base.wake_fd, &one, sizeof one), sizeof one);
}

static size_t add_job(helper_executor *e, const char *run_id, uint64_t first_step)
{
    lock_assert_held(&e->lock);
    assert_true(e->n_jobs < HELPER_JOBS_MAX);
    executor_job *job = &e->jobs[e->n_jobs];
    job->ignores_stops = e->ignores_stops;
    job->seen.first_step = first_step;
    snprintf(job->id, sizeof job->id, "fake:%zu", e->n_jobs);
    snprintf(job->seen.run_id, sizeof job->seen.run_id, "%s", run_id);
    lock_wake_all(&e->changed);
    return e->n_jobs++;
}

static bf_status ready(executor *base, bf_error *err)
{
    (void)base;
    return BF_OK;
}

static bf_status start(executor *base, const executor_work *work, executor_job **ret_job,
                       bf_error *err)
{
    helper_executor *e = (helper_executor *)base;
    bf_status status = BF_OK;

    lock_acquire(&e->lock);
    if (e->n_refused > 0) {
        e->n_refused--;
        status = bf_fail(err, e->refusal, "", "there is no place for a job");
    } else {
        e->room -= e->room > 0;
        size_t index = add_job(e, work->run_id, work->checkpoint->n == 0 ? 0 : work->step);
        *ret_job = &e->jobs[index];
    }
    lock_release(&e->lock);
    return status;
}

static bf_status attach(executor *base, const char *external_id, executor_job **ret_job,
                        bf_error *err)
{
    helper_executor *e = (helper_executor *)base;
    executor_job *found = NULL;

    lock_acquire(&e->lock);
    for (size_t i = 0; i < e->n_jobs; i++) {
        if (strcmp(e->jobs[i].id, external_id) == 0)
            found = &e->jobs[i];
    }
    lock_release(&e->lock);
    if (found == NULL)
        return bf_fail(err, BF_ENOTFOUND, "", "there is no job %s", external_id);
    *ret_job = found;
    return BF_OK;
}

void helper_encode(const frame *f, bf_buffer *out)
{
    frame slice;

    for (uint64_t at = 0; frame_slice_at(f, at, &slice); at += slice.slice.n)
        assert_int_equal(frame_encode(&slice, out, NULL), BF_OK);
    assert_int_equal(frame_encode(f, out, NULL), BF_OK);
}

static void append_frame(executor_job *job, const frame *f)
{
    helper_encode(f, &job->bytes);
}

static void stop(executor *base, executor_job *job, executor_stop how)
{
    helper_executor *e = (helper_executor *)base;
    const frame end = { .type = FRAME_END, .end = { .stopped = 1, .n_steps = 1 } };

    lock_acquire(&e->lock);
    job->seen.n_graceful += how == EXECUTOR_STOP_GRACEFUL;
    job->seen.n_now += how == EXECUTOR_STOP_NOW;
    if (!job->ignores_stops && job->state == EXECUTOR_RUNNING) {
        if (how == EXECUTOR_STOP_GRACEFUL)
            append_frame(job, &end);
        job->state = EXECUTOR_ENDED;
        job->end.cause = how == EXECUTOR_STOP_GRACEFUL ? API_JOB_EXITED : API_JOB_KILLED;
    }
    lock_wake_all(&e->changed);
    lock_release(&e->lock);
    wake(e);
}

static void update(executor *base)
{
    uint64_t n;

    assert_int_equal(read(base->wake_fd, &n, sizeof n), sizeof n);
}

static executor_state poll_job(executor *base, executor_job *job, void *bytes, size_t capacity,
                               size_t *ret_n, executor_end *ret_end)
{
    helper_executor *e = (helper_executor *)base;

    lock_acquire(&e->lock);
    assert_false(job->seen.is_released);
    size_t n = job->bytes.n < capacity ? job->bytes.n : capacity;
    n = n < e->chunk ? n : e->chunk;
    if (n > 0)
        memcpy(bytes, job->bytes.bytes, n);
    buffer_drop(&job->bytes, n);
    *ret_n = n;
    *ret_end = job->end;
    executor_state state = n > 0 ? EXECUTOR_RUNNING : job->state;
    lock_wake_all(&e->changed);
    lock_release(&e->lock);
    return state;
}

static double cpu_s(executor *base, executor_job *job)
{
    helper_executor *e = (helper_executor *)base;

    lock_acquire(&e->lock);
    double used_s = job->cpu_s;
    lock_release(&e->lock);
    return used_s;
}

static const char *external_id(const executor_job *job)
{
    return job->id;
}

static void release(executor *base, executor_job *job)
{
    helper_executor *e = (helper_executor *)base;

    lock_acquire(&e->lock);
    assert_false(job->seen.is_released);
    job->seen.is_released = true;
    lock_wake_all(&e->changed);
    lock_release(&e->lock);
}

static bool has_room(executor *base, bool is_trial)
{
    helper_executor *e = (helper_executor *)base;

    lock_acquire(&e->lock);
    bool has = e->room > 0;
    lock_release(&e->lock);
    return has;
}

static bool attribute_fault(executor *base, executor_job *job, const bf_error *why)
{
    helper_executor *e = (helper_executor *)base;

    assert_int_not_equal(why->code, BF_OK);
    lock_acquire(&e->lock);
    job->seen.n_blamed++;
    lock_release(&e->lock);
    return true;
}

static bool confirm(executor *base, const executor_job *job, const bf_error *why)
{
    helper_executor *e = (helper_executor *)base;

    lock_acquire(&e->lock);
    const bool counts = why == NULL || e->n_failures++ > 0;
    lock_release(&e->lock);
    return counts;
}

#define FUNCTIONS                                                                                  \
    .ready = ready, .start = start, .attach = attach, .stop = stop, .update = update,              \
    .poll = poll_job, .cpu_s = cpu_s, .external_id = external_id, .release = release

void helper_executor_employ(helper_executor *e, size_t n)
{
    static const executor_functions functions = { FUNCTIONS, .has_room = has_room,
                                                  .attribute_fault = attribute_fault,
                                                  .confirm = confirm };

    lock_acquire(&e->lock);
    e->room = n;
    if (e->base.functions != &functions) // before the supervisor has begun
        e->base.functions = &functions;
    lock_release(&e->lock);
    wake(e);
}

helper_executor *helper_executor_create(void)
{
    static const executor_functions functions = { FUNCTIONS };
    helper_executor *e = calloc(1, sizeof *e);

    assert_non_null(e);
    e->base =
        (executor){ &functions, eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), .outlives_daemon = true };
    assert_true(e->base.wake_fd >= 0);
    e->chunk = SIZE_MAX;
    lock_init(&e->lock);
    lock_condition_init(&e->changed);
    return e;
}

void helper_executor_destroy(helper_executor *e)
{
    if (e == NULL)
        return;
    for (size_t i = 0; i < e->n_jobs; i++)
        buffer_fini(&e->jobs[i].bytes);
    close(e->base.wake_fd);
    lock_condition_fini(&e->changed);
    lock_fini(&e->lock);
    free(e);
}

executor *helper_executor_base(helper_executor *e)
{
    return &e->base;
}

void helper_executor_refuse(helper_executor *e, unsigned n, bf_status status)
{
    lock_acquire(&e->lock);
    e->n_refused = n;
    e->refusal = status;
    lock_release(&e->lock);
}

void helper_executor_ignore_stops(helper_executor *e)
{
    lock_acquire(&e->lock);
    e->ignores_stops = true;
    lock_release(&e->lock);
}

void helper_executor_deliver_slowly(helper_executor *e, size_t n)
{
    lock_acquire(&e->lock);
    e->chunk = n;
    lock_release(&e->lock);
}

size_t helper_executor_add(helper_executor *e, const char *run_id)
{
    lock_acquire(&e->lock);
    size_t index = add_job(e, run_id, 0);
    lock_release(&e->lock);
    return index;
}

void helper_executor_await(helper_executor *e, size_t n)
{
    int64_t deadline_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;

    lock_acquire(&e->lock);
    while (e->n_jobs < n && lock_wait(&e->changed, &e->lock, deadline_ms))
        ;
    bool is_there = e->n_jobs >= n;
    lock_release(&e->lock);
    assert_true(is_there);
}

helper_job helper_executor_job(helper_executor *e, size_t index)
{
    lock_acquire(&e->lock);
    assert_true(index < e->n_jobs);
    e->jobs[index].seen.n_unread = e->jobs[index].bytes.n;
    helper_job seen = e->jobs[index].seen;
    lock_release(&e->lock);
    return seen;
}

void helper_executor_send_bytes(helper_executor *e, size_t index, const void *bytes, size_t n)
{
    lock_acquire(&e->lock);
    assert_int_equal(buffer_append(&e->jobs[index].bytes, bytes, n), BF_OK);
    lock_release(&e->lock);
    wake(e);
}

void helper_executor_send(helper_executor *e, size_t index, const frame *f)
{
    lock_acquire(&e->lock);
    append_frame(&e->jobs[index], f);
    lock_release(&e->lock);
    wake(e);
}

void helper_executor_begin(helper_executor *e, size_t index)
{
    const frame f = { .type = FRAME_BEGIN,
                      .begin = { .n_columns = 2,
                                 .n_steps = 10,
                                 .first_step = helper_executor_job(e, index).first_step,
                                 .grid = { .n1 = 4, .n2 = 2, .d1 = 1, .d2 = 1 } } };

    helper_executor_send(e, index, &f);
}

void helper_executor_samples(helper_executor *e, size_t index, uint64_t first, uint32_t n,
                             double offset)
{
    double *t = calloc(n, sizeof *t), *values = calloc(n, 2 * sizeof *values);
    const frame f = { .type = FRAME_CURVE,
                      .curve = {
                          .first = first, .n = n, .n_columns = 2, .t = t, .values = values } };

    assert_true(t != NULL && values != NULL);
    for (uint32_t i = 0; i < n; i++) {
        t[i] = (double)(first + i) / 100;
        values[2 * i] = (double)(first + i) + offset;
        values[2 * i + 1] = 0.5 * (double)(first + i) + offset;
    }
    helper_executor_send(e, index, &f);
    free(t);
    free(values);
}

void helper_executor_snapshot(helper_executor *e, size_t index, uint64_t number)
{
    float rho[8];
    const frame f = { .type = FRAME_SNAPSHOT,
                      .snapshot = { .index = number, .n1 = 4, .n2 = 2, .rho = rho } };

    for (size_t i = 0; i < 8; i++)
        rho[i] = (float)number;
    helper_executor_send(e, index, &f);
}

void helper_executor_checkpoint(helper_executor *e, size_t index, uint64_t step)
{
    const frame f = { .type = FRAME_CHECKPOINT,
                      .bytes = { .step = step, .n = sizeof step, .bytes = &step } };

    helper_executor_send(e, index, &f);
}

void helper_executor_finish(helper_executor *e, size_t index, bool stopped)
{
    const frame f = { .type = FRAME_END, .end = { .stopped = stopped, .n_steps = 10 } };

    helper_executor_send(e, index, &f);
    helper_executor_end(e, index, API_JOB_EXITED);
}

static void set_state(helper_executor *e, size_t index, executor_state state, api_job_cause cause)
{
    lock_acquire(&e->lock);
    e->jobs[index].state = state;
    e->jobs[index].end.cause = cause;
    if (cause != API_JOB_EXITED)
        (void)bf_fail(&e->jobs[index].end.error, BF_ESYSTEM, "", "the fake job ended");
    lock_release(&e->lock);
    wake(e);
}

void helper_executor_use(helper_executor *e, size_t index, double used_s)
{
    lock_acquire(&e->lock);
    e->jobs[index].cpu_s = used_s;
    lock_release(&e->lock);
}

void helper_executor_end(helper_executor *e, size_t index, api_job_cause cause)
{
    set_state(e, index, EXECUTOR_ENDED, cause);
}

void helper_executor_lose(helper_executor *e, size_t index)
{
    set_state(e, index, EXECUTOR_LOST, API_JOB_EXITED);
}

void helper_executor_disconnect(helper_executor *e, size_t index)
{
    set_state(e, index, EXECUTOR_UNKNOWN, API_JOB_EXITED);
}
