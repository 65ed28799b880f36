/// What the handlers share while they answer one request, and the handlers.

#pragma once

#include "api/http/exchange.h"
#include "api/http/negotiation.h"
#include "api/http/query.h"
#include "api/http/routes.h"
#include "api/json/members.h"
#include "core/base/faults.h"

#include <stdbool.h>

enum { EXCHANGE_ETAG_SIZE = 112 }; ///< bytes of an entity tag with its terminator

struct array_file;

/// The run or the study that a path below "/v1/runs/{id}" or "/v1/studies/{id}" names.
typedef struct exchange_resource {
    bool is_study; ///< which of them
    union {
        api_run run;     ///< as it was found before the handler was called
        api_study study; ///< same
    };
} exchange_resource;

/// One request on its way to its response. Lives on the stack of api_handle().
struct exchange {
    const api_services *services; ///< what the daemon offers
    const api_request *request;   ///< borrowed
    api_response *response;       ///< filled by the handler
    const route *route;           ///< found in the table
    route_params params;          ///< of the path
    query query;                  ///< parsed, and checked against the rows of the route
    const media *media;           ///< the representation that was chosen
    const media *body_media;      ///< of the body, where the route has one
    bf_faults faults;             ///< of the request's document, for `errors` of a problem
    bool is_unmatched;            ///< If-Match of a GET names other states than the present one
    exchange_resource *named;     ///< the run or study that the path names; of other paths not set
    api_identity who;             ///< who sent it
    api_credential credential;    ///< what became of its token
    api_scope lacked;             ///< the scope that the token lacks, of a refusal for it
    int refusal;                  ///< HTTP status of a failure; 0: follows from its bf_status
    unsigned retry_after_s;       ///< of a failure that passes, if it is known when; else 0
    char accepts[NEGOTIATION_TYPES_SIZE]; ///< media types of bodies, for a 415
};

/// Fail with an HTTP status that no bf_status stands for, as BF_EINPUT. pointer is the place at fault, as
/// "/<parameter>/<index>" of a query, "/line/<number>" of CSV, or a JSON pointer; "": none.
bf_status exchange__refuse(exchange *x, int http_status, const char *pointer, bf_error *err,
                           const char *format, ...) __attribute__((format(printf, 5, 6)));

/// Take room for an answer of some n bytes before it is made. BF_EBUSY: too much is taken by others.
BF_MUST_CHECK bf_status exchange__reserve(const exchange *x, double n, bf_error *err);

enum {
    EXCHANGE_WHOLE_MAX = 4000000,     ///< numbers of an answer that is made as a whole
    EXCHANGE_PIECE_BYTES = 131072,    ///< arrays up to so many bytes are sent faster as a whole
    EXCHANGE_ENCODED_BYTES = 524288,  ///< the same where they are encoded
    EXCHANGE_SNAPSHOTS_MAX = 64,      ///< snapshots in one answer, and
    EXCHANGE_SEVERAL_BYTES = 4194304, ///< of how many bytes, where they are more than one
};

/// Take room for an answer of n numbers that is made as a whole: as text, or as an array with a content coding. BF_EINPUT
/// as a 406: they are too many; other names the formats to ask for instead of text. BF_EBUSY as above.
BF_MUST_CHECK bf_status exchange__reserve_whole(exchange *x, uint64_t n, size_t item_size,
                                                const char *other, bf_error *err);

/// True if the client takes an answer without a content coding, as one that is sent piece by piece is; and up to
/// how many bytes an array is made as a whole for this client.
bool exchange__accepts_plain(const exchange *x);
size_t exchange__whole_bytes(const exchange *x);

/// Send the file, which is taken over: piece by piece, if it is not small.
BF_MUST_CHECK bf_status exchange__send_array(exchange *x, struct array_file *file, bf_error *err);

/// Answer the parameter `count`: the NumPy files of densities, or parts, from a snapshot on. False: it asks for one.
bool exchange__wants_several(const exchange *x);
BF_MUST_CHECK bf_status exchange__send_several(exchange *x, uint64_t index, bool is_parts,
                                               bf_error *err);

/// A request header's value, or NULL.
const char *exchange__header(const exchange *x, const char *name);

