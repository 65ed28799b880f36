/// Private parts of the store.

#pragma once

#include "server/base/lock.h"
#include "server/store/connection_priv.h"
#include "server/store/figures_priv.h"
#include "server/store/work.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STORE__READERS_MAX = 8,          ///< connections that read at once
    STORE__DIGEST_SIZE = 32,         ///< bytes of a SHA-256, which stands for the bytes themselves
    STORE__PATH_SIZE = 1024,         ///< bytes of a path with its terminator
    STORE__CHUNK_BYTES = 256 * 1024, ///< of a blob that is stored in one row
    STORE__SWEEP_CHUNKS = 64,        ///< that are deleted in one transaction
    STORE__ANSWERS_MAX = 100000,     ///< answers that are kept for requests that come again
    STORE__ANSWERS_MS = 86400000,    ///< how long they are kept, unless asked for otherwise
    STORE__CARE_MS = 60000,          ///< between looks at what is to be removed
    STORE__READY_MS = 1000,          ///< how long a write test counts
    STORE__FREE_MIN = 64 * 1024 * 1024 ///< bytes that must be free on the disk to be ready
};

/// Kinds of texts. The values stand in the store: never renumber.
typedef enum store__text {
    STORE__TEXT_SCENARIO, ///< the resolved document
    STORE__TEXT_SUMMARY,  ///< summary.json
    STORE__TEXT_COLUMNS,  ///< of the curve
} store__text;

/// Kinds of chunked blobs. The values stand in the store: never renumber.
typedef enum store__blob {
    STORE__BLOB_SNAPSHOT,   ///< item: index of the snapshot
    STORE__BLOB_CHECKPOINT, ///< item: 0
    STORE__BLOB_PARTS,      ///< item: index of the snapshot that they belong to
} store__blob;

/// Where a set of results is in its life. The values stand in the store: never renumber.
typedef enum store__results {
    STORE__RESULTS_OPEN,      ///< its run is not solved, and may never be
    STORE__RESULTS_COMPLETE,  ///< its run succeeded: others may share it (I10)
    STORE__RESULTS_LEFT_OVER, ///< no run has it any more: it is being deleted
} store__results;

typedef struct store__operation store__operation;

/// Do a write inside a transaction that is open; not BF_OK undoes what it wrote. Runs on the
/// store's thread.
typedef bf_status store__apply(store__connection *writer, store__operation *operation,
                               bf_error *err);

/// What comes before apply, on the preparing thread; if it fails, the operation is not applied.
typedef bf_status store__prepare(store__operation *operation, bf_error *err);

/// Tell the result of an operation that nobody waits for, and free it. Runs on the store's thread after the
/// commit, or on the preparing thread if it could not be prepared.
typedef void store__finish(store__operation *operation);

/// A write that waits for its turn; on its caller's stack, or, with prepare and finish, on the heap.
struct store__operation {
    store__apply *apply;       ///< what to do
    store__prepare *prepare;   ///< what to do before; NULL: nothing
    store__finish *finish;     ///< how it ends; NULL: its caller waits for is_done
    void *context;             ///< for these
    char changed[API_ID_SIZE]; ///< set by apply: the run that it changed; "" none
    bf_status status;          ///< result, once it is done
    bf_error error;            ///< of a status that is not BF_OK
    bool is_done;              ///< written under the store's lock
    store__operation *next;    ///< in a queue
};

/// Operations that wait for a thread, and that thread; under the store's lock.
typedef struct store__queue {
    pthread_t thread;        ///< that takes them
    bool has_thread;         ///< it runs
    bool is_stopping;        ///< no further operations
    lock_condition filled;   ///< there are operations, or is_stopping
    store__operation *first; ///< that waits
    store__operation *last;  ///< NULL if there are none
} store__queue;

/// What the store's thread does by itself.
typedef struct store__care {
    int64_t every_ms;    ///< between two turns
    int64_t next_ms;     ///< monotonic; nothing is done before
    bool has_complained; ///< of a limit that cannot be kept
} store__care;

