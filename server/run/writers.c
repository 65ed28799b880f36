// Writes of tasks into the store, none of which the supervisor's thread waits for. A task has one at a time,
// so they come into the store in order; those of different tasks go side by side and share commits.

#include "server/run/supervisor_priv.h"

#include "core/base/check.h"
#include "server/base/clock.h"

#include <signal.h>
#include <string.h>

static bf_status do_write(supervisor__task *task, bf_error *err)
{
    store *s = task->supervisor->store;

    switch (task->write.kind) {
    case SUPERVISOR_WRITE_CLAIM:
        return store_claim(s, &task->claimed, err);
    case SUPERVISOR_WRITE_ID:
        return store_set_external_id(s, task->claimed.run.id, task->external_id, err);
    default:
        BF_CHECK(task->write.kind == SUPERVISOR_WRITE_END);
        return supervisor__store_ending(task, err);
    }
}

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

static void *run_writer(void *context)
{
    supervisor *s = context;
    supervisor__writers *w = &s->writers;
    supervisor__task *task;

    lock_acquire(&w->lock);
    while ((task = take_next(w)) != NULL) {
        lock_release(&w->lock);
        bf_error err = { 0 };
        bf_status status = do_write(task, &err);
        set_done(task, status, &err);
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

void supervisor__begin_write(supervisor__task *task, supervisor__write_kind kind)
{
    supervisor *s = task->supervisor;
    bf_error err = { 0 };

    BF_CHECK(!task->write.is_pending);
    task->write =
        (supervisor__write){ .kind = kind, .is_pending = true, .begin_ms = clock_monotonic_ms() };
    if (kind != SUPERVISOR_WRITE_BATCH) {
        enqueue(&s->writers, task);
        return;
    }
    bf_status status = store_begin_append(s->store, &task->batch, set_done, task, &err);
    if (status != BF_OK)
        set_done(task, status, &err);
}

bf_status supervisor__start_writers(supervisor *s, bf_error *err)
{
    supervisor__writers *w = &s->writers;
    sigset_t all, before;
    int error = 0;

    lock_init(&w->lock);
    lock_condition_init(&w->queued);
    // Signals are for the main thread.
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (w->n_threads < SUPERVISOR_WRITERS && error == 0) {
        error = pthread_create(&w->threads[w->n_threads], NULL, run_writer, s);
        w->n_threads += error == 0;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (w->n_threads > 0)
        return BF_OK;
    return bf_fail(err, BF_ESYSTEM, "", "no thread can be started: %s", strerror(error));
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
