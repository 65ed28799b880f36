// Statistics and health of the store: counts of runs and sizes of files, a liveness probe, and whether it can
// write.

#include "server/store/store_priv.h"

#include "server/base/clock.h"

#include <sqlite3.h>
#include <stdio.h>
#include <sys/stat.h>

enum { READY_MS = 1000 }; // how long a write test counts

// Opening the database's files would do harm, looking at them does none.
static uint64_t size_of(const char *path, const char *ending)
{
    char whole[STORE__PATH_SIZE + 8];
    struct stat found;

    (void)snprintf(whole, sizeof whole, "%s%s", path, ending);
    return stat(whole, &found) == 0 ? (uint64_t)found.st_size : 0;
}

bf_status store__count_stats(store *s, store_stats *ret_stats, bf_error *err)
{
    store_stats stats = { .file_bytes = size_of(s->path, ""),
                          .log_bytes = size_of(s->path, "-wal") };

    stats.free_bytes = store__count_free(s);
    store__query q = store__start_with(&s->writer, STORE__SQL_COUNT_STATES, NULL, 0);
    bf_status status = BF_OK;
    while (store__next(&q, &status, err)) {
        int state = sqlite3_column_int(q.statement, 0);
        if (state >= 0 && state < RUN_STATE_COUNT)
            stats.n_runs[state] += (uint64_t)sqlite3_column_int64(q.statement, 1);
    }
    if (status == BF_OK)
        status =
            store__read_number(&s->writer, STORE__SQL_OLDEST_QUEUED, &stats.oldest_queued_ms, err);
    int64_t n_runs = 0, n_trials = 0;
    if (status == BF_OK)
        status = store__read_number(&s->writer, STORE__SQL_COUNT_QUEUED, &n_runs, err);
    if (status == BF_OK)
        status = store__read_number(&s->writer, STORE__SQL_COUNT_CLAIMABLE_TRIALS, &n_trials, err);
    stats.n_claimable = (uint64_t)(n_runs + n_trials);
    if (status == BF_OK)
        *ret_stats = stats;
    return status;
}

void store_read_stats(store *s, store_stats *ret_stats)
{
    lock_acquire(&s->lock);
    *ret_stats = s->stats;
    lock_release(&s->lock);
}

static const store__column measured_columns[] = {
    COLUMN(TEXT, store_measured, id),
    COLUMN(TEXT, store_measured, study),
    COLUMN(REAL, store_measured, cpu_s),
    COLUMN(INTEGER, store_measured, finished_ms),
};
static const store__record measured_record = RECORD(measured_columns, store_measured, NULL);

bf_status store_list_measured(store *s, int64_t after_ms, store_measured *runs, size_t n_most,
                              size_t *ret_n, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);

    const bf_status status =
        store__list(reader, STORE__SQL_LIST_MEASURED, &measured_record, runs, n_most, ret_n, NULL,
                    err, INTEGER(after_ms), INTEGER(n_most));
    store__release_reader(&s->pool, reader);
    return status;
}

static const store__column queued_columns[] = { COLUMN(TEXT, store_queued, id),
                                                COLUMN(TEXT, store_queued, study) };
static const store__record queued_record = RECORD(queued_columns, store_queued, NULL);

bf_status store_list_queued(store *s, store_queued *runs, size_t n_most, size_t *ret_n,
                            bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);

    const bf_status status = store__list(reader, STORE__SQL_LIST_QUEUED, &queued_record, runs,
                                         n_most, ret_n, NULL, err, INTEGER(n_most));
    store__release_reader(&s->pool, reader);
    return status;
}

void store_set_queue_limit(store *s, size_t limit)
{
    s->queue_limit = limit;
}

void store_set_client_quota(store *s, size_t quota)
{
    s->client_quota = quota;
}

bool store_is_alive(store *s)
{
    bool is_alive = !liveness_is_asked(&s->liveness);

    lock_acquire(&s->lock);
    liveness_ask(&s->liveness);
    lock_wake_all(&s->writing.filled);
    lock_release(&s->lock);
    return is_alive;
}

static bf_status apply_probe(store__connection *writer, store__operation *operation, bf_error *err)
{
    (void)operation;
    return store__exec(writer, STORE__SQL_PROBE, err, INTEGER(clock_unix_ms()));
}

static bf_status probe(store *s, bf_error *err)
{
    BF_TRY(store__check_room(s, err));
    return store__write(s, apply_probe, NULL, err);
}

bf_status store_ready(store *s, bf_error *err)
{
    bf_error error = { 0 };

    // A result counts for a while; two tests at once do no harm.
    lock_acquire(&s->lock);
    bool is_known = clock_monotonic_ms() < s->ready.until_ms;
    bf_status status = s->ready.status;
    if (is_known)
        error = s->ready.error;
    lock_release(&s->lock);
    if (!is_known) {
        status = probe(s, &error);
        lock_acquire(&s->lock);
        s->ready.status = status;
        s->ready.error = error;
        s->ready.until_ms = clock_monotonic_ms() + READY_MS;
        lock_release(&s->lock);
    }
    if (status != BF_OK && err != NULL)
        *err = error;
    return status;
}
