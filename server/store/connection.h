/// Inside the store: the database, that is its schema, connections to it and the use of their statements.
/// Knows nothing of runs.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"
#include "server/base/lock.h"
#include "server/store/sql.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STORE__BUSY_MS = 5000,   ///< how long SQLite waits for a lock of its own
    STORE__READERS_MAX = 8,  ///< connections that read at once
    STORE__READER_MS = 5000, ///< longest time that a thread waits for one of them
};

struct sqlite3;
struct sqlite3_stmt;

/// The statements of sql.h.
typedef enum store__sql {
#define X(name, text) STORE__SQL_##name,
    STORE__SQL_LIST(X)
#undef X
        STORE__SQL_COUNT
} store__sql;

/// A connection with its prepared statements. Zero-initialise.
typedef struct store__connection {
    struct sqlite3 *db;                                ///< NULL: not open
    struct sqlite3_stmt *statements[STORE__SQL_COUNT]; ///< NULL: not prepared yet
    bf_error failure;      ///< code BF_OK: none; else what every use of a statement fails with
    int restart_pages;     ///< writer: pages of the log with which it is started again
    size_t queued_at_most; ///< writer: not more runs than these wait; SIZE_MAX: not counted yet
    _Atomic uint64_t n_commits; ///< writer: transactions ended by a commit, also one that failed
} store__connection;

/// What a connection may do.
typedef enum store__access {
    STORE__READ_WRITE, ///< the writer's; of the store there is one (I2)
    STORE__READ_ONLY,  ///< a reader's
} store__access;

/// A use of a statement. A failure is remembered: further calls do nothing and store__next() tells it.
typedef struct store__query {
    store__connection *connection;  ///< whose statement it is
    struct sqlite3_stmt *statement; ///< NULL: could not be prepared
    int code;                       ///< SQLite's first failure
} store__query;

/// Open the database at path. The caller closes *ret_connection by store__disconnect(), and does not
/// move it.
BF_MUST_CHECK bf_status store__connect(const char *path, store__access access,
                                       store__connection *ret_connection, bf_error *err);

/// Finalise the statements and close. A connection that is not open is fine.
void store__disconnect(store__connection *c);

/// Turn a result code of SQLite into an error, with SQLite's own text where there is one.
bf_status store__fail(struct sqlite3 *db, int code, bf_error *err);

/// A parameter of a statement, made by the macros below.
typedef struct store__value {
    enum { STORE__INTEGER, STORE__REAL, STORE__TEXT, STORE__BLOB } kind; ///< which members count
    int64_t integer;                                                     ///< of STORE__INTEGER
    double real;       ///< of STORE__REAL; not finite: NULL
    const void *bytes; ///< of text and blob; the caller's until store__end()
    size_t n;          ///< bytes
} store__value;

#define INTEGER(value)                                                                             \
    {                                                                                              \
        .kind = STORE__INTEGER, .integer = (int64_t)(value)                                        \
    }
#define REAL(value)                                                                                \
    {                                                                                              \
        .kind = STORE__REAL, .real = (value)                                                       \
    }
#define TEXT(text)                                                                                 \
    {                                                                                              \
        .kind = STORE__TEXT, .bytes = (text), .n = strlen(text)                                    \
    }
#define TEXT_OF(bytes_, n_)                                                                        \
    {                                                                                              \
        .kind = STORE__TEXT, .bytes = (bytes_), .n = (n_)                                          \
    }
#define BLOB(bytes_, n_)                                                                           \
    {                                                                                              \
        .kind = STORE__BLOB, .bytes = (bytes_), .n = (n_)                                          \
    }

/// An array of the values, and how many they are.
#define STORE__VALUES(...)                                                                         \
    (const store__value[]){ __VA_ARGS__ },                                                         \
        sizeof((const store__value[]){ __VA_ARGS__ }) / sizeof(store__value)

/// Begin to use a statement with values for its parameters: store__start(c, sql, INTEGER(number), TEXT(id)). End with
/// store__end(), whatever happens between. n = 0: it has no parameters.
#define store__start(c, sql, ...) store__start_with(c, sql, STORE__VALUES(__VA_ARGS__))
store__query store__start_with(store__connection *c, store__sql sql, const store__value *values,
                               size_t n);