/// The value of a parameter in the query, as text (NULL: not given), or as its kind reads it: then its
/// default where it is not given, 0 if there is none. ret_ids has room for as many as the row allows;
/// exchange__ids() returns how many there are.
const char *exchange__text(const exchange *x, const char *name);
uint64_t exchange__whole(const exchange *x, const char *name);
double exchange__real(const exchange *x, const char *name);
size_t exchange__ids(const exchange *x, const char *name, char (*ret_ids)[API_ID_SIZE]);

/// The request's body as text, "" if there is none; and an object as that of the answer.
const char *exchange__body(const exchange *x);
BF_MUST_CHECK bf_status exchange__write(exchange *x, const member_table *table, const void *item,
                                        bf_error *err);

/// Find what the path names: done before its handler is called, and again where a change found another revision.
/// BF_ENOTFOUND also for what cannot be an id.
BF_MUST_CHECK bf_status exchange__find_named(const exchange *x, bf_error *err);

/// Find the snapshot that the path's second parameter numbers. BF_ENOTFOUND: it is not a number, or the
/// run does not have that snapshot yet.
BF_MUST_CHECK bf_status exchange__find_snapshot(const exchange *x, uint64_t *ret_index,
                                                bf_error *err);

/// Compare If-Match and If-None-Match with the tags of the forms that the resource to be changed has
/// (ended by NULL). BF_EINPUT, as a 412: the first names other states, or the second this one.
BF_MUST_CHECK bf_status exchange__check_change(exchange *x, const char *const *tags, bf_error *err);

/// The same for a run or a study of a revision. *ret_revision is the one that a change has to find: this one,
/// API_ANY_REVISION where the request has no If-Match.
BF_MUST_CHECK bf_status exchange__check_match(exchange *x, uint64_t revision,
                                              uint64_t *ret_revision, bf_error *err);

/// The requested page of a list, from the parameters label, cursor and limit.
typedef struct exchange_page {
    char label[API_LABEL_SIZE]; ///< "": any
    const char *cursor;         ///< behind which the page begins; "": at the beginning
    size_t limit;               ///< 1 .. API_LIST_MAX
} exchange_page;

/// The requested page.
exchange_page exchange__page(const exchange *x);

/// Answer with a page of a list, and the Link to the one behind the cursor ("": there is none), with the other parameters of
/// the request.
BF_MUST_CHECK bf_status exchange__send_page(exchange *x, const exchange_page *page,
                                            const char *cursor, const member_table *table,
                                            const void *list, bf_error *err);

