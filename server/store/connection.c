// Connections to the database and their statements; the one that writes, and at most STORE__READERS_MAX
// that read, opened when they are needed.
//
// Threads  the pool's lock guards who has which reader; a connection belongs to the thread that took it.
// Length   a read is one transaction, so that what it puts together is of one moment; it is short,
//          because the log cannot start again while someone reads an old state of it.

#include "server/store/connection.h"

#include "server/store/conditions.h"
#include "server/store/page_sums.h"

#include "core/base/check.h"
#include "server/base/clock.h"

#include <errno.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

enum {
    WAL_PAGES_PASSIVE = 1000,  // copied to the database without waiting for anyone
    WAL_PAGES_RESTART = 16384, // 64 MiB: wait for the readers, so that the log starts again
    RESTART_MS = 500,          // how long; our own are quicker, and a backup takes longer anyway
};

static const char *const statement_texts[STORE__SQL_COUNT] = {
#define X(name, text) [STORE__SQL_##name] = text,
    STORE__SQL_LIST(X)
#undef X
};

static const char *const settings[] = {
    // Debian's SQLite would overwrite with zeros what is deleted, which costs as much as writing it.
    [STORE__READ_WRITE] = "PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;"
                          "PRAGMA secure_delete = FAST; PRAGMA temp_store = MEMORY;"
                          "PRAGMA journal_size_limit = 16777216",
    [STORE__READ_ONLY] = "PRAGMA wal_autocheckpoint = 0; PRAGMA query_only = ON;"
                         "PRAGMA temp_store = MEMORY",
};

static const int open_flags[] = {
    [STORE__READ_WRITE] = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE,
    [STORE__READ_ONLY] = SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE,
};

// SQLite names a full disk where a file grows by a write, but not for its shared memory, nor a quota.
static bool is_full(struct sqlite3 *db, int code)
{
    int cause = db == NULL ? 0 : sqlite3_system_errno(db);

    return (code & 0xff) == SQLITE_FULL ||
           ((code & 0xff) == SQLITE_IOERR && (cause == EDQUOT || cause == ENOSPC));
}

// The operating system's error; SQLite does not always report it.
static const char *name_cause(struct sqlite3 *db)
{
    int cause = db == NULL ? 0 : sqlite3_system_errno(db);
    return cause == 0 ? "the system refused" : strerror(cause);
}

bf_status store__fail(struct sqlite3 *db, int code, bf_error *err)
{
    const char *text = db == NULL ? sqlite3_errstr(code) : sqlite3_errmsg(db);

    if (is_full(db, code))
        return bf_fail(err, BF_ENOSPACE, "", "the store cannot write: the disk is full (%s)", text);
    // A page whose sum does not fit is damage, too.
    switch (code == SQLITE_IOERR_DATA ? SQLITE_CORRUPT : code & 0xff) {
    case SQLITE_NOMEM:
        return bf_fail(err, BF_ENOMEM, "", "the store has no memory");
    case SQLITE_TOOBIG:
        return bf_fail(err, BF_ELIMIT, "", "%s", text);
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
        return bf_fail(err, BF_ESYSTEM, "",
                       "the store's file is damaged (%s): keep a copy of the data directory and "
                       "start with a backup or an empty one",
                       text);
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
        return bf_fail(err, BF_ESYSTEM, "", "the store's file failed: %s (%s)", text,
                       name_cause(db));
    default:
        return bf_fail(err, BF_ESYSTEM, "", "the store failed: %s", text);
    }
}

// The commit is done and must not fail any more, so what a checkpoint returns does not count: the
// next one tries again, and a full disk shows when the log cannot grow. While a backup reads, the log
// cannot start again; it is tried once for each 64 MiB that it grows by, not at every commit.
static int checkpoint_log(void *context, sqlite3 *db, const char *name, int n_pages)
{
    store__connection *writer = context;

    if (n_pages < WAL_PAGES_RESTART)
        writer->restart_pages = WAL_PAGES_RESTART;
    if (n_pages >= writer->restart_pages) {
        sqlite3_busy_timeout(db, RESTART_MS);
        sqlite3_wal_checkpoint_v2(db, name, SQLITE_CHECKPOINT_RESTART, NULL, NULL);
        sqlite3_busy_timeout(db, STORE__BUSY_MS);
        writer->restart_pages = n_pages + WAL_PAGES_RESTART;
    } else if (n_pages >= WAL_PAGES_PASSIVE) {
        sqlite3_wal_checkpoint_v2(db, name, SQLITE_CHECKPOINT_PASSIVE, NULL, NULL);
    }
    return SQLITE_OK;
}