/// Step to the next row, if *status is BF_OK. False: there is none, or *status is a failure; the statement is ended.
bool store__next(store__query *q, bf_status *status, bf_error *err);

/// Done with the statement for now, where rows may be left. Done twice is fine.
void store__end(store__query *q);

/// Run a statement without rows, with values for its parameters: store__exec(c, sql, err, INTEGER(number)).
#define store__exec(c, sql, err, ...) store__exec_with(c, sql, err, STORE__VALUES(__VA_ARGS__))
BF_MUST_CHECK bf_status store__exec_with(store__connection *c, store__sql sql, bf_error *err,
                                         const store__value *values, size_t n);

/// Run a statement that has neither parameters nor rows.
BF_MUST_CHECK bf_status store__run_plain(store__connection *c, store__sql sql, bf_error *err);

/// The number in the first row of a statement; 0: no row. That without parameters is store__read_number().
#define store__find_number(c, sql, ret_number, err, ...)                                           \
    store__find_number_with(c, sql, ret_number, err, STORE__VALUES(__VA_ARGS__))
BF_MUST_CHECK bf_status store__find_number_with(store__connection *c, store__sql sql,
                                                int64_t *ret_number, bf_error *err,
                                                const store__value *values, size_t n);
BF_MUST_CHECK bf_status store__read_number(store__connection *c, store__sql sql,
                                           int64_t *ret_number, bf_error *err);

/// Append the text or blob in the first row of a statement. *ret_has_row: there is one.
#define store__find_bytes(c, sql, out, ret_has_row, err, ...)                                      \
    store__find_bytes_with(c, sql, out, ret_has_row, err, STORE__VALUES(__VA_ARGS__))
BF_MUST_CHECK bf_status store__find_bytes_with(store__connection *c, store__sql sql, bf_buffer *out,
                                               bool *ret_has_row, bf_error *err,
                                               const store__value *values, size_t n);

/// A column of the present row; a NULL is NAN.
double store__column_real(const store__query *q, int column);
/// Copy a text column of the present row; NULL is "", too long a text is cut.
void store__column_text(const store__query *q, int column, char *ret_text, size_t size);

/// Append a text or blob column of the present row.
BF_MUST_CHECK bf_status store__column_bytes(const store__query *q, int column, bf_buffer *out,
                                            bf_error *err);

/// Begin a transaction of the writer.
BF_MUST_CHECK bf_status store__begin_transaction(store__connection *c, bf_error *err);

/// End the open transaction: commit if status is BF_OK, else, or if that fails, undo it all.
/// Returns status, or the failure of the commit.
BF_MUST_CHECK bf_status store__end_transaction(store__connection *c, bf_status status,
                                               bf_error *err);

/// The connections that read.
typedef struct store__pool {
    const char *path;                              ///< of the database; borrowed
    lock lock;                                     ///< guards is_taken
    lock_condition released;                       ///< a reader was released
    bool is_taken[STORE__READERS_MAX];             ///< by a thread, which then owns the connection
    store__connection readers[STORE__READERS_MAX]; ///< opened when first taken
    store__connection none;                        ///< what those get who have waited too long
} store__pool;

/// Prepare a pool without readers for the database at path, which must stay.
void store__init_pool(store__pool *pool, const char *path);

/// Close all readers; all must have been released.
void store__fini_pool(store__pool *pool);

/// Get a reader with a transaction begun, waiting for one if need be. Release it soon. Where that fails, what is returned
/// fails with the reason at every use, BF_EBUSY: none was released for STORE__READER_MS.
store__connection *store__acquire_reader(store__pool *pool);

/// End the transaction and let others have the reader.
void store__release_reader(store__pool *pool, store__connection *reader);

/// The texts that bring a store from version i to i + 1, and the version of this program.
extern const char *const store__migrations[];
extern const int store__version;

/// Check that the file is a store of ours, not newer than this program, or empty: *ret_version 0.
BF_MUST_CHECK bf_status store__identify(struct sqlite3 *db, const char *path, int *ret_version,
                                        bf_error *err);

/// Check that the file is a store of ours and bring its tables to this program's version.
BF_MUST_CHECK bf_status store__migrate(store__connection *writer, const char *path, bf_error *err);
