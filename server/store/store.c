// Opening and closing, and the data directory. Where each invariant of store.h is held:
//
//   I1  connection.c: synchronous = FULL. thread.c: callers go on after the commit.
//   I2  connection.c opens; only store_open() asks for STORE__READ_WRITE. The lock file keeps other
//       processes out.
//   I3  row.c: store__transition() is the only function that changes a state.
//   I4  append.c: append_curve(), snapshots.c, and what they let pass. store__transition() deletes what is not whole.
//   I5  append.c: a checkpoint and what came before it are one transaction.
//   I6  schema.c: AUTOINCREMENT.
//   I7  append.c, events.c: events are inserted by the operation that they report.
//   I8  requeue_all() below.
//   I9  schema.c: tables refer to runs or results with ON DELETE CASCADE. store__remove_row() begins what
//       store__collect_results() ends; retention.c looks for results that are orphaned.
//   I10 results.c: only complete sets are found, and store__collect_results() spares what a run has.
//   I11 submit.c: one operation looks for the answer, makes the run and stores the answer.
//   I12 retention.c: OLDEST_ENDED chooses.
//   I13 measurements.c: one row each, with its samples, and no statement that updates it.
//   I14 claim.c writes stop requests and external ids; store__transition() heeds and clears them.
//   I15 page_sums.c, under every connection that connection.c opens; convert.c for databases of earlier versions.
//   I16 store__charge() in apply_append() and apply_finish(); the triggers of schema_10.

#include "server/store/store.h"

#include "server/store/convert.h"
#include "server/store/page_sums.h"
#include "server/store/store_priv.h"

#include "core/base/memory.h"
#include "server/base/file_io.h"
#include "server/base/log.h"
#include "server/base/metrics.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

// Where the options ask for nothing else.
enum {
    KEYS_MS = 86400000,   // how long idempotency keys are kept
    RETENTION_MS = 60000, // between two turns of retention
};

static bf_status fail_errno(const char *what, const char *path, bf_error *err)
{
    return bf_fail(err, BF_ESYSTEM, "", "%s %s: %s", what, path, strerror(errno));
}

static bf_status fail_held(const store *s, int file, bf_error *err)
{
    char text[32] = "";
    long holder; // the process that wrote its number there

    if (pread(file, text, sizeof text - 1, 0) <= 0 || sscanf(text, "%ld", &holder) != 1)
        return bf_fail(err, BF_ESYSTEM, "", "the data directory %s is in use by another daemon",
                       s->directory);
    return bf_fail(err, BF_ESYSTEM, "",
                   "the data directory %s is in use by another daemon, process %ld", s->directory,
                   holder);
}

static bf_status take_lock_file(store *s, bf_error *err)
{
    char path[STORE__PATH_SIZE + 16], holder[32];
    bf_status status = BF_OK;

    snprintf(path, sizeof path, "%s/beltflow.lock", s->directory);
    int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0)
        return fail_errno("cannot open the lock file", path, err);
    if (flock(file, LOCK_EX | LOCK_NB) != 0)
        status =
            errno == EWOULDBLOCK ? fail_held(s, file, err) : fail_errno("cannot lock", path, err);
    else
        store__make_room_to_open(s);
    // The holder is for operators only; the lock itself is authoritative.
    const int n = snprintf(holder, sizeof holder, "%ld\n", (long)getpid());
    if (status == BF_OK && (ftruncate(file, 0) != 0 || pwrite(file, holder, (size_t)n, 0) != n))
        status = fail_errno("cannot write", path, err);
    if (status != BF_OK)
        close(file);
    else
        s->lock_file = file;
    return status;
}

static off_t size_of(const char *path, const char *ending)
{
    char whole[STORE__PATH_SIZE + 8];
    struct stat info;

    (void)snprintf(whole, sizeof whole, "%s%s", path, ending);
    return stat(whole, &info) == 0 ? info.st_size : 0;
}

// SQLite would delete a log whose database is empty. The first page of a database is on disk before its log is
// made, so a log without one has lost it.
static bf_status refuse_lone_log(const store *s, bf_error *err)
{
    if (size_of(s->path, "") > 0 || size_of(s->path, "-wal") == 0)
        return BF_OK;
    return bf_fail(
        err, BF_ESYSTEM, "",
        "%.200s is missing or empty, but its log is there: put the database back, or start with "
        "a backup or an empty directory",
        s->path);
}

// SQLite would create the file readable by others. Its own descriptors do not exist yet: closing
// one of ours later would drop their locks.
static bf_status create_database_file(const store *s, bf_error *err)
{
    int file = open(s->path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0)
        return errno == EEXIST ? BF_OK : fail_errno("cannot create", s->path, err);
    close(file);
    return BF_OK;
}

// A new name in a directory survives a power loss once the directory is synced.
static bf_status sync_directory(const char *path, bf_error *err)
{
    int directory = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0)
        return fail_errno("cannot open", path, err);
    bf_status status = fsync(directory) == 0 ? BF_OK : fail_errno("cannot sync", path, err);
    close(directory);
    return status;
}

