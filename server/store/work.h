/// What the supervisor does with the store: it takes runs from the queue, stores what they send, and ends
/// them. Threads, errors and invariants are those of store.h.

#pragma once

#include "server/store/store.h"

/// A claimed run. Buffers are the caller's: store_job_fini().
typedef struct store_job {
    api_run run;          ///< now running
    bf_buffer scenario;   ///< resolved document
    bf_buffer columns;    ///< of its curve
    bf_buffer checkpoint; ///< n = 0: none
    uint64_t step;        ///< of the checkpoint
    double wall_s;        ///< solving time of earlier attempts
    double cpu_s;         ///< CPU time of earlier attempts
} store_job;

/// Take the next queued run and make it running: of the runs by themselves with the highest priority that of the owner who
/// was served longest ago, and of his the oldest; where there is none, with_trials, a trial of the study whose turn it is.
/// Runs of owners beyond their quotas of CPU time or bytes wait. BF_ENOTFOUND: none is queued; BF_ELIMIT: only such ones;
/// BF_ENOSPACE: the disk has no room for what it would send.
BF_MUST_CHECK bf_status store_claim(store *s, bool with_trials, store_job *ret_job, bf_error *err);

/// Read a run that is running already, as store_claim() returned it but without its checkpoint: for a
/// supervisor that takes over its job after a restart. BF_ECONFLICT: the run is not running.
BF_MUST_CHECK bf_status store_read_job(store *s, const char *id, store_job *ret_job, bf_error *err);

/// Free what *job owns and zero it. NULL is fine.
void store_job_fini(store_job *job);

/// Bytes of an array that are stored alone.
#define STORE_SLICE_BYTES FRAME_SLICE_BYTES

/// One thing that a running run sent, ready for the store.
typedef struct store_item {
    api_event_type type; ///< API_EVENT_PROGRESS, _CURVE, _SNAPSHOT, _FIGURES, or from _EYE on
    /// Data of the event: a JSON object; of samples also empty: made of them when it is read
    bf_buffer event;
    uint64_t first;        ///< curve: index of the first sample; snapshot, change: its index
    size_t n;              ///< curve: samples
    bf_buffer t;           ///< curve: n doubles
    bf_buffer values;      ///< curve: n rows of doubles
    api_snapshot snapshot; ///< snapshot
    bf_buffer rho;         ///< snapshot: float32 grid from byte rho_at on, uncompressed
    uint64_t rho_at;       ///< snapshot: bytes of the grid that came in items before
    bf_buffer parts;       ///< snapshot: rows of doubles from byte parts_at on, uncompressed
    uint64_t parts_at;     ///< snapshot: bytes of the rows that came in items before
    bool is_open;          ///< snapshot: more items of it will come; this one has no event
    bf_buffer figures;     ///< figures: all of them as an object
    char run_figures[API_FIGURES_SIZE]; ///< figures: those of the run alone
} store_item;

/// A batch of what one running run sent, in order. A snapshot may come in several items, also of several batches: all but
/// the last are open, and what an open item has of an array ends with it or after whole STORE_SLICE_BYTES. Only the last
/// one makes the snapshot visible; what a run leaves of one that it did not complete is deleted when the run ends or goes
/// back to the queue, or when the snapshot comes again from its first byte.
typedef struct store_batch {
    const char *run_id;     ///< whose
    size_t n;               ///< items
    store_item *items;      ///< in the order in which they came
    double progress;        ///< 0 to 1
    double eta_s;           ///< NAN: unknown
    double wall_s;          ///< solving time so far, all attempts
    double cpu_s;           ///< CPU time so far, all attempts: the increase is charged to the owner
    uint64_t token;         ///< of the worker that sent it; 0: none
    const bf_grid *grid;    ///< of the snapshots; NULL: as before
    api_parts parts;        ///< of the snapshots, where grid is given
    uint64_t step;          ///< of checkpoint
    const void *checkpoint; ///< n_checkpoint bytes; NULL: the one before stays
    size_t n_checkpoint;    ///< bytes
} store_batch;

/// What became of a batch; err is of a status that is not BF_OK. Called once, on a thread of the store's,
/// after the commit. Must not block and must not call the store.
typedef void store_appended(void *context, bf_status status, const bf_error *err);

