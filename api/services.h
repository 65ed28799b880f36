/// What the API needs of the daemon, as a table of functions that the server fills.
///
/// With it the whole API can be called without sockets, store or threads (the tests do).
/// All functions are thread-safe. Those that write return when their change is on disk. Common errors:
/// BF_ENOTFOUND no such run; BF_ESYSTEM the store failed; BF_ENOSPACE the disk is full; BF_EBUSY too many
/// read it at once; BF_ENOMEM.

#pragma once

#include "api/access.h"
#include "api/event.h"
#include "api/grants.h"
#include "api/leases.h"
#include "api/measurements.h"
#include "api/page.h"
#include "api/quotas.h"
#include "api/run.h"
#include "api/run_list.h"
#include "api/run_state.h"
#include "api/snapshots.h"
#include "api/studies.h"
#include "core/advice/prediction.h"
#include "core/base/buffer.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/observe/columns.h"
#include "core/run/run.h"

#include <stddef.h>
#include <stdint.h>

enum {
    API_PRIORITY_MAX = 100,   ///< priorities go from -100 to 100, higher first
    API_STREAM_RUNS_MAX = 32, ///< runs one event stream can follow
    API_ANY_REVISION = 0,     ///< whatever the revision is
};

/// A run to be accepted.
typedef struct api_submission {
    run_model model;                ///< which solver
    int priority;                   ///< see API_PRIORITY_MAX
    char label[API_LABEL_SIZE];     ///< "" if none
    char line[API_LABEL_SIZE];      ///< same
    char name[SCENE_NAME_SIZE];     ///< of the scenario
    char closure[API_CLOSURE_SIZE]; ///< see api_run
    bf_buffer scenario;             ///< the resolved document
    bf_buffer columns;              ///< of the curve, from scenario_columns()
    bool is_fresh;                  ///< to be solved even if the results are known
    uint64_t replications;          ///< above 1: runs at other substreams, which are a study
    bf_buffer identity;             ///< the resolved document without its name; "": never cached
    api_sender sender;              ///< whose it will be
} api_submission;

/// What became of a submission. Zero-initialise; free with buffer_fini(&answer).
typedef struct api_acceptance {
    char id[API_ID_SIZE];   ///< of the run
    uint64_t revision;      ///< of the run when it was accepted
    bool is_replay;         ///< the key was used before: this is the first answer again
    unsigned retry_after_s; ///< of BF_ELIMIT: when another try can help; 0: not known
    bf_buffer answer;       ///< the run as JSON when it was accepted
} api_acceptance;

/// A page of a list.
typedef struct api_run_list {
    size_t n;                          ///< runs in this page
    bool has_more;                     ///< further ones may follow
    char last_id[API_ID_SIZE];         ///< the last one that was looked at for it
    char next_cursor[API_CURSOR_SIZE]; ///< of what follows: who answers writes it
    char last_key[API_SORT_KEY_SIZE]; ///< key of the last one; "": it has none, or API_SORT_CREATED
    bool has_total;                   ///< it was wanted
    uint64_t total;                   ///< runs on all pages, of the newest API_LIST_NEWEST
    api_run runs[API_LIST_MAX];       ///< the page
} api_run_list;

/// A stored text of a run.
typedef enum api_text {
    API_TEXT_SCENARIO, ///< the resolved document
    API_TEXT_SUMMARY,  ///< summary.json
    API_TEXT_FIGURES,  ///< all key figures so far, as of key_figures_write()
} api_text;

/// The stored part of a curve. Zero-initialise; api_curve_fini().
typedef struct api_curve {
    bf_buffer columns; ///< of core/observe/columns.h, "id,...,left_domain,..."
    size_t n;          ///< samples
    size_t n_columns;  ///< columns without t
    bf_buffer t;       ///< n doubles, s
    bf_buffer values;  ///< n rows of n_columns doubles
} api_curve;

/// Where runs, measurements and studies are stored, and the daemon with all its parts; the server's.
typedef struct store api_store;
typedef struct service api_service;

/// Read a page of a list.
typedef bf_status api_page_fn(api_store *store, const api_page_query *query, api_page *ret_page,
                              bf_error *err);

