/// What the handlers share while they answer one request, and the handlers.

#pragma once

#include "api/http/exchange.h"
#include "api/http/media.h"
#include "api/http/query.h"
#include "api/http/routes.h"
#include "core/base/faults.h"

#include <stdbool.h>

enum { EXCHANGE_ETAG_SIZE = 112 }; ///< bytes of an entity tag with its terminator

/// One request on its way to its response. Lives on the stack of api_handle().
struct exchange {
    const api_services *services; ///< what the daemon offers
    const api_request *request;   ///< borrowed
    api_response *response;       ///< filled by the handler
    const route *route;           ///< found in the table
    route_params params;          ///< of the path
    query query;                  ///< parsed, and checked against the rows of the route
    const media *media;           ///< the representation that was chosen
    bf_faults faults;             ///< of the request's document, for `errors` of a problem
    int refusal;                  ///< HTTP status of a failure; 0: follows from its bf_status
    char accepts[64];             ///< media types of bodies, for a 415
};

/// Fail with an HTTP status that no bf_status stands for. Returns BF_EINPUT.
bf_status exchange__refuse(exchange *x, int http_status, bf_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Same with the place at fault: "/<parameter>/<index>" of a query, "/line/<number>" of CSV, or a JSON
/// pointer.
bf_status exchange__refuse_at(exchange *x, int http_status, const char *pointer, bf_error *err,
                              const char *format, ...) __attribute__((format(printf, 5, 6)));

/// A request header's value, or NULL.
const char *exchange__header(const exchange *x, const char *name);

/// Read a parameter of the route that the query has, else its default. As text: NULL if it was not
/// given, and no default. As a whole number: 0 if there is neither. As ids: returns how many, 0 if it
/// was not given; ret_ids has room for the most that its row allows.
const char *exchange__text(const exchange *x, const char *name);
uint64_t exchange__whole(const exchange *x, const char *name);
double exchange__real(const exchange *x, const char *name);
size_t exchange__ids(const exchange *x, const char *name, char (*ret_ids)[API_ID_SIZE]);

/// Which page of a list is asked for, by the parameters label, cursor and limit.
typedef struct exchange_page {
    char label[API_LABEL_SIZE]; ///< "": any
    char before[API_ID_SIZE];   ///< only what is older than this id; "": from the newest
    size_t limit;               ///< 1 .. API_LIST_MAX
} exchange_page;

/// The page that is asked for.
exchange_page exchange__page(const exchange *x);

/// Add the Link to the page that follows last_id. filters stands for further parameters:
/// "&status=failed".
void exchange__link_next(exchange *x, const exchange_page *page, const char *filters,
                         const char *last_id);

/// Find which of the media types the body has, as its Content-Type says; types is NULL-terminated.
/// Only these are taken, and no content coding, so that no page of another origin can post unasked:
/// 415.
BF_MUST_CHECK bf_status exchange__check_body(exchange *x, const char *const *types,
                                             size_t *ret_type, bf_error *err);

/// Find the run of the path's first parameter. BF_ENOTFOUND also for what cannot be an id.
BF_MUST_CHECK bf_status exchange__find_run(const exchange *x, api_run *ret_run, bf_error *err);

/// Allow the answer to be cached without asking again: it never changes.
void exchange__cache_immutable(exchange *x);

/// Find the snapshot that the path's second parameter numbers. BF_ENOTFOUND: it is no number, or the
/// run has none of it yet.
BF_MUST_CHECK bf_status exchange__find_snapshot(const exchange *x, const api_run *of,
                                                uint64_t *ret_index, bf_error *err);

/// Name the response's body, a result of a snapshot, for a client that saves it: "000012.vti".
void exchange__name_snapshot(exchange *x, uint64_t index);

/// Name the state of what a GET asks for by an entity tag, given without quotes. True if the client
/// has that state already: the response is then a 304, and the handler is done.
bool exchange__is_unchanged(exchange *x, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// The same for what is cheap to write: the handler goes on and writes what a 200 has, so that the
/// transport knows its length.
bool exchange__match_etag(exchange *x, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// Allow the answer to be cached and asked for again by its entity tag: that of
/// exchange__is_unchanged() or exchange__match_etag(), or else one of its bytes.
void exchange__cache_revalidate(exchange *x);

/// Compare If-Match with the run. *ret_revision is the revision that a change of the run has to find:
/// the run's, API_ANY_REVISION where the request has no If-Match. BF_EINPUT, as a 412: the header names
/// other states.
BF_MUST_CHECK bf_status exchange__check_match(exchange *x, const api_run *record,
                                              uint64_t *ret_revision, bf_error *err);

/// Let the answer wait at most so many seconds (API_WAIT_MAX_S) for the end of the run or, if
/// is_for_change, for another revision. Does nothing when it has waited, or the run has ended.
void exchange__wait(exchange *x, const api_run *record, unsigned seconds, bool is_for_change);

/// The same for the end of the run where the client prefers it (`Prefer: wait=N`).
void exchange__prefer_wait(exchange *x, const api_run *record);

/// Runs: accept, list, show, stop, remove; and what accepting would say.
route_handler_fn handlers_runs_submit;
route_handler_fn handlers_runs_validate;
route_handler_fn handlers_runs_list;
route_handler_fn handlers_runs_show;
route_handler_fn handlers_runs_cancel;
route_handler_fn handlers_runs_remove;

/// What a run has given so far.
route_handler_fn handlers_results_scenario;
route_handler_fn handlers_results_summary;
route_handler_fn handlers_results_curve;

/// Its density snapshots.
route_handler_fn handlers_results_snapshots;
route_handler_fn handlers_results_snapshot;

/// The parts of a microscopic run.
route_handler_fn handlers_results_parts;
route_handler_fn handlers_results_parts_series;

/// All results at once.
route_handler_fn handlers_results_archive;

/// Event streams of one run and of several.
route_handler_fn handlers_results_events;
route_handler_fn handlers_results_events_of_runs;

/// Measured curves.
route_handler_fn handlers_measurements_add;
route_handler_fn handlers_measurements_list;
route_handler_fn handlers_measurements_show;
route_handler_fn handlers_measurements_remove;

/// Runs and measurements against each other.
route_handler_fn handlers_compare_runs;

/// The service itself.
route_handler_fn handlers_meta_examples;
route_handler_fn handlers_meta_example;
route_handler_fn handlers_meta_livez;
route_handler_fn handlers_meta_readyz;
route_handler_fn handlers_meta_metrics;
route_handler_fn handlers_meta_version;
route_handler_fn handlers_meta_openapi;