/// Set ETag to the tag of the resource's present state, given without quotes. True: the handler is done,
/// as If-None-Match names the state (304), or If-Match does not (412, exchange__check_state()).
bool exchange__is_unchanged(exchange *x, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// The same where the body is cheap: the handler writes it even for a 304, so that the transport knows
/// the length that a 200 would have.
bool exchange__match_etag(exchange *x, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// What follows a handler: give a response that may be kept a tag, if it has none. BF_EINPUT, as a 412:
/// If-Match names another state.
BF_MUST_CHECK bf_status exchange__check_state(exchange *x, bf_error *err);

/// Allow caching without asking again: the answer never changes.
void exchange__cache_immutable(exchange *x);

/// Allow caching, with a request that names the entity tag before each use; without one it gets one of its bytes.
void exchange__cache_revalidate(exchange *x);

/// Suggest a file name for the body: "000012.vti".
void exchange__name_snapshot(exchange *x, uint64_t index);

/// Let the response wait at most so many seconds (API_WAIT_MAX_S) for the end of the run or, if
/// is_for_change, for another revision. Does nothing when it has waited, or the run has ended.
void exchange__long_poll(exchange *x, const api_run *record, unsigned seconds, bool is_for_change);

/// The same for the end of the run where the client prefers it (`Prefer: wait=N`).
void exchange__prefer_long_poll(exchange *x, const api_run *record);

/// Runs: accept, validate, list, show;
route_handler_fn handlers_runs_submit;
route_handler_fn handlers_runs_validate;
route_handler_fn handlers_runs_list;
route_handler_fn handlers_runs_show;
/// and what they have alike with studies; of studies alone pause and resume.
route_handler_fn handlers_resources_annotate, handlers_resources_remove, handlers_resources_cancel;
route_handler_fn handlers_resources_pause, handlers_resources_resume;
/// Grants, which read one run or study each.
route_handler_fn handlers_resources_grant, handlers_resources_list_grants;
route_handler_fn handlers_resources_revoke_grant;

/// What becomes of submissions: who sends one, with the n bytes of body that must come again with its key; and the answer
/// to one that was tried, its status passed on: a refusal, or what was created below a path such as "/v1/runs".
BF_MUST_CHECK bf_status handlers__read_sender(const exchange *x, const char *body, size_t n,
                                              api_sender *ret_sender, bf_error *err);
BF_MUST_CHECK bf_status handlers__answer_submission(exchange *x, bf_status status, const char *path,
                                                    api_acceptance *accepted);

/// The texts that a submission may name by the ids of measurements, n bytes of them; of the exchange, which is borrowed.
json_in_texts handlers__texts(const exchange *x, size_t n);

/// Accept a run for the sender, who may repeat the request with a key as long as the n bytes of body are the same; and
/// answer with it, or with what is polled, or of a study with the request's body. The submission stays the caller's.
BF_MUST_CHECK bf_status handlers__submit_run(exchange *x, api_submission *submission,
                                             const char *body, size_t n, bf_error *err);
BF_MUST_CHECK bf_status handlers__answer_polled(exchange *x, bf_error *err);
BF_MUST_CHECK bf_status handlers__submit_study(exchange *x, api_study_submission *made,
                                               bf_error *err);

/// Studies: accept, show,
route_handler_fn handlers_studies_submit, handlers_studies_show;
/// and what they have: document, trials, what was found, events; a trial as a run of its own.
route_handler_fn handlers_trials_document;
route_handler_fn handlers_trials_list;
route_handler_fn handlers_trials_best;
route_handler_fn handlers_trials_events;
route_handler_fn handlers_trials_run;

/// The results of a run so far.
route_handler_fn handlers_results_scenario;
route_handler_fn handlers_results_summary;
route_handler_fn handlers_results_curve;
route_handler_fn handlers_results_photo_eyes;

/// Its density snapshots.
route_handler_fn handlers_results_snapshots;
route_handler_fn handlers_results_snapshot;

/// The parts of a microscopic run.
route_handler_fn handlers_results_parts;
route_handler_fn handlers_results_parts_series;

/// All results at once.
route_handler_fn handlers_results_archive;

/// Id of the last event that the sender has seen, from Last-Event-ID or the query; 0: none. BF_EINPUT: it is none.
BF_MUST_CHECK bf_status handlers__read_last_event(const exchange *x, uint64_t *ret_id,
                                                  bf_error *err);

/// Event streams of one run and of several.
route_handler_fn handlers_results_events;
route_handler_fn handlers_results_events_of_runs;
route_handler_fn handlers_results_figures;

/// Measured curves.
route_handler_fn handlers_measurements_add;
route_handler_fn handlers_measurements_show;
route_handler_fn handlers_measurements_remove;

/// Lists of studies, measurements and lines.
route_handler_fn handlers_lists_studies, handlers_lists_measurements, handlers_lists_lines;

/// Write the distance of the densities of two runs; null where an id is NULL. n_pairs share what a request may compare.
BF_MUST_CHECK bf_status handlers__write_density(exchange *x, json_out *w, const char *a,
                                                const char *b, size_t n_pairs, bf_error *err);

/// Leases of workers: take, read its jobs, deliver frames, renew, leave; and the list of workers.
route_handler_fn handlers_leases_take, handlers_leases_jobs, handlers_leases_deliver;
route_handler_fn handlers_leases_renew, handlers_leases_leave, handlers_leases_list;

/// Comparisons of runs and measurements.
route_handler_fn handlers_compare_runs;

/// The service itself.
route_handler_fn handlers_meta_examples, handlers_meta_example, handlers_meta_goods;
route_handler_fn handlers_meta_ticket, handlers_meta_quota, handlers_meta_metrics;
route_handler_fn handlers_meta_livez, handlers_meta_readyz;
route_handler_fn handlers_meta_version, handlers_meta_problem, handlers_meta_openapi;
