/// Private parts of the store.

#pragma once

#include "server/base/liveness.h"
#include "server/base/lock.h"
#include "server/store/chunks.h"
#include "server/store/columns.h"
#include "server/store/space.h"
#include "server/store/work.h"

#include <semaphore.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STORE__DIGEST_SIZE = 32, ///< bytes of a SHA-256, which stands for the bytes themselves
    STORE__LINE_SCENARIO_SIZE =
        2 * STORE__DIGEST_SIZE + 1, ///< bytes of one in hexadecimal digits with its terminator
    STORE__PATH_SIZE = 1024,        ///< bytes of a path with its terminator
};

/// Where a set of results is in its life. The values stand in the store: never renumber.
typedef enum store__results {
    STORE__RESULTS_OPEN,     ///< its run is not solved, and may never be
    STORE__RESULTS_COMPLETE, ///< its run succeeded: others may use it, too (I10)
    STORE__RESULTS_ORPHANED, ///< no run has it any more: it is being deleted
    STORE__RESULTS_SUSPECT,  ///< as complete, but not for further runs
} store__results;

typedef struct store__operation store__operation;
typedef struct store__key store__key; ///< of a submission under way; see idempotency.h
/// Do a write on the store's thread in a transaction that is open; not BF_OK undoes what it wrote.
typedef bf_status store__apply(store__connection *writer, store__operation *operation,
                               bf_error *err);

/// What comes before apply, on the preparing thread; if it fails, the operation is not applied.
typedef bf_status store__prepare(store__operation *operation, bf_error *err);

/// Report the result of an operation without a waiting caller, and free it. Runs on the store's thread
/// after the commit, or on the preparing thread if it could not be prepared.
typedef void store__finish(store__operation *operation);

