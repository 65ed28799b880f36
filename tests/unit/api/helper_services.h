/// A daemon in a few arrays: the services table for tests of the API, and requests to it.

#pragma once

#include "api/http/exchange.h"
#include "api/services.h"

#include <jansson.h>

enum {
    HELPER_RUNS_MAX = 8,
    HELPER_EVENTS_MAX = 64,
    HELPER_SNAPSHOTS_MAX = 401,
    HELPER_CELLS = 6,
    HELPER_VALUES = 12,
    HELPER_MEASUREMENTS_MAX = 8,
    HELPER_STUDIES_MAX = 4,
    HELPER_TRIALS_MAX = 8
};

/// A measurement.
typedef struct helper_measurement {
    api_measurement about; ///< id "" once removed
    double t[8];           ///< about.n_samples
    double counts[8];      ///< same
    char csv[256];         ///< of one that is no curve
} helper_measurement;

/// A run with its results.
typedef struct helper_run {
    api_run record;                                ///< what find() gives; id "" once removed
    const char *scenario;                          ///< NULL: one of nothing but a duration
    const char *summary;                           ///< NULL: none
    const char *figures;                           ///< all key figures; NULL: none
    const char *columns;                           ///< of the curve
    size_t n_columns;                              ///< of them
    double t[8];                                   ///< n_samples of the record
    double values[16];                             ///< rows
    api_snapshot snapshots[HELPER_SNAPSHOTS_MAX];  ///< n_snapshots of the record
    float rho[HELPER_SNAPSHOTS_MAX][HELPER_CELLS]; ///< their grids: 2 rows of 3
    bf_grid grid;                                  ///< of the snapshots
    api_parts parts;                               ///< of the snapshots; all have the same rows
    double rows[HELPER_VALUES];                    ///< of the parts
} helper_run;

/// A study with its trials.
typedef struct helper_study {
    api_study about;                     ///< id "" once removed
    const char *best;                    ///< NULL: nothing yet
    api_trial trials[HELPER_TRIALS_MAX]; ///< about.n_trials
} helper_study;

/// The daemon.
typedef struct helper_daemon {
    helper_run runs[HELPER_RUNS_MAX];                         ///< oldest first
    size_t n_runs;                                            ///< of them
    api_event events[HELPER_EVENTS_MAX];                      ///< rising ids
    size_t n_events;                                          ///< of them
    helper_measurement measurements[HELPER_MEASUREMENTS_MAX]; ///< oldest first
    size_t n_measurements;                                    ///< of them
    helper_study studies[HELPER_STUDIES_MAX];                 ///< oldest first
    size_t n_studies;                                         ///< of them
    char document[4096]; ///< of the study that was accepted last
    char columns[512];   ///< of its trials
    bf_status
        refusal; ///< not BF_OK: list, submit, submit_study, add_measurement, ready fail with it
    api_list_query last_query; ///< what list() was asked
    const char *last_key;      ///< what list() says of the last run of a page; NULL: ""
    api_submission submitted;  ///< last accepted, without its buffers
    size_t n_submitted;        ///< accepted so far
    bool is_replay;            ///< submit says that its answer is given again
    unsigned
        n_changes_between; ///< calls of cancel and remove, of runs and studies, before which they change
} helper_daemon;

/// The table of *d.
api_services helper_services(helper_daemon *d);

/// Fill in the functions of measurements, and of studies.
void helper_serve_measurements(api_services *services);
void helper_serve_studies(api_services *services);

/// Add a run in a state with two samples of "upstream,left_domain" and two snapshots on a 3 x 2 grid,
/// created one second after the one before.
helper_run *helper_add_run(helper_daemon *d, run_state state);

/// Add a measurement of a counter with two samples, 192 at 0 s and 191 at 0.1 s.
helper_measurement *helper_add_measurement(helper_daemon *d, const char *counter);

/// Add a study with one parameter, "/p", and one value, "v".
helper_study *helper_add_study(helper_daemon *d, api_study_state state);

/// Add a trial whose parameter is 10 times its number; one at an end is the next one that has ended, with the value 0.5.
api_trial *helper_add_trial(helper_study *of, api_trial_state state);

/// Add an event; data must outlive *d. Returns its id.
uint64_t helper_add_event(helper_daemon *d, helper_run *of, api_event_type type, const char *data);

/// Send a request. headers is "Name: value" lines, ended by '\n' each (NULL: none); query and body
/// may be NULL. *response is the caller's: api_response_fini().
void helper_request(helper_daemon *d, const char *method, const char *path, const char *query,
                    const char *headers, const char *body, api_response *response);

/// The value of a response header, or NULL.
const char *helper_header(const api_response *response, const char *name);

/// The body as JSON; fails the test if it is none. json_decref().
json_t *helper_json(const api_response *response);