bf_status store__connect(const char *path, store__access access, store__connection *ret_connection,
                         bf_error *err)
{
    sqlite3 *db = NULL;

    BF_TRY(store__register_page_sums(err));
    int code = sqlite3_open_v2(path, &db, open_flags[access], STORE__PAGE_SUMS);
    if (code == SQLITE_OK)
        code = sqlite3_busy_timeout(db, STORE__BUSY_MS);
    if (code == SQLITE_OK)
        code = sqlite3_exec(db, settings[access], NULL, NULL, NULL);
    if (code == SQLITE_OK)
        code = store__add_conditions(db);
    if (code != SQLITE_OK) {
        const bf_status status = store__fail(db, code, err);
        sqlite3_close(db);
        return status;
    }
    *ret_connection = (store__connection){ .db = db,
                                           .restart_pages = WAL_PAGES_RESTART,
                                           .queued_at_most = SIZE_MAX };
    if (access == STORE__READ_WRITE)
        sqlite3_wal_hook(db, checkpoint_log, ret_connection);
    return BF_OK;
}

void store__disconnect(store__connection *c)
{
    for (int i = 0; i < STORE__SQL_COUNT; i++)
        sqlite3_finalize(c->statements[i]);
    BF_CHECK(sqlite3_close(c->db) == SQLITE_OK);
    *c = (store__connection){ 0 };
}

static int bind(struct sqlite3_stmt *statement, int at, const store__value *value)
{
    // A NULL pointer would bind NULL, which is not the empty text or blob.
    const void *bytes = value->n == 0 ? "" : value->bytes;

    switch (value->kind) {
    case STORE__INTEGER:
        return sqlite3_bind_int64(statement, at, value->integer);
    case STORE__REAL:
        return isfinite(value->real) ? sqlite3_bind_double(statement, at, value->real)
                                     : sqlite3_bind_null(statement, at);
    case STORE__TEXT:
        return sqlite3_bind_text64(statement, at, bytes, value->n, SQLITE_STATIC, SQLITE_UTF8);
    case STORE__BLOB:
        return sqlite3_bind_blob64(statement, at, bytes, value->n, SQLITE_STATIC);
    }
    return SQLITE_MISUSE;
}

store__query store__start_with(store__connection *c, store__sql sql, const store__value *values,
                               size_t n)
{
    store__query q = { .connection = c };

    if (c->failure.code != BF_OK)
        q.code = SQLITE_ERROR;
    else if (c->statements[sql] == NULL)
        q.code = sqlite3_prepare_v3(c->db, statement_texts[sql], -1, SQLITE_PREPARE_PERSISTENT,
                                    &c->statements[sql], NULL);
    q.statement = c->statements[sql];
    for (size_t k = 0; k < n && q.code == SQLITE_OK; k++)
        q.code = bind(q.statement, (int)k + 1, &values[k]);
    return q;
}

bool store__next(store__query *q, bf_status *status, bf_error *err)
{
    if (*status == BF_OK && q->code == SQLITE_OK) {
        const int code = sqlite3_step(q->statement);
        if (code == SQLITE_ROW)
            return true;
        if (code != SQLITE_DONE)
            q->code = code;
    }
    const bf_error *failure = &q->connection->failure;
    if (*status == BF_OK && failure->code != BF_OK)
        *status = bf_fail(err, failure->code, "", "%s", failure->text);
    else if (*status == BF_OK && q->code != SQLITE_OK)
        *status = store__fail(q->connection->db, q->code, err);
    store__end(q);
    return false;
}

void store__end(store__query *q)
{
    if (q->statement == NULL)
        return;
    sqlite3_reset(q->statement);
    sqlite3_clear_bindings(q->statement);
    q->statement = NULL;
}

bf_status store__exec_with(store__connection *c, store__sql sql, bf_error *err,
                           const store__value *values, size_t n)
{
    store__query q = store__start_with(c, sql, values, n);
    bf_status status = BF_OK;

    (void)store__next(&q, &status, err);
    store__end(&q);
    return status;
}

bf_status store__run_plain(store__connection *c, store__sql sql, bf_error *err)
{
    return store__exec_with(c, sql, err, NULL, 0);
}

bf_status store__find_number_with(store__connection *c, store__sql sql, int64_t *ret_number,
                                  bf_error *err, const store__value *values, size_t n)
{
    bf_status status = BF_OK;

    store__query q = store__start_with(c, sql, values, n);
    if (store__next(&q, &status, err))
        *ret_number = sqlite3_column_int64(q.statement, 0);
    else if (status == BF_OK)
        *ret_number = 0;
    store__end(&q);
    return status;
}

bf_status store__read_number(store__connection *c, store__sql sql, int64_t *ret_number,
                             bf_error *err)
{
    return store__find_number_with(c, sql, ret_number, err, NULL, 0);
}

bf_status store__find_bytes_with(store__connection *c, store__sql sql, bf_buffer *out,
                                 bool *ret_has_row, bf_error *err, const store__value *values,
                                 size_t n)
{
    bf_status status = BF_OK;

    store__query q = store__start_with(c, sql, values, n);
    *ret_has_row = store__next(&q, &status, err);
    if (*ret_has_row)
        status = store__column_bytes(&q, 0, out, err);
    store__end(&q);
    return status;
}