/// The table.
typedef struct api_services {
    api_store *store;     ///< first argument of functions that only read or write what is stored
    api_service *service; ///< first argument of the others
    /// What becomes of a token (NULL: the request has none), and of a valid one who has it. Does not wait for
    /// the disk beyond a short read. NULL instead of a function: there are no tokens.
    api_credential (*identify)(api_service *service, const char *token, api_identity *ret_who);
    /// The same of a token that was valid, by its number.
    api_credential (*identify_by_id)(api_service *service, uint64_t token, api_identity *ret_who);
    /// Make a ticket that stands for a token; and read one, which leaves open whether its token still counts.
    void (*make_ticket)(api_service *service, uint64_t token, api_ticket *ret_ticket);
    api_credential (*read_ticket)(api_service *service, const char *ticket, uint64_t *ret_token);
    /// Make a grant with resource and owner of *grant, for expires_in_s seconds; the rest of *grant is filled. Durable when this
    /// returns. BF_ECONFLICT: there are no tokens; BF_ELIMIT: the owner has API_GRANTS_MAX that count, or no more can be stored.
    bf_status (*add_grant)(api_service *service, uint32_t expires_in_s, api_grant *grant,
                           bf_error *err);
    /// The grants of an owner ("": of all) that count. *ret_list is the caller's.
    bf_status (*list_grants)(api_service *service, const char *owner, api_grant_list *ret_list,
                             bf_error *err);
    /// Revoke a grant of an owner ("": whosever). BF_ENOTFOUND: there is none that counts.
    bf_status (*revoke_grant)(api_service *service, const char *owner, uint64_t id, bf_error *err);
    /// Accept a run: durable when this returns, together with its key. *ret_acceptance is the caller's.
    /// Checked in this order: BF_EINPUT: the key was used with another body; BF_ECONFLICT: a submission
    /// with it is under way; BF_ENOSPACE: the disk is nearly full, or the owner's quota of bytes is
    /// used up; BF_ELIMIT: another quota of the client or the owner is; BF_EBUSY: the queue is full.
    bf_status (*submit)(api_service *service, const api_submission *submission,
                        api_acceptance *ret_acceptance, bf_error *err);
    /// What an owner uses and may use.
    bf_status (*read_quotas)(api_store *store, const char *owner, api_quotas *ret_quotas,
                             bf_error *err);
    bf_status (*find)(api_service *service, const char *id, api_run *ret_run, bf_error *err);
    /// True if find() would not wait for the disk now.
    bool (*holds)(api_service *service, const char *id);
    /// BF_ELIMIT: conditions would read more than API_LIST_DOCUMENT_BYTES.
    bf_status (*list)(api_service *service, const api_list_query *query, api_run_list *ret_list,
                      bf_error *err);
    api_page_fn *list_lines;
    /// Ask a run to stop and keep what it has. A queued run is cancelled when this returns, a running
    /// one soon after. revision is the one that it must have in the transaction that decides, or
    /// API_ANY_REVISION. BF_EINPUT: it has another one; BF_ECONFLICT: it has ended.
    bf_status (*cancel)(api_store *store, const char *id, uint64_t revision, api_run *ret_run,
                        bf_error *err);
    /// Change what users call a run and note of it. revision as for cancel. BF_EINPUT: it has another one.
    bf_status (*annotate)(api_store *store, const char *id, uint64_t revision,
                          const api_annotations *annotations, api_run *ret_run, bf_error *err);
    /// Stop a run if need be and remove it with its results. revision as for cancel.
    bf_status (*remove)(api_service *service, const char *id, uint64_t revision, bf_error *err);
    /// Append a stored text to *out. BF_ECONFLICT: the run has none yet.
    bf_status (*read_text)(api_store *store, const char *id, api_text which, bf_buffer *out,
                           bf_error *err);
    /// Samples from index first on, n_most at most; with 0 the columns alone. *ret_curve is the caller's:
    /// api_curve_fini().
    bf_status (*read_curve)(api_store *store, const char *id, uint64_t first, uint64_t n_most,
                            api_curve *ret_curve, bf_error *err);
    bf_status (*list_snapshots)(api_store *store, const char *id, api_snapshot_list *ret_list,
                                bf_error *err);
    /// Append an array of a snapshot to *out. BF_ENOTFOUND: no such snapshot, or the run has no parts.
    bf_status (*read_array)(api_store *store, const char *id, uint64_t index, api_array_kind kind,
                            api_array *ret_array, bf_buffer *out, bf_error *err);
    /// Begin to read what read_array() would append, piece by piece. *ret_slices is the caller's.
    bf_status (*open_array)(api_store *store, const char *id, uint64_t index, api_array_kind kind,
                            api_array *ret_array, api_slices *ret_slices, bf_error *err);
    /// Append bytes of an array from number `at` on to *out, limit_bytes at most, and at least one unless `at` is its
    /// end. It is fast where `at` is the end of the read before. On failure *out is as before. BF_ENOTFOUND: the run
    /// was removed meanwhile; BF_ECORRUPT: damaged.
    bf_status (*read_slice)(api_store *store, api_slices *slices, uint64_t at, size_t limit_bytes,
                            bf_buffer *out, bf_error *err);
    /// Give events of the runs with id > after, rising, to on_event(): all there are, or as many as reach
    /// limit_bytes of data.
    bf_status (*read_events)(api_store *store, const char (*runs)[API_ID_SIZE], size_t n_runs,
                             uint64_t after, size_t limit_bytes, api_event_fn *on_event,
                             void *context, bf_error *err);
    /// Give the events of a run's photo eyes and actions, rising, to on_event().
    bf_status (*read_changes)(api_store *store, const char *id, api_event_fn *on_event,
                              void *context, bf_error *err);
    /// Store a measurement, with the kind, label, counter, times and number of samples of *measurement: durable when
    /// this returns. It has a curve of one column, or, if it is none, an empty one and a text. BF_ECONFLICT:
    /// API_MEASUREMENTS_MAX are stored.
    bf_status (*add_measurement)(api_store *store, const api_measurement *measurement,
                                 const api_curve *curve, const bf_buffer *csv,
                                 api_measurement *ret_measurement, bf_error *err);
    bf_status (*find_measurement)(api_store *store, const char *id,
                                  api_measurement *ret_measurement, bf_error *err);
    api_page_fn *list_measurements;
    /// All samples; the column is the counter. *ret_curve is the caller's: api_curve_fini().
    bf_status (*read_measurement)(api_store *store, const char *id, api_curve *ret_curve,
                                  bf_error *err);
    /// Append the text of one that is no curve to *out.
    bf_status (*read_measurement_csv)(api_store *store, const char *id, bf_buffer *out,
                                      bf_error *err);
    bf_status (*remove_measurement)(api_store *store, const char *id, bf_error *err);
    /// Accept a study: durable when this returns. Checked in the order of submit, and with its errors; BF_EBUSY: there are
    /// too many that have not ended.
    bf_status (*submit_study)(api_service *service, const api_study_submission *submission,
                              api_acceptance *ret_acceptance, bf_error *err);
    bf_status (*find_study)(api_store *store, const char *id, api_study *ret_study, bf_error *err);
    api_page_fn *list_studies;
    /// revision as for cancel. BF_EINPUT: it has another one; BF_ECONFLICT: it has ended, or is to be resumed and not
    /// paused, or paused already.
    bf_status (*change_study)(api_service *service, const char *id, uint64_t revision,
                              api_study_change change, api_study *ret_study, bf_error *err);
    /// Change what a study is called. revision as for cancel. BF_EINPUT: it has another one.
    bf_status (*annotate_study)(api_store *store, const char *id, uint64_t revision,
                                const api_annotations *annotations, api_study *ret_study,
                                bf_error *err);
    /// Cancel a study if need be and remove it with its trials; their runs go soon after. revision as for cancel.
    bf_status (*remove_study)(api_service *service, const char *id, uint64_t revision,
                              bf_error *err);
    /// Append a stored text to *out. BF_ECONFLICT: there is nothing best yet.
    bf_status (*read_study)(api_store *store, const char *id, api_study_text which, bf_buffer *out,
                            bf_error *err);
    /// Give the trials of a study to on_trial().
    bf_status (*read_trials)(api_store *store, const char *id, const api_trial_query *query,
                             api_trial_fn *on_trial, void *context, bf_error *err);
    /// What workers on other machines ask; NULL: the daemon solves runs itself.
    const api_leases *leases;
    /// How fast the machine solves, which predictions need. False: not known yet.
    bool (*read_speed)(api_service *service, prediction_speed *ret_speed);
    /// BF_OK if runs can be accepted; else why not (BF_EBUSY draining, BF_ENOSPACE disk, BF_ESYSTEM store or solver).
    bf_status (*ready)(api_service *service, bf_error *err);
    /// Append the service's figures in Prometheus' text form to *out, if wanted also those of each owner and token. Without these
    /// it never waits for the disk.
    bf_status (*metrics)(api_service *service, bool with_owners, bf_buffer *out, bf_error *err);
    /// Append the OpenAPI document, which is made from the routes and so stands above them.
    bf_status (*write_openapi)(bf_buffer *out, bf_error *err);
} api_services;

/// How many columns "a,b,c" has.
size_t api_count_columns(const bf_buffer *columns);

/// Take the next name off the columns at *columns and move past it. False: none is left (ret_name
/// untouched). ret_name has COLUMN_NAME_SIZE bytes; a longer name is a bug.
bool api_next_column(const char **columns, char *ret_name);

/// Free what the curve owns and zero it. NULL is fine.
void api_curve_fini(api_curve *curve);