/// Store a batch without waiting: it is compressed on a thread of the store's and committed together with
/// what else waits. *batch and all that it points at must stay as they are until `appended` is called. Batches
/// are stored in the order of these calls; one that follows a batch that failed may be refused for the gap.
/// Before store_finish() of a run, and before store_close(), all of its batches must have been answered.
///
/// `appended` gets BF_ECONFLICT: the run is not running; BF_ECORRUPT: a gap (I4), also in an array, or sizes that do not
/// fit the run's columns, grid and parts; then nothing of the batch is stored. Samples and snapshots that are stored
/// already are left out, and their events with them; of a curve item that is stored in part the rest is stored,
/// and its event covers that rest only (I4): the store cuts t, values and event data by events_curve().
/// Not BF_OK: nothing was begun, and `appended` is not called.
BF_MUST_CHECK bf_status store_begin_append(store *s, const store_batch *batch,
                                           store_appended *appended, void *appended_context,
                                           bf_error *err);

/// The run that is claimed together with the end of another.
typedef struct store_next {
    bool with_trials; ///< given: as of store_claim()
    /// As of store_claim(); BF_ECONFLICT: none was claimed, store_claim() has to be called
    bf_status status;
    bf_error error; ///< of a status that is not BF_OK
    store_job job;  ///< of BF_OK: the caller's
} store_next;

/// What an attempt that ends with RUN_QUEUED counts as.
typedef enum store_attempt {
    STORE_ATTEMPT_NONE,      ///< nothing: this service asked for the run, or could not store it
    STORE_ATTEMPT_HAND_BACK, ///< who had the run gave it back: STORE_HAND_BACKS_MAX of them are too many
    STORE_ATTEMPT_FAILED, ///< it failed, be it not by the run's fault: attempts_max of them are too many
} store_attempt;

/// Hand-backs of a run, one after the other, that brought nothing new.
enum { STORE_HAND_BACKS_MAX = 1000 };

/// How a run ends or goes back to the queue.
typedef struct store_ending {
    const char *run_id; ///< whose
    run_state state;    ///< an end, or RUN_QUEUED to hand it back
    bf_error error; ///< of RUN_FAILED; of another state why the store took no other, for the log
    /// Of RUN_QUEUED: after too many the run has failed, with error as the last reason
    store_attempt attempt;
    /// Of RUN_SUCCEEDED: as many results as this says must be stored; NULL: any number
    const frame_end *whole;
    bool is_without_snapshots; ///< of whole: its snapshots were not sent
    const char *summary;       ///< summary.json, n_summary bytes; NULL: none
    size_t n_summary;          ///< bytes
    const store_batch *last;   ///< what it sent last, stored in the same transaction; NULL: nothing
    double cpu_s; ///< CPU time of all attempts; less than was charged (0) charges nothing
    /// Claim a run in the same commit, whatever becomes of this one; NULL: do not
    store_next *next;
} store_ending;

/// Move a running run on: an end (with its status and end events; the checkpoint is dropped) or
/// back to the queue. *ret_run is what it has become. BF_ECONFLICT: not running; BF_ECORRUPT: of `last` as of a batch, or
/// there are not as many results as `whole` says.
BF_MUST_CHECK bf_status store_finish(store *s, const store_ending *ending, api_run *ret_run,
                                     bf_error *err);

/// The results of a run are suspect (run_id, else NULL), or all that a worker with this token (0: none) has sent so far, or will
/// send of runs that it has now. They are not for further runs, and the runs that have them are marked, on the store's thread, one
/// after the other, also after a restart. Does not wait; what cannot be stored is logged.
void store_begin_suspecting(store *s, const char *run_id, uint64_t token);

/// Store the executor's id of a running run's job, so that the daemon after this one finds it again. It is
/// deleted when the run ends or is queued again. BF_ECONFLICT: the run is not running.
BF_MUST_CHECK bf_status store_set_external_id(store *s, const char *id, const char *external_id,
                                              bf_error *err);

/// How many stop requests were stored since the store was opened, of which the listener hears after that. Does not wait.
uint64_t store_count_stop_requests(const store *s);

/// Read the runs that are running, at most `size` of them, the oldest first.
BF_MUST_CHECK bf_status store_list_running(store *s, size_t size, store_running *ret_runs,
                                           size_t *ret_n, bf_error *err);
