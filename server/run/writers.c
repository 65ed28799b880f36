#include "server/run/writers.h"

#include "server/run/supervisor_priv.h"

#include "core/base/check.h"
#include "server/base/clock.h"
#include "server/base/thread.h"

// The next task, under the lock; NULL: the queue is empty and no more will come.
static supervisor__task *take_next(supervisor__writers *w)
{
    lock_assert_held(&w->lock);
    while (w->first == NULL && !w->is_stopping)
        (void)lock_wait(&w->queued, &w->lock, -1);
    supervisor__task *task = w->first;
    if (task == NULL)
        return NULL;
    w->first = task->write.next;
    if (w->first == NULL)
        w->last = NULL;
    return task;
}

// The write's result. From here on the supervisor's thread owns the task and may free it. On a
// writing thread or one of the store's.
static void set_done(void *context, bf_status status, const bf_error *err)
{
    supervisor__task *task = context;
    supervisor *s = task->supervisor;

    task->write.status = status;
    if (status != BF_OK)
        task->write.error = *err;
    atomic_store(&task->write.is_done, true);
    supervisor__wake_loop(s);
}

// The claim is made with the end where that can be, else behind it.
static void end_and_claim(supervisor__task *task)
{
    store *s = task->supervisor->store;
    supervisor__task *follower = task->write.follower;
    store_next next = { .status = BF_ECONFLICT };
    bf_error err = { 0 };

    task->ending.next = follower == NULL ? NULL : &next;
    next.with_trials = follower != NULL && follower->with_trials;
    bf_status status = supervisor__store_ending(task, &err);
    set_done(task, status, &err);
    if (follower == NULL)
        return;
    follower->claimed = next.job;
    if (next.status == BF_ECONFLICT)
        next.status = store_claim(s, follower->with_trials, &follower->claimed, &next.error);
    set_done(follower, next.status, &next.error);
}

static void do_write(supervisor__task *task)
{
    store *s = task->supervisor->store;
    bf_error err = { 0 };

    switch (task->write.kind) {
    case SUPERVISOR_WRITE_CLAIM:
        set_done(task, store_claim(s, task->with_trials, &task->claimed, &err), &err);
        return;
    case SUPERVISOR_WRITE_ID:
        set_done(task, store_set_external_id(s, task->claimed.run.id, task->external_id, &err),
                 &err);
        return;
    default:
        BF_CHECK(task->write.kind == SUPERVISOR_WRITE_END);
        end_and_claim(task);
    }
}

static void *run_writer(void *context)
{
    supervisor *s = context;
    supervisor__writers *w = &s->writers;
    supervisor__task *task;

    lock_acquire(&w->lock);
    while ((task = take_next(w)) != NULL) {
        lock_release(&w->lock);
        do_write(task);
        lock_acquire(&w->lock);
    }
    lock_release(&w->lock);
    return NULL;
}

static void enqueue(supervisor__writers *w, supervisor__task *task)
{
    lock_acquire(&w->lock);
    if (w->last == NULL)
        w->first = task;
    else
        w->last->write.next = task;
    w->last = task;
    lock_wake_all(&w->queued);
    lock_release(&w->lock);
}

static void begin(supervisor__task *task, supervisor__write_kind kind)
{
    BF_CHECK(!task->write.is_pending);
    task->write =
        (supervisor__write){ .kind = kind, .is_pending = true, .begin_ms = clock_monotonic_ms() };
}

void supervisor__begin_write(supervisor__task *task, supervisor__write_kind kind)
{
    supervisor *s = task->supervisor;
    bf_error err = { 0 };

    begin(task, kind);
    if (kind != SUPERVISOR_WRITE_BATCH) {
        enqueue(&s->writers, task);
        return;
    }
    bf_status status = store_begin_append(s->store, &task->batch, set_done, task, &err);
    if (status != BF_OK)
        set_done(task, status, &err);
}

void supervisor__begin_end(supervisor__task *task, supervisor__task *follower)
{
    begin(task, SUPERVISOR_WRITE_END);
    task->write.follower = follower;
    if (follower != NULL)
        begin(follower, SUPERVISOR_WRITE_CLAIM);
    enqueue(&task->supervisor->writers, task);
}

bf_status supervisor__start_writers(supervisor *s, bf_error *err)
{
    supervisor__writers *w = &s->writers;
    bf_status status = BF_OK;

    lock_init(&w->lock);
    lock_condition_init(&w->queued);
    while (w->n_threads < SUPERVISOR_WRITERS && status == BF_OK) {
        status = thread_start(&w->threads[w->n_threads], run_writer, s, "the supervisor", err);
        w->n_threads += status == BF_OK;
    }
    return w->n_threads > 0 ? BF_OK : status;
}

void supervisor__stop_writers(supervisor *s)
{
    supervisor__writers *w = &s->writers;

    lock_acquire(&w->lock);
    w->is_stopping = true;
    lock_wake_all(&w->queued);
    lock_release(&w->lock);
    for (unsigned i = 0; i < w->n_threads; i++)
        BF_CHECK(pthread_join(w->threads[i], NULL) == 0);
    lock_condition_fini(&w->queued);
    lock_fini(&w->lock);
}
