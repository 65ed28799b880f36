// The store's thread. It takes all operations that wait, does them in one transaction, each inside
// a savepoint of its own, and releases their callers after the commit (I1). While it syncs, the next ones
// gather: the busier the store, the larger the groups. Between two groups it does a step of retention
// (retention.c) and looks after the room on the disk (space.c), when it is time.
//
// Operations without a waiting caller pass the preparing thread first, which compresses while the store's
// thread writes and syncs.
//
// Threads  from store__write() until `done` is posted, or from store__begin_write() until its `finish`,
//          an operation belongs to the threads here. The writing connection belongs to
//          the store's thread alone while that runs (I2).

#include "server/store/store_priv.h"

#include "core/base/check.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "server/base/thread.h"

#include <errno.h>
#include <sqlite3.h>
#include <string.h>

enum { COUNT_MS = 1000 }; // between two counts of the stats

// Do one operation so that its failure undoes nothing but itself.
static bf_status apply_alone(store__connection *writer, store__operation *operation, bf_error *err)
{
    BF_TRY(store__run_plain(writer, STORE__SQL_SAVEPOINT, err));
    operation->status = operation->apply(writer, operation, &operation->error);
    // Where SQLite had to undo the whole transaction, there is no savepoint either.
    if (operation->status != BF_OK && sqlite3_get_autocommit(writer->db) != 0) {
        *err = operation->error;
        return operation->status;
    }
    if (operation->status != BF_OK)
        BF_TRY(store__run_plain(writer, STORE__SQL_ROLLBACK_TO, err));
    return store__run_plain(writer, STORE__SQL_RELEASE, err);
}

static void apply_group(store__connection *writer, store__operation *first)
{
    bf_error error = { 0 };
    int64_t begin_ns = clock_monotonic_ns(), n = 0;

    bf_status status = store__begin_transaction(writer, &error);
    for (store__operation *o = first; o != NULL && status == BF_OK; o = o->next)
        status = apply_alone(writer, o, &error);
    status = store__end_transaction(writer, status, &error);
    for (store__operation *o = first; o != NULL; o = o->next, n++) {
        if (status != BF_OK && o->status == BF_OK) {
            o->status = status;
            o->error = error;
        }
    }
    if (status != BF_OK) {
        metrics_add(METRICS_COMMIT_FAILURES, 0, 1);
        return;
    }
    metrics_observe(METRICS_COMMIT_SIZES, 0, n);
    metrics_observe(METRICS_COMMIT_TIMES, 0, clock_monotonic_ns() - begin_ns);
}

// What frees or ends something is done once more, each alone, with the room of the reserve.
static void retry_with_reserve(store *s, store__operation *first)
{
    bool has_room = false;

    for (store__operation *o = first; o != NULL; o = o->next) {
        if (!o->may_use_reserve || o->status != BF_ENOSPACE)
            continue;
        has_room = has_room || store__spend_reserve(s);
        if (!has_room)
            return;
        store__operation *next = o->next;
        o->next = NULL;
        o->status = BF_OK;
        o->error = (bf_error){ .code = BF_OK };
        o->changed[0] = '\0';
        apply_group(&s->writer, o);
        o->next = next;
    }
}

static bool is_notified_before(const store__operation *first, const store__operation *operation)
{
    for (const store__operation *o = first; o != operation; o = o->next)
        if (o->status == BF_OK && strcmp(o->changed, operation->changed) == 0)
            return true;
    return false;
}

static void notify_listener(store *s, const store__operation *first)
{
    for (const store__operation *o = first; o != NULL; o = o->next)
        s->n_stop_requests += o->status == BF_OK && o->asks_stop;
    if (s->listener == NULL)
        return;
    for (const store__operation *o = first; o != NULL; o = o->next)
        if (o->status == BF_OK && o->changed[0] != '\0' && !is_notified_before(first, o))
            s->listener(s->listener_context, o->changed);
}

static void enqueue(store *s, store__queue *queue, store__operation *operation)
{
    lock_assert_held(&s->lock);
    BF_CHECK(!queue->is_stopping);
    operation->next = NULL;
    if (queue->last == NULL)
        queue->first = operation;
    else
        queue->last->next = operation;
    queue->last = operation;
}

// Count what the operations since the last time have changed, but not too often.
static void count_if_due(store *s)
{
    store_stats stats;

    lock_assert_held(&s->lock);
    if (!s->has_new_stats || clock_monotonic_ms() < s->count_at_ms)
        return;
    s->has_new_stats = false;
    lock_release(&s->lock);
    bf_status status = store__count_stats(s, &stats, NULL);
    lock_acquire(&s->lock);
    // What could not be counted stays as it was; writers report the fault.
    if (status == BF_OK)
        s->stats = stats;
    s->count_at_ms = clock_monotonic_ms() + COUNT_MS;
}

static int64_t due_ms(const store *s)
{
    int64_t due = s->turn.next_ms < s->space.next_ms ? s->turn.next_ms : s->space.next_ms;

    return s->has_new_stats && s->count_at_ms < due ? s->count_at_ms : due;
}