/// The connections that read.
typedef struct store__pool {
    lock lock;                                     ///< guards is_taken
    lock_condition given;                          ///< one was given back
    bool is_taken[STORE__READERS_MAX];             ///< by a thread, which then owns the connection
    store__connection readers[STORE__READERS_MAX]; ///< opened when first taken
} store__pool;

/// An open store.
struct store {
    char directory[STORE__PATH_SIZE]; ///< of the data
    char path[STORE__PATH_SIZE];      ///< of the database
    _Atomic size_t queue_limit;       ///< see store_options
    _Atomic size_t client_quota;      ///< see store_options
    int64_t answers_ms;               ///< see store_options
    store_listener *listener;         ///< NULL: none
    void *listener_context;           ///< given to it
    int lock_file;                    ///< descriptor that holds the flock; -1: none
    store__connection writer;         ///< the store's thread's, once that runs
    store__pool pool;                 ///< readers
    lock lock;                        ///< guards what follows
    store__queue preparing;           ///< operations that are prepared, one after the other
    store__queue writing;             ///< operations that are applied, by the store's thread
    lock_condition done;              ///< operations are done
    struct store__key *keys;          ///< of the submissions under way
    store_retention retention;        ///< see store_options
    store__care care;                 ///< the store's thread's
    store__tally tally;               ///< figures, and the thread's pulse
    store__verdict ready;             ///< of the last write test
};

/// A run's row.
typedef struct store__row {
    int64_t number;           ///< key of all other tables
    api_run run;              ///< what others see of it
    double wall_s;            ///< solving time of all attempts, s
    uint64_t checkpoint_step; ///< 0 if there is none
    bf_grid grid;             ///< of the snapshots; n1 = 0: not known yet
    api_parts parts;          ///< of the snapshots; n_values = 0: none
    int64_t results;          ///< key of samples, snapshots and chunks, which other runs may share
    char client[API_CLIENT_SIZE];             ///< who submitted it; "": no quota counts it
    char parent[API_ID_SIZE];                 ///< the run that it was made for; "": none
    store_stop stop_request;                  ///< of a running run
    char external_id[STORE_EXTERNAL_ID_SIZE]; ///< of a running run; "": none
} store__row;

/// Make the directory, hold its lock file, create the database file if it is missing. BF_ESYSTEM:
/// no access, or another daemon holds it.
BF_MUST_CHECK bf_status store__take_directory(store *s, bf_error *err);

/// Bytes that the disk of the directory has left for us.
BF_MUST_CHECK bf_status store__free_bytes(const store *s, uint64_t *ret_bytes, bf_error *err);

/// The texts that bring a store from version i to i + 1, and the version of this program.
extern const char *const store__migrations[];
extern const int store__version;

/// Check that the file is a store of ours, not newer than this program, or empty: *ret_version 0.
BF_MUST_CHECK bf_status store__identify(struct sqlite3 *db, const char *path, int *ret_version,
                                        bf_error *err);

/// Check that the file is a store of ours and bring its tables to this program's version.
BF_MUST_CHECK bf_status store__migrate(store__connection *writer, const char *path, bf_error *err);

/// Start the preparing thread and the store's thread.
BF_MUST_CHECK bf_status store__start_threads(store *s, bf_error *err);

/// Let the threads finish what waits, and join them.
void store__stop_threads(store *s);

/// Let the store's thread do an operation and wait until it is on disk.
BF_MUST_CHECK bf_status store__write(store *s, store__apply *apply, void *context, bf_error *err);

/// Let the store's threads prepare, do and finish an operation, without waiting for it. Operations that are
/// begun one after the other are applied in that order.
void store__begin_write(store *s, store__operation *operation);

/// Prepare an empty pool.
void store__init_pool(store__pool *pool);

/// Close all readers; none may be taken.
void store__fini_pool(store__pool *pool);