/// A write that waits for its turn; on its caller's stack, or, with finish, on the heap.
struct store__operation {
    store__apply *apply;       ///< what to do
    store__prepare *prepare;   ///< what to do before; NULL: nothing
    store__finish *finish;     ///< how it ends; NULL: its caller waits
    void *context;             ///< for these
    bool may_use_reserve;      ///< it frees or ends something
    bool asks_stop;            ///< set by apply: it asks for a run to be stopped
    char changed[API_ID_SIZE]; ///< set by apply: the run that it changed; "" none
    bf_status status;          ///< result, once it is done
    bf_error error;            ///< of a status that is not BF_OK
    sem_t *done;               ///< of a caller that waits: posted when it is done
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

/// What a write test found; under the store's lock.
typedef struct store__write_test {
    int64_t until_ms; ///< monotonic; until then it counts
    bf_status status; ///< of the test
    bf_error error;   ///< of a status that is not BF_OK
} store__write_test;

/// store_quotas, whose members may change at any time.
typedef struct store__quota_settings {
    _Atomic uint64_t n_waiting;      ///< see there
    _Atomic uint64_t cpu_s;          ///< see there
    _Atomic uint64_t n_bytes;        ///< see there
    _Atomic uint64_t n_measurements; ///< see there
    _Atomic uint64_t n_studies;      ///< see there
} store__quota_settings;

/// An open store.
struct store {
    char directory[STORE__PATH_SIZE]; ///< of the data
    char path[STORE__PATH_SIZE];      ///< of the database
    _Atomic size_t queue_limit;       ///< see store_options
    _Atomic size_t client_quota;      ///< see store_options
    store__quota_settings quotas;     ///< see store_options
    int64_t idempotency_ms;           ///< see store_options
    uint64_t attempts_max;            ///< see store_options
    _Atomic uint64_t n_stop_requests; ///< see store_count_stop_requests()
    store_listener *listener;         ///< NULL: none
    void *listener_context;           ///< given to it
    int lock_file;                    ///< descriptor that holds the flock; -1: none
    store__connection writer;         ///< the store's thread's, once that runs
    store__pool pool;                 ///< readers
    lock lock;                        ///< guards what follows
    store__queue preparing;           ///< operations that are prepared, one after the other
    store__queue writing;             ///< operations that are applied, by the store's thread
    store__key *keys;                 ///< of the submissions under way
    store_retention retention;        ///< see store_options
    store__retention_turn turn;       ///< the store's thread's
    store__space space;               ///< the store's thread's
    store_stats stats;                ///< as counted last
    bool has_new_stats;               ///< something has changed since then
    int64_t count_at_ms;              ///< monotonic; they are not counted again before
    liveness liveness;                ///< of the store's thread
    store__write_test ready;          ///< the last one
};

/// A run's row.
typedef struct store__row {
    int64_t rowid;            ///< column number: key of all other tables
    api_run run;              ///< what others see of it
    double wall_s;            ///< solving time of all attempts, s
    uint64_t checkpoint_step; ///< 0 if there is none
    int64_t results; ///< key of samples, snapshots and chunks, which other runs may have, too
    char client[API_CLIENT_SIZE]; ///< who submitted it; "": no quota counts it
    double cpu_s;                 ///< CPU time of all attempts that was charged, s
    uint64_t n_bytes;             ///< of its scenario and its events, which no other run has
    uint64_t attempts;       ///< that were begun since the run last went on, and not handed back
    uint64_t hand_backs;     ///< since the run last went on, of those who gave it back unsolved
    store_stop stop_request; ///< of a running run
    char external_id[STORE_EXTERNAL_ID_SIZE];      ///< of a running run; "": none
    char line_scenario[STORE__LINE_SCENARIO_SIZE]; ///< digest of its scenario; "": no line
} store__row;

/// Start the preparing thread and the store's thread.
BF_MUST_CHECK bf_status store__start_threads(store *s, bf_error *err);

/// Let the threads finish what waits, and join them.
void store__stop_threads(store *s);

/// Let the store's thread do an operation and wait until it is on disk.
BF_MUST_CHECK bf_status store__write(store *s, store__apply *apply, void *context, bf_error *err);

/// The same for what frees or ends something: on a full disk it is done once more with the reserve.
BF_MUST_CHECK bf_status store__write_freeing(store *s, store__apply *apply, void *context,
                                             bf_error *err);

/// Let the store's thread do n operations in one commit, each alone, and wait until they are on disk. Their statuses say
/// what became of them.
void store__write_group(store *s, store__operation *operations, size_t n);

/// Let the store's threads prepare, do and finish an operation, without waiting for it. Operations that are
/// begun one after the other are applied in that order.
void store__begin_write(store *s, store__operation *operation);

/// A store__row, selected as STORE__RUN_COLUMNS. BF_ECORRUPT: no run can be like this.
extern const store__record store__run_record;

/// Find a run by its id. BF_ENOTFOUND. With an error *row is not defined.
BF_MUST_CHECK bf_status store__find_row(store__connection *c, const char *id, store__row *row,
                                        bf_error *err);

/// Write a changed run back, with a new revision; its state is for store__transition().
BF_MUST_CHECK bf_status store__save_row(store__connection *writer, store__row *row, bf_error *err);

/// Insert a run; row->rowid follows. What is not known before it runs is for store__emit_events().
BF_MUST_CHECK bf_status store__insert_row(store__connection *writer, store__row *row,
                                          bf_error *err);

/// Insert an event of a run; last_event follows. item: index of the snapshot or of the first sample.
BF_MUST_CHECK bf_status store__insert_event(store__connection *writer, store__row *row,
                                            api_event_type type, uint64_t item,
                                            const bf_buffer *data, bf_error *err);

/// Insert the status event of a run as it is, and the end event if it has ended, and save the row.
BF_MUST_CHECK bf_status store__emit_events(store__connection *writer, store__row *row,
                                           bf_error *err);

/// Move a run to another state, emit its events and save the row; an end drops the checkpoint (I3, I7).
/// BF_ECONFLICT: the state may not follow.
BF_MUST_CHECK bf_status store__transition(store__connection *writer, store__row *row, run_state to,
                                          bf_error *err);

/// Insert an empty set of results for a run that will be solved; row->results follows. digest NULL:
/// no other run will use it.
BF_MUST_CHECK bf_status store__insert_results(store__connection *writer,
                                              const unsigned char *digest, store__row *row,
                                              bf_error *err);

/// Move a set of results on in its life.
BF_MUST_CHECK bf_status store__mark_results(store__connection *writer, int64_t results,
                                            store__results state, bf_error *err);

/// One step of marking the runs whose results are suspect. ret_run is the run that was marked, or ""; *ret_has_more: the
/// next step may have something to do.
BF_MUST_CHECK bf_status store__mark_suspect(store__connection *writer, char ret_run[API_ID_SIZE],
                                            bool *ret_has_more, bf_error *err);

/// A worker with this token (0: none has one, or the service itself) sends results of a run that is running.
BF_MUST_CHECK bf_status store__note_sender(store__connection *writer, const store__row *row,
                                           uint64_t token, bf_error *err);

/// What was begun by another version of the solver and is not complete is not for other runs.
BF_MUST_CHECK bf_status store__invalidate_results(store__connection *writer, bf_error *err);

/// Find a run with complete results of this digest and of this solver. Without one *row is not defined.
BF_MUST_CHECK bf_status store__find_solved(store__connection *c,
                                           const unsigned char digest[STORE__DIGEST_SIZE],
                                           store__row *row, bool *ret_is_solved, bf_error *err);

/// Insert *row as a run that has succeeded with the results of *solved, all its texts and events
/// included, and save it.
BF_MUST_CHECK bf_status store__reuse_results(store__connection *writer, const store__row *solved,
                                             const bf_buffer *scenario, const bf_buffer *summary,
                                             store__row *row, bf_error *err);

/// Delete one step of results that no run has. *ret_is_over: nothing is left; else they are marked orphaned.
BF_MUST_CHECK bf_status store__collect_results(store__connection *writer, int64_t results,
                                               bool *ret_is_over, bf_error *err);

/// Remove a run, and one step of its results; see store__collect_results().
BF_MUST_CHECK bf_status store__remove_row(store__connection *writer, const store__row *row,
                                          bool *ret_is_over, bf_error *err);

/// Store what an item has of a snapshot, unless that is stored already; grid and parts are its arrays, compressed. The row
/// counts a snapshot that is complete; *n_bytes rises by what the caller is to add to the bytes of the results.
/// BF_ECORRUPT: a gap, or another size.
BF_MUST_CHECK bf_status store__append_snapshot(store__connection *writer, store__row *row,
                                               const store_item *item, const bf_buffer *grid,
                                               const bf_buffer *parts, size_t *n_bytes,
                                               bf_error *err);

/// Bytes of a snapshot's density, or of its parts where the run has a fixed number. UINT64_MAX: more than there can be.
uint64_t store__array_bytes(const api_run *record, store__blob kind);

/// BF_ECONFLICT: the run is not running.
BF_MUST_CHECK bf_status store__check_running(const store__row *row, bf_error *err);

/// Find a run and one of its snapshots that has a blob of this kind. BF_ENOTFOUND. With an error *row is not defined.
BF_MUST_CHECK bf_status store__find_array(store__connection *reader, const char *id,
                                          store__blob kind, uint64_t index, store__row *row,
                                          api_snapshot *ret_snapshot, bf_error *err);

/// Find a snapshot's row. BF_ENOTFOUND.
BF_MUST_CHECK bf_status store__find_snapshot(store__connection *reader, int64_t results,
                                             uint64_t index, api_snapshot *ret_snapshot,
                                             bf_error *err);

/// Count the runs by the writer's connection, and look at the files.
BF_MUST_CHECK bf_status store__count_stats(store *s, store_stats *ret_stats, bf_error *err);
