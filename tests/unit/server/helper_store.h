/// Stores in temporary directories, and runs whose content follows from their indices, for tests.

#pragma once

#include "server/base/lock.h"
#include "server/store/work.h"
#include "tests/unit/helper_cmocka.h"

#include <stdbool.h>

enum {
    HELPER_COLUMNS = 2, ///< columns of helper_submission()'s curve: "upstream,left_domain"
    HELPER_N1 = 300,    ///< cells along the belt of helper_grid()
    HELPER_N2 = 400,    ///< cells across: 480 kB of noise, which do not fit one chunk
};

/// A test's own store.
typedef struct helper_store {
    char directory[64]; ///< its data directory, removed at the end
    store *store;       ///< open; NULL: closed
} helper_store;

/// Open a store in a new directory; close and remove it. Fixtures of cmocka.
int helper_store_setup(void **state);
int helper_store_teardown(void **state);

/// Remove a directory of files.
void helper_store_remove_directory(const char *path);

/// Open the store again after the test closed it, or for the first time.
void helper_store_open(helper_store *h);
void helper_store_close(helper_store *h);

/// Verify a store's file, or that of a test's store: it breaks no invariant.
void helper_store_verify_file(const char *path);
void helper_store_verify(const helper_store *h);

/// Run SQL on the file while the store is closed (or reading while it is open): the first column of
/// the first row as an integer, -1 if there is no row.
int64_t helper_store_sql(const helper_store *h, const char *sql);

/// Wait until the SQL has the expected result; fails the test after a while.
void helper_await_sql(const helper_store *h, const char *sql, int64_t wanted);

/// Submit it and return the new run.
api_run helper_accept(store *s, const api_submission *submission);

/// Submit a run and return it. label and priority as given, everything else fixed.
api_run helper_submit(store *s, const char *label, int priority);

/// Submit a run of a whole scenario, 16 cylinders on a belt for 1 s, and return it.
api_run helper_submit_solvable(store *s);

/// Claim the next run and return it.
api_run helper_claim(store *s);

/// Submit a run and claim it, alone in the queue.
api_run helper_start(store *s);

/// The run as it is now.
api_run helper_find(store *s, const char *id);

/// Fill an item with samples first .. first + n - 1: t is index / 100, column c is
/// index + 1000 c. Free with helper_item_fini().
void helper_curve_item(const char *id, uint64_t first, size_t n, store_item *item);

/// Fill an item with snapshot `index` of helper_grid(): noise that follows from the index.
void helper_snapshot_item(const char *id, uint64_t index, store_item *item);

/// Fill an item with a progress event.
void helper_progress_item(const char *id, uint64_t step, store_item *item);

/// Fill an item with key figures.
void helper_figures_item(const char *id, int throughput, store_item *item);

/// Free what an item owns.
void helper_item_fini(store_item *item);

/// The grid of all snapshots here.
bf_grid helper_grid(void);

/// True if rho is what helper_snapshot_item() made for this index.
bool helper_snapshot_is(const bf_buffer *rho, uint64_t index);

/// True if the curve holds exactly samples first .. first + n - 1 of helper_curve_item().
bool helper_curve_is(const api_curve *curve, uint64_t first, size_t n);

/// Store a batch and wait until it is on disk or refused.
bf_status helper_store_append(store *s, const store_batch *batch, bf_error *err);

/// Store one item and free it.
bf_status helper_append(store *s, const char *id, store_item *item, bf_error *err);

/// Samples and snapshots of a running run, as helper_curve_item() and helper_snapshot_item() make
/// them.
void helper_append_samples(store *s, const char *id, uint64_t first, size_t n);
void helper_append_snapshot(store *s, const char *id, uint64_t index);

/// Finish a running run.
api_run helper_finish(store *s, const char *id, run_state state);

/// How many events a run has, and its newest one's type and id.
typedef struct helper_events {
    size_t n;            ///< events
    api_event_type type; ///< of the newest
    uint64_t id;         ///< of the newest
    bf_buffer data;      ///< of the newest; the caller's
} helper_events;

/// Read all events of a run behind `after`. Free data with buffer_fini().
helper_events helper_read_events(store *s, const char *id, uint64_t after);

/// The calls of a listener. Begin with lock_init(), end with lock_fini().
typedef struct helper_heard {
    lock lock;            ///< guards what follows
    size_t n;             ///< calls
    char id[API_ID_SIZE]; ///< of the last one
} helper_heard;

/// The value of a metric without labels, as the text form has it.
double helper_read_metric(const char *name);

/// A store_listener whose context is a helper_heard.
void helper_hear(void *context, const char *run_id);