/// Take a reader with a transaction begun, waiting for one if need be. Give it back soon.
BF_MUST_CHECK bf_status store__take_reader(store *s, store__connection **ret_reader, bf_error *err);

/// End the transaction and give the reader back.
void store__give_reader(store *s, store__connection *reader);

/// Read the run of the present row, selected as STORE__RUN_COLUMNS.
void store__read_row(const store__query *q, store__row *ret_row);

/// Read the first run of a statement without parameters, selected as STORE__RUN_COLUMNS.
BF_MUST_CHECK bf_status store__find_first(store__connection *c, store__sql sql, store__row *ret_row,
                                          bool *ret_has_row, bf_error *err);

/// Find the running run with the least id beyond `after` ("": any).
BF_MUST_CHECK bf_status store__next_running(store__connection *c, const char *after,
                                            store__row *ret_row, bool *ret_has_row, bf_error *err);

/// Find a run by its id. BF_ENOTFOUND.
BF_MUST_CHECK bf_status store__find_row(store__connection *c, const char *id, store__row *ret_row,
                                        bf_error *err);

/// Write a changed run back, with a new revision.
BF_MUST_CHECK bf_status store__save_row(store__connection *writer, store__row *row, bf_error *err);

/// Insert a run; row->number follows. What is not known before it runs is for store__tell_row().
BF_MUST_CHECK bf_status store__insert_row(store__connection *writer, store__row *row,
                                          bf_error *err);

/// Insert an event of a run; row->run.last_event follows. item is the index of the snapshot or of the
/// curve's first sample.
BF_MUST_CHECK bf_status store__insert_event(store__connection *writer, store__row *row,
                                            api_event_type type, uint64_t item,
                                            const bf_buffer *data, bf_error *err);

/// Insert the status event of a run as it is, and the end event if it has ended, and save the row.
BF_MUST_CHECK bf_status store__tell_row(store__connection *writer, store__row *row, bf_error *err);

/// Move a run to another state, tell it and save the row; an end drops the checkpoint (I3, I7).
/// BF_ECONFLICT: the state may not follow.
BF_MUST_CHECK bf_status store__move_row(store__connection *writer, store__row *row, run_state to,
                                        bf_error *err);

/// Insert or replace a text of a run.
BF_MUST_CHECK bf_status store__put_text(store__connection *writer, int64_t number, store__text kind,
                                        const char *text, size_t n, bf_error *err);

/// Append a text of a run to *out. BF_ENOTFOUND: there is none.
BF_MUST_CHECK bf_status store__get_text(store__connection *c, int64_t number, store__text kind,
                                        bf_buffer *out, bf_error *err);

/// Append bytes, compressed, to *out.
BF_MUST_CHECK bf_status store__pack(const void *bytes, size_t n, bf_buffer *out, bf_error *err);

/// Append what was packed to *out. BF_ECORRUPT: damaged.
BF_MUST_CHECK bf_status store__unpack(const bf_buffer *packed, bf_buffer *out, bf_error *err);

/// Insert a packed blob in chunks.
BF_MUST_CHECK bf_status store__insert_chunks(store__connection *writer, int64_t results,
                                             store__blob kind, uint64_t item,
                                             const bf_buffer *packed, bf_error *err);

/// Append the chunks of a packed blob to *out; nothing if there is none.
BF_MUST_CHECK bf_status store__get_chunks(store__connection *c, int64_t results, store__blob kind,
                                          uint64_t item, bf_buffer *out, bf_error *err);

/// Delete a packed blob.
BF_MUST_CHECK bf_status store__delete_chunks(store__connection *writer, int64_t results,
                                             store__blob kind, uint64_t item, bf_error *err);

/// Find a snapshot's row. BF_ENOTFOUND.
BF_MUST_CHECK bf_status store__find_snapshot(store__connection *reader, int64_t results,
                                             uint64_t index, api_snapshot *ret_snapshot,
                                             bf_error *err);

/// Under the store's lock, which is given meanwhile: do one step of the store's own work, if it is time.
void store__take_care(store *s);
