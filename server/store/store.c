// The files of the store:
//
//     store.c             opens, closes; where each invariant is kept
//     store_file.c        the directory, its lock file, its free space
//     store_connection.c  the one place that opens the database; statements
//     store_schema.c      what the tables are, and how older ones become newer ones
//     store_thread.c      the thread that writes
//     store_pool.c        the connections that read
//     store_row.c         a run's row, its moves and events
//     store_submit.c      submit
//     store_answers.c     the first answers to idempotency keys
//     store_results.c     results that runs share
//     store_write.c       finish, cancel, remove
//     store_claim.c       claim
//     store_append.c      append
//     store_blob.c        compression, chunks
//     store_read.c        runs, texts, curves
//     store_read_*.c      snapshots, events
//     store_measurements.c  measured curves
//     store_ready.c       the write test
//     store_care.c        what is removed by itself
//     store_backup.c      a copy of a store
//     store_verify.c      the invariants as questions to a store
//     store_figures.c     how much there is of what
//
// Where each invariant of store.h is kept:
//
//   I1  store_connection.c: synchronous = FULL. store_thread.c: answers come after the commit.
//   I2  store_connection.c opens; only store_open() asks for STORE__READ_WRITE. The lock file keeps
//       other processes out. store_pool.c: readers.
//   I3  store__move_row() is the only function that changes a state.
//   I4  store_append.c: check_curve(), check_snapshot(), and what they let pass.
//   I5  store_append.c: a checkpoint and what was told before it are one transaction.
//   I6  store_schema.c: AUTOINCREMENT.
//   I7  store_append.c, store_row.c: events are inserted by the operation that they tell of.
//   I8  requeue_all() below.
//   I9  store_schema.c: tables refer to runs or results with ON DELETE CASCADE. store__remove_row()
//       begins what store__sweep_results() ends; store_care.c looks for what was left over.
//   I10 store_results.c: only complete sets are found, and store__sweep_results() spares what a run
//       still has.
//   I11 store_submit.c: one operation looks for the answer, makes the run and keeps the answer.
//   I12 store_care.c: OLDEST_ENDED chooses.
//   I13 store_measurements.c: one row each, with its samples, and no statement that updates it.

#include "server/store/store.h"

#include "core/base/memory.h"
#include "server/base/log.h"
#include "server/store/share_priv.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static bool still_runs(const store_options *options, const store__row *row)
{
    store_running running = { .stop_request = row->stop_request };

    if (options->still_runs == NULL)
        return false;
    memcpy(running.id, row->run.id, sizeof running.id);
    memcpy(running.external_id, row->external_id, sizeof running.external_id);
    return options->still_runs(options->still_runs_context, &running);
}

// What the daemon before was running and the executor does not have any more is queued again (I8).
static bf_status requeue_all(store__connection *writer, const store_options *options, int *ret_n,
                             bf_error *err)
{
    store__row row = { .number = 0 };
    bool has_row = true;
    bf_status status = BF_OK;
    int n = 0;

    while (status == BF_OK) {
        status = store__next_running(writer, row.run.id, &row, &has_row, err);
        if (status != BF_OK || !has_row)
            break;
        if (still_runs(options, &row))
            continue;
        status = store__move_row(writer, &row, RUN_QUEUED, err);
        n++;
    }
    *ret_n = n;
    return status;
}

static bf_status mend(store__connection *writer, const store_options *options, int *ret_n_requeued,
                      bf_error *err)
{
    bf_status status = store__disown_results(writer, err);

    return status == BF_OK ? requeue_all(writer, options, ret_n_requeued, err) : status;
}

static bf_status recover(store__connection *writer, const store_options *options, bf_error *err)
{
    int n = 0;

    bf_status status = store__run_plain(writer, STORE__SQL_BEGIN_WRITE, err);
    if (status == BF_OK)
        status = store__end_transaction(writer, mend(writer, options, &n, err), err);
    if (status == BF_OK && n > 0)
        log_event(LOG_LEVEL_INFO, "runs_requeued", "runs=%d", n);
    return status;
}

static bf_status set_paths(store *s, const char *directory, bf_error *err)
{
    // The longest of our file names and SQLite's "-journal" still fit.
    if (strlen(directory) + 32 > STORE__PATH_SIZE)
        return bf_fail(err, BF_ESYSTEM, "", "the data directory's path is too long");
    snprintf(s->directory, sizeof s->directory, "%s", directory);
    snprintf(s->path, sizeof s->path, "%.*s/beltflow.db", STORE__PATH_SIZE - 32, directory);
    return BF_OK;
}

static store *create(const store_options *options)
{
    store *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return NULL;
    s->queue_limit = options->queue_limit;
    s->client_quota = options->client_quota;
    s->answers_ms = options->answers_ms == 0 ? STORE__ANSWERS_MS : options->answers_ms;
    s->retention = options->retention;
    s->care.every_ms = options->care_ms == 0 ? STORE__CARE_MS : options->care_ms;
    s->listener = options->listener;
    s->listener_context = options->listener_context;
    s->lock_file = -1;
    store__init_pool(&s->pool);
    lock_init(&s->lock);
    lock_condition_init(&s->preparing.filled);
    lock_condition_init(&s->writing.filled);
    lock_condition_init(&s->done);
    return s;
}

bf_status store_open(const store_options *options, store **ret_store, bf_error *err)
{
    if (sodium_init() < 0)
        return bf_fail(err, BF_ESYSTEM, "", "libsodium cannot be used on this machine");
    store *s = create(options);
    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "out of memory");
    bf_status status = set_paths(s, options->directory, err);
    if (status == BF_OK)
        status = store__take_directory(s, err);
    if (status == BF_OK)
        status = store__connect(s->path, STORE__READ_WRITE, &s->writer, err);
    if (status == BF_OK)
        status = store__migrate(&s->writer, s->path, err);
    if (status == BF_OK)
        status = recover(&s->writer, options, err);
    if (status == BF_OK)
        status = store__count(s, &s->tally.figures, err);
    if (status == BF_OK)
        status = store__start_threads(s, err);
    if (status == BF_OK)
        *ret_store = s;
    else
        store_close(s);
    return status;
}

store *store_close(store *s)
{
    if (s == NULL)
        return NULL;
    store__stop_threads(s);
    // The last connection to close copies the log into the database.
    store__fini_pool(&s->pool);
    store__disconnect(&s->writer);
    if (s->lock_file >= 0)
        close(s->lock_file);
    lock_condition_fini(&s->done);
    lock_condition_fini(&s->writing.filled);
    lock_condition_fini(&s->preparing.filled);
    lock_fini(&s->lock);
    memory_free(s);
    return NULL;
}
