/// The store: every run, its scenario, curve, snapshots, events and checkpoint, and measurements,
/// in one SQLite file. The supervisor's functions are in work.h.
///
/// Invariants (cited by the tests as I1 ...):
///   I1  What a write function returned BF_OK for is on disk and survives kill -9 and power loss.
///   I2  There is one read-write connection in the whole system; the store's thread owns it, and it
///       alone checkpoints the WAL. Readers are read-only and hold no statement between calls.
///   I3  Every run is in exactly one state of run_state.h, and changes only along its arrows.
///   I4  Samples are stored without gap from 0; snapshots, each whole and with its parts, without gap from 0. Of a
///       snapshot that has not come whole there are chunks, and only while its run is running.
///       Storing one again (a run resumed before it) changes nothing and makes no second event. The same holds
///       for changes of photo eyes and actions, which are events alone.
///   I5  A stored checkpoint never lies beyond the stored samples and snapshots.
///   I6  Event ids rise strictly over the store's life, also after runs were removed.
///   I7  An event becomes visible in the same transaction as what it reports.
///   I8  After store_open() only those runs are `running` that the executor still has; the others of the
///       daemon before are queued again, or have failed after attempts_max of them.
///   I9  A removed run leaves no row behind. Results that several runs have go with the last of them,
///       large ones step by step: what a crash leaves of them is deleted after the next start.
///   I10 Samples, snapshots and their grids belong to sets of results. Each run has one set; a set that
///       several runs have is that of a run that succeeded, and never changes again. No run joins one that is suspect.
///   I11 The answer to an idempotency key is stored with the run that it describes, in one transaction;
///       while it is stored, the key makes no second run.
///   I12 What retention removes has ended: for its age the run that ended first, else one of the owner who has most.
///   I13 A measurement is there with all its samples or text or not at all, never changes, and lives until
///       it is removed itself. There are at most API_MEASUREMENTS_MAX.
///   I14 A stop request is on disk before its requester is answered, and goes with the run's end. A run with
///       one is never queued again: it is cancelled instead. Only running runs have stop requests and
///       external ids.
///   I15 Bytes of the database file that have changed on the disk are never served: what is read of a page whose
///       checksum does not fit is BF_ESYSTEM. (Not in databases that versions before this made.)
///   I16 What an owner uses of CPU time and bytes is written in the transaction of the batch, the end or the removal
///       that changes it; nothing that was charged is charged again.
///   I17 The trials of a study are numbered from 0 without gaps, and those that have ended from 1; each ends once, with
///       its values, and one that has not ended keeps its run. The counts of a study are those of its trials.
///
/// Threads  all functions may be called from any thread. Writes are handed to the store's thread,
///          which commits what waits in one synced transaction (group commit), and return after it.
/// Errors   BF_ENOTFOUND, BF_ECONFLICT where named; BF_ESYSTEM with SQLite's text; BF_ENOSPACE; BF_ENOMEM.
/// Room     new runs and measurements are refused (BF_ENOSPACE) before the disk is full; what removes, cancels or
///          ends something may use a reserve that is kept for it.

#pragma once

#include "api/services.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// An open store; opaque.
typedef struct store store;

/// Called on the store's thread after a commit, once for each run that it changed. Must not block
/// and must not call the store.
typedef void store_listener(void *context, const char *run_id);

/// Which runs that have ended are removed, the one that ended first before all others. 0: no limit.
typedef struct store_retention {
    int64_t age_ms;   ///< since it ended, at most
    uint64_t n_runs;  ///< that have ended, at most
    uint64_t n_bytes; ///< in use in the file, at most; free pages in it are used again
} store_retention;

enum { STORE_EXTERNAL_ID_SIZE = 128 }; ///< bytes of an executor's id of a job with its terminator

/// What is asked of a running run; the greater wins. The values stand in the store: never renumber.
typedef enum store_stop {
    STORE_STOP_NONE,   ///< nothing
    STORE_STOP_CANCEL, ///< end and keep what there is
    STORE_STOP_KILL,   ///< end at once: what there is will be removed
} store_stop;

/// A run that is running, as its supervisor needs to know it.
typedef struct store_running {
    char id[API_ID_SIZE];                     ///< of the run
    store_stop stop_request;                  ///< what is asked of it
    char external_id[STORE_EXTERNAL_ID_SIZE]; ///< the executor's id of its job; "": none was set
} store_running;