double store__column_real(const store__query *q, int column)
{
    if (sqlite3_column_type(q->statement, column) == SQLITE_NULL)
        return NAN;
    return sqlite3_column_double(q->statement, column);
}

void store__column_text(const store__query *q, int column, char *ret_text, size_t size)
{
    const unsigned char *text = sqlite3_column_text(q->statement, column);
    snprintf(ret_text, size, "%s", text == NULL ? "" : (const char *)text);
}

bf_status store__column_bytes(const store__query *q, int column, bf_buffer *out, bf_error *err)
{
    const void *bytes = sqlite3_column_blob(q->statement, column);
    size_t n = (size_t)sqlite3_column_bytes(q->statement, column);

    // SQLite gives NULL for an empty value, and for one that it has no memory for.
    if (bytes == NULL && sqlite3_errcode(q->connection->db) == SQLITE_NOMEM)
        return store__fail(q->connection->db, SQLITE_NOMEM, err);
    if (buffer_append(out, bytes, bytes == NULL ? 0 : n) != BF_OK)
        return bf_fail_memory(err);
    return BF_OK;
}

bf_status store__begin_transaction(store__connection *c, bf_error *err)
{
    // The rollback of the one before may have failed, for want of memory.
    if (sqlite3_get_autocommit(c->db) == 0)
        BF_TRY(store__run_plain(c, STORE__SQL_ROLLBACK, err));
    return store__run_plain(c, STORE__SQL_BEGIN_WRITE, err);
}

bf_status store__end_transaction(store__connection *c, bf_status status, bf_error *err)
{
    if (status == BF_OK) {
        status = store__run_plain(c, STORE__SQL_COMMIT, err);
        atomic_fetch_add(&c->n_commits,
                         1); // also where it failed: nobody knows what is on the disk
    }
    // After some failures SQLite has already rolled the transaction back. A rollback that fails is made up for
    // when the next transaction begins.
    if (status != BF_OK && sqlite3_get_autocommit(c->db) == 0) {
        bf_status undone = store__run_plain(c, STORE__SQL_ROLLBACK, NULL);
        (void)undone;
    }
    return status;
}

void store__init_pool(store__pool *pool, const char *path)
{
    pool->path = path;
    (void)bf_fail(&pool->none.failure, BF_EBUSY, "", "all %d readers of the store are busy",
                  STORE__READERS_MAX);
    lock_init(&pool->lock);
    lock_condition_init(&pool->released);
}

void store__fini_pool(store__pool *pool)
{
    for (int i = 0; i < STORE__READERS_MAX; i++) {
        BF_CHECK(!pool->is_taken[i]);
        store__disconnect(&pool->readers[i]);
    }
    lock_condition_fini(&pool->released);
    lock_fini(&pool->lock);
}

// The first one that is free, so that few are opened where few are needed. -1: all are taken.
static int find_free(const store__pool *pool)
{
    lock_assert_held(&pool->lock);
    for (int i = 0; i < STORE__READERS_MAX; i++)
        if (!pool->is_taken[i])
            return i;
    return -1;
}

store__connection *store__acquire_reader(store__pool *pool)
{
    int64_t deadline_ms = clock_monotonic_ms() + STORE__READER_MS;
    bool is_time_left = true;
    bf_status status = BF_OK;
    bf_error why = { .code = BF_OK };
    int i = -1;

    lock_acquire(&pool->lock);
    while ((i = find_free(pool)) < 0 && is_time_left)
        is_time_left = lock_wait(&pool->released, &pool->lock, deadline_ms);
    if (i >= 0)
        pool->is_taken[i] = true;
    lock_release(&pool->lock);
    if (i < 0)
        return &pool->none;
    store__connection *reader = &pool->readers[i];
    if (reader->db == NULL)
        status = store__connect(pool->path, STORE__READ_ONLY, reader, &why);
    if (status == BF_OK)
        status = store__run_plain(reader, STORE__SQL_BEGIN_READ, &why);
    if (status != BF_OK)
        reader->failure = why;
    return reader;
}

void store__release_reader(store__pool *pool, store__connection *reader)
{
    if (reader == &pool->none)
        return;
    // A reader that cannot end its transaction would never let the log start again: open another next time.
    if (reader->failure.code == BF_OK &&
        store__run_plain(reader, STORE__SQL_COMMIT, NULL) != BF_OK &&
        sqlite3_get_autocommit(reader->db) == 0)
        store__disconnect(reader);
    reader->failure.code = BF_OK;
    lock_acquire(&pool->lock);
    BF_CHECK(pool->is_taken[reader - pool->readers]);
    pool->is_taken[reader - pool->readers] = false;
    lock_wake_all(&pool->released);
    lock_release(&pool->lock);
}