static void *write_groups(void *context)
{
    store *s = context;

    lock_acquire(&s->lock);
    while (s->writing.first != NULL || !s->writing.is_stopping) {
        // Sleep until there are operations, the end, a question of liveness, or something is due.
        const store__queue *queue = &s->writing;
        bool is_time = true;
        lock_assert_held(&s->lock);
        while (is_time && queue->first == NULL && !queue->is_stopping &&
               !liveness_is_asked(&s->liveness))
            is_time = lock_wait(&s->writing.filled, &s->lock, due_ms(s));
        liveness_answer(&s->liveness);
        store__operation *first = s->writing.first;
        s->writing.first = s->writing.last = NULL;
        if (first != NULL) {
            lock_release(&s->lock);
            apply_group(&s->writer, first);
            retry_with_reserve(s, first);
            for (const store__operation *o = first; o != NULL; o = o->next)
                if (o->may_use_reserve)
                    s->space.next_ms = 0; // something was freed
            notify_listener(s, first);
            // Each caller is woken by itself, without a lock that all of them would wait for again.
            while (first != NULL) {
                store__operation *next = first->next; // an operation that is done is its owner's
                if (first->finish != NULL)
                    first->finish(first);
                else
                    BF_CHECK(sem_post(first->done) == 0);
                first = next;
            }
            lock_acquire(&s->lock);
            s->has_new_stats = true;
        }
        store__apply_retention(s);
        store__maintain_space(s);
        count_if_due(s);
    }
    lock_release(&s->lock);
    return NULL;
}

// One after the other, so that each can be written as soon as it is ready.
static void *prepare_all(void *context)
{
    store *s = context;
    store__queue *queue = &s->preparing;

    lock_acquire(&s->lock);
    while (queue->first != NULL || !queue->is_stopping) {
        store__operation *first = queue->first;
        if (first == NULL) {
            lock_wait(&queue->filled, &s->lock, -1);
            continue;
        }
        queue->first = first->next;
        if (queue->first == NULL)
            queue->last = NULL;
        lock_release(&s->lock);
        bf_status status = BF_OK;
        if (first->prepare != NULL)
            status = first->status = first->prepare(first, &first->error);
        if (status != BF_OK)
            first->finish(first);
        lock_acquire(&s->lock);
        if (status == BF_OK) {
            enqueue(s, &s->writing, first);
            lock_wake_one(&s->writing.filled);
        }
    }
    lock_release(&s->lock);
    return NULL;
}

static bf_status start_thread(store *s, store__queue *queue, void *(*loop)(void *), bf_error *err)
{
    const bf_status status = thread_start(&queue->thread, loop, s, "the store", err);

    queue->has_thread = status == BF_OK;
    return status;
}

bf_status store__start_threads(store *s, bf_error *err)
{
    BF_TRY(start_thread(s, &s->writing, write_groups, err));
    return start_thread(s, &s->preparing, prepare_all, err);
}

static void stop_thread(store *s, store__queue *queue)
{
    if (!queue->has_thread)
        return;
    lock_acquire(&s->lock);
    queue->is_stopping = true;
    lock_wake_all(&queue->filled);
    lock_release(&s->lock);
    BF_CHECK(pthread_join(queue->thread, NULL) == 0);
    queue->has_thread = false;
}

void store__stop_threads(store *s)
{
    stop_thread(s, &s->preparing);
    stop_thread(s, &s->writing);
}

void store__begin_write(store *s, store__operation *operation)
{
    lock_acquire(&s->lock);
    enqueue(s, &s->preparing, operation);
    lock_release(&s->lock);
    lock_wake_one(&s->preparing.filled);
}

void store__write_group(store *s, store__operation *operations, size_t n)
{
    sem_t done;

    BF_CHECK(sem_init(&done, 0, 0) == 0);
    lock_acquire(&s->lock);
    for (size_t i = 0; i < n; i++) {
        operations[i].done = &done;
        enqueue(s, &s->writing, &operations[i]);
    }
    lock_release(&s->lock);
    // Only now, so that the thread does not wake to wait for the lock.
    lock_wake_one(&s->writing.filled);
    for (size_t i = 0; i < n; i++)
        while (sem_wait(&done) != 0)
            BF_CHECK(errno == EINTR);
    BF_CHECK(sem_destroy(&done) == 0);
}

static bf_status write_and_wait(store *s, store__operation *operation, bf_error *err)
{
    store__write_group(s, operation, 1);
    if (operation->status != BF_OK && err != NULL)
        *err = operation->error;
    return operation->status;
}

bf_status store__write(store *s, store__apply *apply, void *context, bf_error *err)
{
    store__operation operation = { .apply = apply, .context = context };

    return write_and_wait(s, &operation, err);
}

bf_status store__write_freeing(store *s, store__apply *apply, void *context, bf_error *err)
{
    store__operation operation = { .apply = apply, .context = context, .may_use_reserve = true };

    return write_and_wait(s, &operation, err);
}