/// What an owner may use; 0: no limit. Runs without an owner have no quotas.
typedef struct store_quotas {
    uint64_t n_waiting; ///< runs that wait
    uint64_t cpu_s;     ///< CPU seconds of solvers within API_QUOTA_WINDOW_S, in whole hours
    /// Of results: compressed snapshots, samples, events and scenarios; sets that several runs
    /// of the owner share count once; and of measurements
    uint64_t n_bytes;
    uint64_t n_measurements; ///< measurements
    uint64_t n_studies;      ///< studies that have not ended
} store_quotas;

/// True if the executor still has the job of a run of the daemon before. Must not call the store.
typedef bool store_still_runs(void *context, const store_running *running);

/// How to open a store.
typedef struct store_options {
    const char *directory;    ///< data directory, created if missing; holds beltflow.db
    size_t queue_limit;       ///< most runs in state queued; beyond it store_submit() is BF_EBUSY
    size_t client_quota;      ///< most of them of one client, beyond it BF_ELIMIT; 0: no quota
    store_quotas quotas;      ///< of each owner
    store_listener *listener; ///< NULL: none
    void *listener_context;   ///< given to it
    store_still_runs *still_runs; ///< called for each run left running (I8); NULL: none still is
    void *still_runs_context;     ///< given to it
    /// At a run that may end with the daemon, one after the other and none further than
    /// the one before; 0: any number
    uint64_t attempts_max;
    int64_t idempotency_ms;        ///< how long answers to idempotency keys are stored; 0: a day
    store_retention retention;     ///< limits of automatic removal
    int64_t retention_interval_ms; ///< between looks at what is to be removed; 0: a minute
} store_options;

/// Open or create the store, migrate its schema forwards, and queue again what was running (I8).
/// BF_ESYSTEM: the file cannot be used, is of a newer version, or another daemon holds it.
BF_MUST_CHECK bf_status store_open(const store_options *options, store **ret_store, bf_error *err);

/// Stop the thread, checkpoint and close; all other calls must have returned. NULL is fine. Always
/// returns NULL.
store *store_close(store *s);

/// Accept a run: a new id, state queued, its first status event; where the results are known and the
/// submission does not want them fresh, state succeeded with all that it has. In one transaction and in
/// this order: the answer to its key, room on the disk and the owner's quota of bytes, known results, the client's quota,
/// the owner's other quotas, the queue's limit; so that a replay always gets its first answer. See api_services.submit.
BF_MUST_CHECK bf_status store_submit(store *s, const api_submission *submission,
                                     api_acceptance *ret_acceptance, bf_error *err);

/// Remove by other limits from now on.
void store_set_retention(store *s, const store_retention *retention);

/// Cancel a queued run (status and end events). A running one gets a stop request (I14) for the
/// supervisor and is returned as it is. revision is the one that it must have, or API_ANY_REVISION.
/// BF_EINPUT: it has another one; BF_ECONFLICT: it has ended.
BF_MUST_CHECK bf_status store_cancel(store *s, const char *id, uint64_t revision, api_run *ret_run,
                                     bf_error *err);

/// See api_services.annotate. No event tells it.
BF_MUST_CHECK bf_status store_annotate(store *s, const char *id, uint64_t revision,
                                       const api_annotations *to, api_run *ret_run, bf_error *err);
/// Remove a run that is not running, with all it has alone (I9). revision as for store_cancel().
/// BF_ECONFLICT: it is running, and was requested to stop at once: to be removed when it has.
BF_MUST_CHECK bf_status store_remove(store *s, const char *id, uint64_t revision, bf_error *err);

/// Lines; see api_services.
BF_MUST_CHECK bf_status store_list_lines(store *s, const api_page_query *query, api_page *ret_page,
                                         bf_error *err);

/// Measurements; see api_services. store_add_measurement() gives a new id; BF_ECONFLICT when I13 allows no further one.
BF_MUST_CHECK bf_status store_add_measurement(store *s, const api_measurement *measurement,
                                              const api_curve *curve, const bf_buffer *csv,
                                              api_measurement *ret_measurement, bf_error *err);
BF_MUST_CHECK bf_status store_remove_measurement(store *s, const char *id, bf_error *err);
BF_MUST_CHECK bf_status store_find_measurement(store *s, const char *id,
                                               api_measurement *ret_measurement, bf_error *err);
BF_MUST_CHECK bf_status store_list_measurements(store *s, const api_page_query *query,
                                                api_page *ret_page, bf_error *err);
BF_MUST_CHECK bf_status store_read_measurement_csv(store *s, const char *id, bf_buffer *out,
                                                   bf_error *err);
BF_MUST_CHECK bf_status store_read_measurement(store *s, const char *id, api_curve *ret_curve,
                                               bf_error *err);