static bf_status hold_directory(store *s, bf_error *err)
{
    if (!file_io_make_directories(s->directory, 0700, FILE_IO_NOW))
        return fail_errno("cannot make the data directory", s->directory, err);
    BF_TRY(take_lock_file(s, err));
    BF_TRY(refuse_lone_log(s, err));
    BF_TRY(create_database_file(s, err));
    return sync_directory(s->directory, err);
}

static bool still_runs(const store_options *options, const store__row *row)
{
    store_running running = { .stop_request = row->stop_request };

    if (options->still_runs == NULL)
        return false;
    memcpy(running.id, row->run.id, sizeof running.id);
    memcpy(running.external_id, row->external_id, sizeof running.external_id);
    return options->still_runs(options->still_runs_context, &running);
}

// The run may be what ended the daemon.
static bf_status fail_after_attempts(store__connection *writer, store__row *row, bf_error *err)
{
    (void)bf_fail(
        &row->run.error, BF_ELIMIT, "",
        "the daemon ended during %llu attempts at this run, one after the other, the limit "
        "(run_attempts)",
        (unsigned long long)row->attempts);
    log_event(LOG_LEVEL_WARN, "run_given_up", "run=%s attempts=%llu", row->run.id,
              (unsigned long long)row->attempts);
    return store__transition(writer, row, RUN_FAILED, err);
}

// What the daemon before was running and the executor does not have any more is queued again (I8).
static bf_status requeue_all(store__connection *writer, const store_options *options, int *ret_n,
                             bf_error *err)
{
    store__row row = { .rowid = 0 };
    bool has_row = true;
    bf_status status = BF_OK;
    int n = 0;

    while (status == BF_OK) {
        status = store__find(writer, STORE__SQL_NEXT_RUNNING, &store__run_record, &row, &has_row,
                             err, TEXT(row.run.id));
        if (status != BF_OK || !has_row)
            break;
        if (still_runs(options, &row))
            continue;
        const bool is_last = options->attempts_max > 0 && row.attempts >= options->attempts_max;
        status = is_last && row.stop_request == STORE_STOP_NONE
                     ? fail_after_attempts(writer, &row, err)
                     : store__transition(writer, &row, RUN_QUEUED, err);
        n += row.run.state == RUN_QUEUED;
    }
    *ret_n = n;
    return status;
}

static bf_status recover(store__connection *writer, const store_options *options, bf_error *err)
{
    int n = 0;

    BF_TRY(store__begin_transaction(writer, err));
    bf_status status = store__invalidate_results(writer, err);
    if (status == BF_OK)
        status = requeue_all(writer, options, &n, err);
    status = store__end_transaction(writer, status, err);
    if (status == BF_OK && n > 0)
        log_event(LOG_LEVEL_INFO, "runs_requeued", "runs=%d", n);
    return status;
}

static store *create(const store_options *options)
{
    store *s = memory_alloc(1, sizeof *s);
    if (s == NULL)
        return NULL;
    s->queue_limit = options->queue_limit;
    s->client_quota = options->client_quota;
    store_set_quotas(s, &options->quotas);
    s->idempotency_ms = options->idempotency_ms == 0 ? KEYS_MS : options->idempotency_ms;
    s->attempts_max = options->attempts_max;
    s->retention = options->retention;
    s->turn.every_ms =
        options->retention_interval_ms == 0 ? RETENTION_MS : options->retention_interval_ms;
    s->listener = options->listener;
    s->listener_context = options->listener_context;
    s->lock_file = -1;
    store__init_pool(&s->pool, s->path);
    lock_init(&s->lock);
    lock_condition_init(&s->preparing.filled);
    lock_condition_init(&s->writing.filled);
    return s;
}

bf_status store_open(const store_options *options, store **ret_store, bf_error *err)
{
    if (sodium_init() < 0)
        return bf_fail(err, BF_ESYSTEM, "", "libsodium cannot be used on this machine");
    // The longest of our file names and SQLite's "-journal" still fit.
    if (strlen(options->directory) + 32 > STORE__PATH_SIZE)
        return bf_fail(err, BF_ESYSTEM, "", "the data directory's path is too long");
    store *s = create(options);
    if (s == NULL)
        return bf_fail_memory(err);
    snprintf(s->directory, sizeof s->directory, "%s", options->directory);
    snprintf(s->path, sizeof s->path, "%.*s/beltflow.db", STORE__PATH_SIZE - 32,
             options->directory);
    bf_status status = hold_directory(s, err);
    if (status == BF_OK)
        status = store__convert(s, err);
    if (status == BF_OK)
        status = store__connect(s->path, STORE__READ_WRITE, &s->writer, err);
    if (status == BF_OK)
        status = store__migrate(&s->writer, s->path, err);
    if (status == BF_OK)
        status = recover(&s->writer, options, err);
    if (status == BF_OK)
        status = store__count_stats(s, &s->stats, err);
    if (status == BF_OK) {
        metrics_set(METRICS_STORE_SUMS, 0, store__has_page_sums(s->writer.db));
        store__take_reserve(s);
        status = store__start_threads(s, err);
    }
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
    lock_condition_fini(&s->writing.filled);
    lock_condition_fini(&s->preparing.filled);
    lock_fini(&s->lock);
    memory_free(s);
    return NULL;
}