/// Reading; see api_services for the meaning of each.
BF_MUST_CHECK bf_status store_find(store *s, const char *id, api_run *ret_run, bf_error *err);
BF_MUST_CHECK bf_status store_list(store *s, const api_list_query *query, api_run_list *ret_list,
                                   bf_error *err);
BF_MUST_CHECK bf_status store_read_text(store *s, const char *id, api_text which, bf_buffer *out,
                                        bf_error *err);
BF_MUST_CHECK bf_status store_read_curve(store *s, const char *id, uint64_t first, uint64_t n_most,
                                         api_curve *ret_curve, bf_error *err);
BF_MUST_CHECK bf_status store_list_snapshots(store *s, const char *id, api_snapshot_list *ret_list,
                                             bf_error *err);
BF_MUST_CHECK bf_status store_read_array(store *s, const char *id, uint64_t index,
                                         api_array_kind kind, api_array *ret_array, bf_buffer *out,
                                         bf_error *err);
BF_MUST_CHECK bf_status store_open_array(store *s, const char *id, uint64_t index,
                                         api_array_kind kind, api_array *ret_array,
                                         api_slices *ret_slices, bf_error *err);
BF_MUST_CHECK bf_status store_read_slice(store *s, api_slices *slices, uint64_t at,
                                         size_t limit_bytes, bf_buffer *out, bf_error *err);
/// A run that was removed has no events any more; that is no failure. No reader is held while on_event()
/// runs, so it may call the store.
BF_MUST_CHECK bf_status store_read_changes(store *s, const char *id, api_event_fn *on_event,
                                           void *context, bf_error *err);
BF_MUST_CHECK bf_status store_read_events(store *s, const char (*runs)[API_ID_SIZE], size_t n_runs,
                                          uint64_t after, size_t limit_bytes,
                                          api_event_fn *on_event, void *context, bf_error *err);

/// Counts and sizes of what the store holds.
typedef struct store_stats {
    uint64_t n_runs[RUN_STATE_COUNT]; ///< runs by state
    uint64_t n_claimable;     ///< of those that wait, what is no trial of a study that rests
    int64_t oldest_queued_ms; ///< when the oldest run that waits was created; 0: none waits
    uint64_t file_bytes;      ///< of the database
    uint64_t log_bytes;       ///< of its write-ahead log
    uint64_t free_bytes;      ///< on its disk
} store_stats;

/// The stats as they were when they were last counted, a second ago at most unless the store's
/// thread hangs. Never waits for the disk.
void store_read_stats(store *s, store_stats *ret_stats);

/// A run that waits.
typedef struct store_queued {
    char id[API_ID_SIZE];    ///< which
    char study[API_ID_SIZE]; ///< whose trial it is; "": a run by itself
} store_queued;

/// The oldest runs that wait, trials among them, n_most at most.
BF_MUST_CHECK bf_status store_list_queued(store *s, store_queued *runs, size_t n_most,
                                          size_t *ret_n, bf_error *err);

/// A run that has succeeded, with what it took.
typedef struct store_measured {
    char id[API_ID_SIZE];    ///< which
    char study[API_ID_SIZE]; ///< whose trial it is; "": a run by itself
    double cpu_s;            ///< > 0
    int64_t finished_ms;     ///< when
} store_measured;

/// Of the runs that have succeeded after a time, without those that were known, the newest, newest first, n_most at most.
BF_MUST_CHECK bf_status store_list_measured(store *s, int64_t after_ms, store_measured *runs,
                                            size_t n_most, size_t *ret_n, bf_error *err);

/// Let more or fewer runs wait, in all and of each client, or change what owners may use; see store_options.
void store_set_queue_limit(store *s, size_t limit);
void store_set_client_quota(store *s, size_t quota);
void store_set_quotas(store *s, const store_quotas *quotas);

/// What an owner uses ("": runs without an owner) and may use. See api_services.read_quotas.
BF_MUST_CHECK bf_status store_read_quotas(store *s, const char *owner, api_quotas *ret_quotas,
                                          bf_error *err);

/// Remember for ever that the store was used with access tokens. Copies of it remember it, too.
BF_MUST_CHECK bf_status store_need_tokens(store *s, bf_error *err);

/// Whether that is remembered, or some owner of tokens has runs here.
BF_MUST_CHECK bf_status store_needs_tokens(store *s, bool *ret_needs, bf_error *err);

/// How many transactions the store has committed. What was read after this number was n is what the store holds as
/// long as it is n: it rises before anybody hears of a commit.
uint64_t store_count_commits(const store *s);

/// Probe the store's thread; true if it has answered all previous probes.
bool store_is_alive(store *s);

/// BF_OK if the store can write; else why not.
BF_MUST_CHECK bf_status store_ready(store *s, bf_error *err);
