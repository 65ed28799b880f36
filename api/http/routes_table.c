// The table of routes: one row each, with all that is known of it. Its parameters stand in routes_params.c.

#include "api/http/http_priv.h"
#include "api/http/routes.h"
#include "api/http/routes_params.h"
#include "api/results/annotations_json.h"
#include "api/results/grant_json.h"
#include "api/results/lease_json.h"
#include "api/results/measurement.h"
#include "api/scenario/submission.h"
#include "api/study/study_document.h"

#define PARAMS(...)                                                                                \
    (const param *const[])                                                                         \
    {                                                                                              \
        __VA_ARGS__, NULL                                                                          \
    }
#define NO_PARAMS                                                                                  \
    (const param *const[])                                                                         \
    {                                                                                              \
        NULL                                                                                       \
    }

#define CACHED "ETag Cache-Control"
#define UNCHANGED                                                                                  \
    {                                                                                              \
        304, NULL, CACHED, "Nothing has changed since the ETag in If-None-Match", NULL             \
    }

// Of a body in one of the formats that are not text.
#define PART(binary)                                                                               \
    {                                                                                              \
        206, NULL, CACHED " Accept-Ranges Content-Range Content-Disposition",                      \
            "The bytes that Range asked for", (binary)                                             \
    }

#define CONDITIONS &routes__if_match, &routes__if_none_match

// What every route has, then what it has of its own.
#define ANSWERS(method_, path_, handle_, tag_, id_, cost_, scope_, ...)                            \
    {                                                                                              \
        .method = (method_), .path = (path_), .handle = (handle_), .tag = (tag_), .id = (id_),     \
        .cost = API_COST_##cost_, .scope = API_SCOPE_##scope_, __VA_ARGS__                         \
    }

// What reads, and what changes, something that is stored.
#define READS(path_, handle_, tag_, id_, ...)                                                      \
    ANSWERS("GET", path_, handle_, tag_, id_, STORE, READ, __VA_ARGS__)
#define CHANGES(method_, path_, handle_, tag_, id_, ...)                                           \
    ANSWERS(method_, path_, handle_, tag_, id_, STORE, SUBMIT, .formats = "json", __VA_ARGS__)

#define RESULT(path_, handle_, id_, ...)                                                           \
    READS("/v1/runs/{id}/" path_, handle_, "Results", id_, __VA_ARGS__)

#define LEASES(method_, path_, handle_, id_, ...)                                                  \
    ANSWERS(method_, "/v1/leases" path_, handlers_leases_##handle_, "Workers", id_, STORE, WORK,   \
            __VA_ARGS__)

static const route table[] = {
    ANSWERS(
        "POST", "/v1/runs", handlers_runs_submit, "Runs", "submitRun", CHECK, SUBMIT,
        .formats = "json", .params = PARAMS(&routes__idempotency_key, &routes__prefer),
        .summary = "Accept a run; it is on disk before the answer is sent",
        .help =
            "The whole scenario is checked first: every fault that can be found is reported with "
            "its place. A 201 means that the run is on disk and will be solved, even if the daemon "
            "is restarted meanwhile. With `Prefer: wait=N` the answer comes when the run has "
            "ended. If the same scenario was solved before, the run ends at once with those "
            "results (`cached`), unless `fresh` is given. With Idempotency-Key a request can be "
            "repeated safely: the same key with another body is a 422. With `replications` of 2 "
            "and more the answer is a study of so many runs, at other substreams, and `Location` "
            "is its path; nothing waits for its end. 429 means that the client's quota of queued "
            "runs is used up, 503 that the queue is full, 507 that the disk has too little room.",
        .body = &submission_members, .refusals = "409",
        .answers = { { 201, "RunOrStudy",
                       "Location ETag Cache-Control Preference-Applied Idempotent-Replayed",
                       "The run was accepted, or the study of its replications" } }),
    READS("/v1/runs", handlers_runs_list, "Runs", "listRuns", .formats = "json",
          .params =
              PARAMS(&routes__run_status, &routes__run_model_word, &routes__run_label,
                     &routes__of_line, &routes__of_owner, &routes__run_study, &routes__run_search,
                     &routes__run_sort, &routes__run_created_from, &routes__run_created_before,
                     &routes__run_starred, &routes__run_where, &routes__run_count,
                     &routes__page_limit, &routes__run_cursor, CONDITIONS),
          .summary = "List runs, newest first or in another order",
          .help = "Filters narrow the list; the `next` link, where there is one, leads to the next "
                  "page. `search`, `line`, `starred`, another `sort` and `count` look at the "
                  "newest 50,000 runs of the list, `where` at the newest 10,000. Trials of a study "
                  "are listed with `study` only.",
          .refusals = "404",
          .answers = { { 200, "RunList", CACHED " Link", "A page of runs" }, UNCHANGED }),
    READS("/v1/runs/{id}", handlers_runs_show, "Runs", "getRun", .formats = "json",
          .params = PARAMS(&routes__run_id, &routes__wait_s, CONDITIONS),
          .summary = "Show a run: state, progress, times, links",
          .help = "The ETag changes with every change of the run. To follow a run, use its events "
                  "rather than polling.",
          .answers = { { 200, "Run", CACHED, "The run" }, UNCHANGED }),
    CHANGES(
        "PATCH", "/v1/runs/{id}", handlers_resources_annotate, "Runs", "annotateRun",
        .params = PARAMS(&routes__run_id, &routes__if_match),
        .summary = "Rename a run, give it another label or line, note something of it",
        .help =
            "A JSON Merge Patch (RFC 7396): what is missing stays, null empties. Results, and the "
            "name in the scenario, stay as they are. `application/merge-patch+json` is taken, too.",
        .body = &annotations_json_run,
        .answers = { { 200, "Run", "ETag Cache-Control", "The run" } }),
    CHANGES("DELETE", "/v1/runs/{id}", handlers_resources_remove, "Runs", "deleteRun",
            .params = PARAMS(&routes__run_id, &routes__if_match),
            .summary = "Stop a run if need be and remove it with its results",
            .help = "A run that is being solved is stopped first. This cannot be undone.",
            .answers = { { 204, NULL, "Cache-Control", "The run was removed" } }),
    CHANGES(
        "POST", "/v1/runs/{id}/cancel", handlers_resources_cancel, "Runs", "cancelRun",
        .params = PARAMS(&routes__run_id, &routes__if_match),
        .summary = "Stop a run and keep its results so far",
        .help = "The results so far are kept and can be read.", .refusals = "409",
        .answers = { { 200, "Run", "Cache-Control", "The run had not started and is cancelled" },
                     { 202, "Run", "Cache-Control", "The run will stop shortly" } }),
    RESULT("scenario", handlers_results_scenario, "getScenario", .formats = "json",
           .params = PARAMS(&routes__run_id, CONDITIONS),
           .summary = "The resolved scenario, every default filled in",
           .help = "Submitted again it gives the same results, byte by byte.",
           .answers = { { 200, "ResolvedScenario", CACHED, "The scenario" }, UNCHANGED }),
    RESULT("summary", handlers_results_summary, "getSummary", .formats = "json",
           .params = PARAMS(&routes__run_id, CONDITIONS),
           .summary = "The figures of a run that has ended",
           .help = "409 before the run has ended.", .refusals = "409",
           .answers = { { 200, "Summary", CACHED, "The figures" }, UNCHANGED }),
    RESULT("curve", handlers_results_curve, "getCurve", .formats = "json csv",
           .params = PARAMS(&routes__run_id, &routes__format, CONDITIONS),
           .summary = "The outflow curve so far",
           .help = "U(t) of the paper: how many parts are inside each counter at each time. Each "
                   "column of the run is a list in `columns`, under its name. As CSV the header is "
                   "`t_s`, the counters' ids, `left_domain` and, where some of the domain is under "
                   "no belt, `fallen`.",
           .answers = { { 200, "Curve", CACHED, "The curve" }, UNCHANGED }),
    RESULT(
        "photo_eyes", handlers_results_photo_eyes, "getPhotoEyes", .formats = "json csv",
        .params = PARAMS(&routes__run_id, &routes__format, CONDITIONS),
        .summary = "Changes of photo eyes, their actions, and drives that cargo holds back, so far",
        .help = "Each list by rising time, empty for a run without photo eyes and moving "
                "obstacles. As CSV the changes alone, as photo_eyes.csv. A run keeps the first "
                "100,000 of all; `is_cut` says when there are so many.",
        .answers = { { 200, "PhotoEyes", CACHED, "The changes, actions and drives" }, UNCHANGED }),
    RESULT("key_figures", handlers_results_figures, "getKeyFigures", .formats = "json csv",
           .params = PARAMS(&routes__run_id, &routes__format, CONDITIONS),
           .summary = "The key figures so far",
           .help = "Throughput, residence, queues, jams, gaps; at the end those of the summary. As "
                   "CSV the header is `figure,of,id,value,unit`. 409 while there are none.",
           .refusals = "409",
           .answers = { { 200, "KeyFigures", CACHED, "The key figures" }, UNCHANGED }),
    RESULT("snapshots", handlers_results_snapshots, "listSnapshots", .formats = "json",
           .params = PARAMS(&routes__run_id, CONDITIONS),
           .summary = "List the density snapshots so far",
           .help = "Their times, largest densities and addresses, and their common grid.",
           .answers = { { 200, "SnapshotList", CACHED, "The list" }, UNCHANGED }),
    RESULT("snapshots/{n}", handlers_results_snapshot, "getSnapshot", .text_cost = API_COST_WORK,
           .formats = "npy json csv png vti",
           .params =
               PARAMS(&routes__run_id, &routes__snapshot_n, &routes__format,
                      &routes__snapshot_count, &routes__picture_width, &routes__picture_colormap,
                      &routes__picture_max, CONDITIONS, &routes__range, &routes__if_range),
           .summary = "One density snapshot",
           .help = "Density on the grid, rows along y; 1 is close packing. A microscopic run has "
                   "its parts as a density on the same grid. A snapshot never changes and may be "
                   "cached without limit. 406 if the grid is too large for the format.",
           .refusals = "422",
           .answers = { { 200, "Snapshot", CACHED " Accept-Ranges Content-Disposition",
                          "The density" },
                        PART("npy png vti"),
                        UNCHANGED }),
    RESULT("snapshots.pvd", handlers_results_snapshots, "getSnapshotSeries", .formats = "pvd",
           .params = PARAMS(&routes__run_id, CONDITIONS),
           .summary = "The snapshots of results.zip?vtk=1 in time, for ParaView",
           .help = "Names the files of `results.zip?vtk=1` with their times: open it beside them.",
           .answers = { { 200, NULL, CACHED " Content-Disposition", "The series" }, UNCHANGED }),
    RESULT("parts/{n}", handlers_results_parts, "getParts", .text_cost = API_COST_WORK,
           .formats = "npy json csv vtp",
           .params = PARAMS(&routes__run_id, &routes__snapshot_n, &routes__format,
                            &routes__snapshot_count, CONDITIONS, &routes__range, &routes__if_range),
           .summary = "The parts at the time of a snapshot (micro)",
           .help = "One row for each part, in the order of their placement: place, heading, "
                   "velocity and spin. 404 also for a macroscopic run. The rows never change and "
                   "may be cached without limit.",
           .answers = { { 200, "Parts", CACHED " Accept-Ranges Content-Disposition", "The parts" },
                        PART("npy vtp"),
                        UNCHANGED }),
    RESULT(
        "parts.pvd", handlers_results_parts_series, "getPartsSeries", .formats = "pvd",
        .params = PARAMS(&routes__run_id, CONDITIONS),
        .summary = "The parts of results.zip?vtk=1 in time, for ParaView (micro)",
        .help =
            "Names the files of `results.zip?vtk=1` with their times. 404 for a macroscopic run.",
        .answers = { { 200, NULL, CACHED " Content-Disposition", "The series" }, UNCHANGED }),
    ANSWERS("GET", "/v1/runs/{id}/results.zip", handlers_results_archive, "Results", "getResults",
            WORK, READ, .formats = "zip",
            .params = PARAMS(&routes__run_id, &routes__with_vtk, CONDITIONS),
            .summary = "All results of a run that has ended",
            .help = "The files that `beltflow solve` writes: scenario, summary, curve, snapshots, "
                    "parts. 409 before the run has ended.",
            .refusals = "409",
            .answers = { { 200, NULL, CACHED " Content-Disposition", "The archive" }, UNCHANGED }),
    READS("/v1/runs/{id}/events", handlers_results_events, "Events", "followRun",
          .formats = "sse ndjson",
          .params = PARAMS(&routes__run_id, &routes__format, &routes__inline_grids,
                           &routes__last_event_id, &routes__last_event_id_header),
          .summary = "Follow a run: its events from the first one on, until it has ended",
          .help =
              "The stream begins with the run's first event and ends with its last one. A client "
              "that reconnects with Last-Event-ID misses no event and receives none twice.",
          .answers = { { 200, NULL, "Cache-Control X-Accel-Buffering", "The stream" },
                       { 204, NULL, "Cache-Control",
                         "All events were sent before; do not reconnect" } }),
    READS("/v1/events", handlers_results_events_of_runs, "Events", "followRuns",
          .formats = "sse ndjson",
          .params = PARAMS(&routes__followed_runs, &routes__format, &routes__inline_grids,
                           &routes__last_event_id, &routes__last_event_id_header),
          .summary = "Follow several runs in one stream",
          .help = "A browser has six connections to a host, so this one stream serves many runs. "
                  "Each event has the id of its run in `run`.",
          .refusals = "404",
          .answers = { { 200, NULL, "Cache-Control X-Accel-Buffering", "The stream" },
                       { 204, NULL, "Cache-Control",
                         "All events were sent before; do not reconnect" } }),
    READS("/v1/lines", handlers_lists_lines, "Runs", "listLines", .formats = "json",
          .params =
              PARAMS(&routes__of_owner, &routes__page_limit, &routes__page_cursor, CONDITIONS),
          .summary = "List the lines that runs and studies belong to, the last used one first",
          .help = "A line is there as long as a run or a study has its name as `line`. Lines of "
                  "one name of several owners are several lines.",
          .answers = { { 200, "LineList", CACHED " Link", "A page of lines" }, UNCHANGED }),
    ANSWERS(
        "POST", "/v1/studies", handlers_studies_submit, "Studies", "submitStudy", CHECK, SUBMIT,
        .formats = "json", .params = PARAMS(&routes__idempotency_key),
        .summary = "Accept a study; it is on disk before the answer is sent",
        .help =
            "A study varies numbers of a scenario, which JSON pointers name, solves each variant "
            "and says which is best and how sure that is. The whole document is checked first, as "
            "of POST /v1/runs. Feeds of the scenario may name stored measurements, and so may "
            "curves of `calibrate`: the stored document has their numbers.",
        .body = &study_document_members, .refusals = "409",
        .answers = { { 201, "Study", "Location ETag Cache-Control Idempotent-Replayed",
                       "The study was accepted" } }),
    READS("/v1/studies", handlers_lists_studies, "Studies", "listStudies", .formats = "json",
          .params = PARAMS(&routes__study_status, &routes__of_line, &routes__of_owner,
                           &routes__page_limit, &routes__page_cursor, CONDITIONS),
          .summary = "List studies, newest first",
          .help = "The `next` link, where there is one, leads to older studies.",
          .answers = { { 200, "StudyList", CACHED " Link", "A page of studies" }, UNCHANGED }),
    READS("/v1/studies/{id}", handlers_studies_show, "Studies", "getStudy", .formats = "json",
          .params = PARAMS(&routes__study_id, CONDITIONS),
          .summary = "Show a study: state, trials, times, links",
          .help = "The ETag changes with every change of the study, also when a trial has ended. "
                  "To follow a study, use its events rather than polling.",
          .answers = { { 200, "Study", CACHED, "The study" }, UNCHANGED }),
    CHANGES("PATCH", "/v1/studies/{id}", handlers_resources_annotate, "Studies", "annotateStudy",
            .params = PARAMS(&routes__study_id, &routes__if_match),
            .summary = "Rename a study, give it another line",
            .help = "A JSON Merge Patch, as of a run.", .body = &annotations_json_study,
            .answers = { { 200, "Study", "ETag Cache-Control", "The study" } }),
    CHANGES("DELETE", "/v1/studies/{id}", handlers_resources_remove, "Studies", "deleteStudy",
            .params = PARAMS(&routes__study_id, &routes__if_match),
            .summary = "Cancel a study if need be and remove it with its trials",
            .help = "The runs of its trials are removed soon after; runs that were made of trials "
                    "stay. This cannot be undone.",
            .answers = { { 204, NULL, "Cache-Control", "The study was removed" } }),
    CHANGES("POST", "/v1/studies/{id}/pause", handlers_resources_pause, "Studies", "pauseStudy",
            .params = PARAMS(&routes__study_id, &routes__if_match),
            .summary = "Begin no further trial of a study",
            .help = "Trials that run go on to their ends.", .refusals = "409",
            .answers = { { 200, "Study", "Cache-Control", "The study is paused" },
                         { 202, "Study", "Cache-Control", "The study will be paused shortly" } }),
    CHANGES("POST", "/v1/studies/{id}/resume", handlers_resources_resume, "Studies", "resumeStudy",
            .params = PARAMS(&routes__study_id, &routes__if_match),
            .summary = "Go on with a study that was paused",
            .help = "It goes on with the same trials as if it had not been paused.",
            .refusals = "409",
            .answers = { { 200, "Study", "Cache-Control", "The study goes on" } }),
    CHANGES("POST", "/v1/studies/{id}/cancel", handlers_resources_cancel, "Studies", "cancelStudy",
            .params = PARAMS(&routes__study_id, &routes__if_match),
            .summary = "End a study and keep its trials so far",
            .help = "Trials that wait or run are cancelled. What was found so far is kept.",
            .refusals = "409",
            .answers = { { 200, "Study", "Cache-Control", "The study is cancelled" },
                         { 202, "Study", "Cache-Control", "The study will end shortly" } }),
    READS("/v1/studies/{id}/document", handlers_trials_document, "Studies", "getStudyDocument",
          .formats = "json", .params = PARAMS(&routes__study_id, CONDITIONS),
          .summary = "The document of a study",
          .help = "What was submitted, with the numbers of the measurements that it named. "
                  "Submitted again it makes the same trials.",
          .answers = { { 200, "StudyDocument", CACHED, "The document" }, UNCHANGED }),
    READS("/v1/studies/{id}/trials", handlers_trials_list, "Studies", "listTrials",
          .formats = "json csv",
          .params = PARAMS(&routes__study_id, &routes__trials_from, &routes__trials_limit,
                           &routes__format, CONDITIONS),
          .summary = "The trials of a study so far, by number",
          .help = "As JSON page by page; the `next` link leads to the trials that follow. As CSV "
                  "all that have ended, a line each, as `beltflow study` writes them.",
          .answers = { { 200, "TrialList", CACHED " Link", "The trials", "json" },
                       { 200, NULL, CACHED, "The trials", "csv" },
                       UNCHANGED }),
    READS("/v1/studies/{id}/best", handlers_trials_best, "Studies", "getBest", .formats = "json",
          .params = PARAMS(&routes__study_id, CONDITIONS), .summary = "What a study found so far",
          .help = "The best point with its parameters, and its values with 95 % intervals where it "
                  "was replicated; of `screen` the points that the microscopic model confirmed, of "
                  "`calibrate` which parameters the curves determine; and reasons to doubt it. 409 "
                  "while there is nothing.",
          .refusals = "409",
          .answers = { { 200, "StudyBest", CACHED, "What was found" }, UNCHANGED }),
    READS("/v1/studies/{id}/events", handlers_trials_events, "Events", "followStudy",
          .formats = "sse ndjson",
          .params = PARAMS(&routes__study_id, &routes__format, &routes__last_event_id,
                           &routes__last_event_id_header),
          .summary = "Follow a study: each trial as it ends, until the study has ended",
          .help = "`trial` events have ids: the place of the trial among those that have ended. "
                  "`status` comes without an id when the study has changed, and `end` last. A "
                  "client that comes back with Last-Event-ID misses no trial and gets none twice; "
                  "204: it has seen the end.",
          .answers = { { 200, NULL, "Cache-Control X-Accel-Buffering", "The events" },
                       { 204, NULL, "Cache-Control",
                         "The study has ended, and the client has seen its last event" } }),
    ANSWERS("POST", "/v1/studies/{id}/trials/{number}/run", handlers_trials_run, "Studies",
            "runTrial", WORK, SUBMIT, .formats = "json",
            .params = PARAMS(&routes__study_id, &routes__trial_number, &routes__idempotency_key,
                             &routes__prefer),
            .summary = "Solve a trial again, as a run with all results",
            .help = "The runs of trials keep key figures and curves only. This run is no trial; "
                    "its results are those of the trial, bit by bit. 409: the trial has no run, or "
                    "it was removed.",
            .refusals = "409 413 422",
            .answers = { { 201, "Run",
                           "Location ETag Cache-Control Preference-Applied Idempotent-Replayed",
                           "The run was accepted" } }),
    ANSWERS("POST", "/v1/measurements", handlers_measurements_add, "Comparison", "addMeasurement",
            WORK, SUBMIT, .formats = "json",
            .params = PARAMS(&routes__csv_label, &routes__csv_counter, &routes__csv_kind),
            .summary = "Store a measured curve",
            .help =
                "A measured curve can take the place of a run in a comparison. Of CSV the first "
                "column after `t_s` is read; label and counter then come in the query, with JSON "
                "they are in the body. With `kind` the CSV is a profile or a list of arrivals that "
                "feeds of a scenario name by the id of the measurement. It is on disk before the "
                "answer is sent, and never changes. 409 when there are too many.",
            .body = &measurement_members, .body_formats = "json csv", .refusals = "409",
            .answers = { { 201, "StoredMeasurement", "Location Cache-Control", "It was stored" } }),
    READS("/v1/measurements", handlers_lists_measurements, "Comparison", "listMeasurements",
          .formats = "json",
          .params = PARAMS(&routes__measurement_label, &routes__page_limit, &routes__page_cursor,
                           CONDITIONS),
          .summary = "List measurements, newest first",
          .help = "The list has all but samples and texts; the `next` link, where there is one, "
                  "leads to older ones.",
          .answers = { { 200, "MeasurementList", CACHED " Link", "A page of them" }, UNCHANGED }),
    READS("/v1/measurements/{id}", handlers_measurements_show, "Comparison", "getMeasurement",
          .formats = "json csv",
          .params = PARAMS(&routes__measurement_id, &routes__format, CONDITIONS),
          .summary = "A measurement with its samples or its text",
          .help = "As CSV a measured curve is a curve with the counter as its column, a text for "
                  "feeds what was sent.",
          .answers = { { 200, "StoredMeasurement", CACHED, "The measurement" }, UNCHANGED }),
    CHANGES("DELETE", "/v1/measurements/{id}", handlers_measurements_remove, "Comparison",
            "deleteMeasurement", .params = PARAMS(&routes__measurement_id, &routes__if_match),
            .summary = "Remove a measurement", .help = "This cannot be undone.",
            .answers = { { 204, NULL, "Cache-Control", "The measurement was removed" } }),
    LEASES("POST", "", take, "takeLease", .formats = "json", .params = NO_PARAMS,
           .summary = "Lease jobs for a worker",
           .help = "Runs by themselves come before trials. A lease without jobs has no id. Where "
                   "the worker's solver is of another version than the service it is a 409.",
           .body = &lease_json_worker_members, .refusals = "409",
           .answers = { { 200, "Lease", "Cache-Control", "The lease" } }),
    LEASES("GET", "", list, "listWorkers", .formats = "json", .params = NO_PARAMS,
           .summary = "List workers and their leases", .refusals = "409",
           .help = "Those that were heard of lately.",
           .answers = { { 200, "WorkerList", "Cache-Control", "The workers" } }),
    LEASES("GET", "/{id}/jobs", jobs, "readLease", .formats = "frames",
           .params = PARAMS(&routes__lease_id), .summary = "The input of a lease's jobs",
           .refusals = "409", .help = "One job after the other, each as long as its `bytes` say.",
           .answers = { { 200, NULL, "Cache-Control", "The input" } }),
    LEASES("PUT", "/{id}/frames", deliver, "deliverFrames", .formats = "json",
           .params = PARAMS(&routes__lease_id), .summary = "Send bytes of the frames of jobs",
           .help =
               "Sections of 16 bytes, little-endian (u32 job, u32 n, u64 offset of the first byte "
               "in all of the job's frames), and n bytes. What came before is ignored; what leaves "
               "a gap, or has no place now, is not taken: `next` says where to go on.",
           .body = &lease_json_worker_members, .body_formats = "frames", .refusals = "409",
           .answers = { { 200, "LeaseJobStates", "Cache-Control", "What was taken" } }),
    LEASES("POST", "/{id}/renew", renew, "renewLease", .formats = "json",
           .params = PARAMS(&routes__lease_id),
           .summary = "Say that a worker goes on, and which jobs have ended",
           .help = "A job that has ended leaves the lease when all its bytes were taken. What is "
                   "not named is not the worker's any more.",
           .body = &lease_json_renewal_members, .refusals = "409",
           .answers = { { 200, "LeaseJobStates", "Cache-Control", "What is known of the jobs" } }),
    LEASES("DELETE", "/{id}", leave, "leaveLease", .formats = "json",
           .params = PARAMS(&routes__lease_id),
           .summary = "End a lease; what has not ended is for other workers",
           .help = "The worker asks for nothing more.", .refusals = "409",
           .answers = { { 204, NULL, "Cache-Control", "The lease is over" } }),
    ANSWERS("GET", "/v1/compare", handlers_compare_runs, "Comparison", "compareRuns", WORK, READ,
            .formats = "json",
            .params = PARAMS(&routes__compared_a, &routes__compared_b, &routes__compared_runs,
                             &routes__reference, &routes__column, &routes__with_densities),
            .summary =
                "Measures between the curves and densities of two to eight runs and measurements",
            .help = "Two by `a` and `b`, or two to eight by `runs`, each with the reference. "
                    "Curves are compared over the time that both have, densities at common times "
                    "if the grids are the same. A sentence says what the throughputs are to each "
                    "other. 409 if a run has nothing to compare yet, 422 if curves have no common "
                    "column or time; `errors` names the parameter.",
            .refusals = "404 409 422",
            .answers = { { 200, "Comparison", "Cache-Control", "The measures" } }),
    ANSWERS("POST", "/v1/validate", handlers_runs_validate, "Scenarios", "validateRun", CHECK, READ,
            .formats = "json", .params = PARAMS(&routes__start_parts),
            .summary = "Check a submission as POST /v1/runs does, and store nothing",
            .help = "The same checks and the same problems as when a run is submitted.",
            .body = &submission_members,
            .answers = { { 200, "Validation", "Cache-Control", "It would be accepted" } }),
    ANSWERS("GET", "/v1/examples", handlers_meta_examples, "Scenarios", "listExamples", NONE, READ,
            .formats = "json", .params = PARAMS(CONDITIONS), .summary = "List the ready scenarios",
            .help = "The paper's Examples 1 to 3 and more.",
            .answers = { { 200, "ExampleList", CACHED, "The list" }, UNCHANGED }),
    ANSWERS("GET", "/v1/examples/{name}", handlers_meta_example, "Scenarios", "getExample", NONE,
            READ, .formats = "json", .params = PARAMS(&routes__example_name, CONDITIONS),
            .summary = "One ready scenario",
            .help = "It can be submitted as it is, as `scenario` of a submission.",
            .answers = { { 200, "Scenario", CACHED, "The scenario" }, UNCHANGED }),
    ANSWERS("GET", "/v1/goods", handlers_meta_goods, "Scenarios", "listGoods", NONE, READ,
            .formats = "json", .params = PARAMS(CONDITIONS),
            .summary = "Usual goods, and how much surfaces rub on each other",
            .help =
                "What `goods`, `surface` and `surfaces` of a scenario stand for, with the sources.",
            .answers = { { 200, "Goods", CACHED, "The lists" }, UNCHANGED }),
    CHANGES(
        "POST", "/v1/runs/{id}/grants", handlers_resources_grant, "Grants", "grantRun",
        .params = PARAMS(&routes__run_id),
        .summary = "Share a run with somebody who has no access token",
        .help =
            "The answer has an access token that reads this run alone, until it expires or is "
            "revoked. The page opens with it as `#/runs/ID?grant=TOKEN`. 409 where the service has "
            "no tokens: then everybody may read. 429 where 50 grants of the sender's owner count.",
        .body = &grant_json_request_members, .refusals = "409",
        .answers = { { 201, "Grant", "Location Cache-Control", "The grant, with its token" } }),
    CHANGES("POST", "/v1/studies/{id}/grants", handlers_resources_grant, "Grants", "grantStudy",
            .params = PARAMS(&routes__study_id),
            .summary = "Share a study with somebody who has no access token",
            .help = "As of a run; the token reads the study, its trials and their runs.",
            .body = &grant_json_request_members, .refusals = "409",
            .answers = { { 201, "Grant", "Location Cache-Control", "The grant, with its token" } }),
    READS("/v1/grants", handlers_resources_list_grants, "Grants", "listGrants", .formats = "json",
          .params = NO_PARAMS, .summary = "List the grants of one's owner that count",
          .help = "Without their tokens, which are shown only when they are made. With `admin` "
                  "those of all owners.",
          .answers = { { 200, "GrantList", "Cache-Control", "The grants" } }),
    CHANGES("DELETE", "/v1/grants/{number}", handlers_resources_revoke_grant, "Grants",
            "revokeGrant", .params = PARAMS(&routes__grant_number), .summary = "Revoke a grant",
            .help = "Its token does not count any more.",
            .answers = { { 204, NULL, "Cache-Control", "The grant was revoked" } }),
    ANSWERS("POST", "/v1/tickets", handlers_meta_ticket, "Service", "makeTicket", NONE, ANY,
            .formats = "json", .params = NO_PARAMS,
            .summary = "A ticket that stands for the access token in a URL for a minute",
            .help = "For what a browser fetches by itself and so without a header: event streams, "
                    "downloads, images. As `ticket` in the query of a GET or HEAD it allows what "
                    "the token allows, as often as wanted; a stream that it began goes on. It does "
                    "not count any more when the token is revoked or the daemon is started again.",
            .answers = { { 200, "Ticket", "Cache-Control", "The ticket" } }),
    READS("/v1/quota", handlers_meta_quota, "Service", "getQuotas", .formats = "json",
          .params = NO_PARAMS, .summary = "What the owner of the access token uses and may use",
          .help = "Where a quota of runs that wait or of CPU time is used up, submissions are a "
                  "429; where it is that of bytes, a 507. Runs that were accepted wait until CPU "
                  "time or bytes are left, and those of others overtake them. Without tokens there "
                  "are no quotas of owners.",
          .answers = { { 200, "Quotas", "Cache-Control", "The quotas" } }),
    ANSWERS("GET", "/livez", handlers_meta_livez, "Service", "getLiveness", HEALTH, NONE,
            .formats = "json", .params = NO_PARAMS, .summary = "Is the daemon alive?",
            .help = "Answers as long as the program runs, even when all connections for other "
                    "requests are taken.",
            .answers = { { 200, "Alive", "Cache-Control", "The daemon is alive" } }),
    ANSWERS("GET", "/readyz", handlers_meta_readyz, "Service", "getReadiness", HEALTH, NONE,
            .formats = "json", .params = NO_PARAMS, .summary = "Can the daemon accept runs?",
            .help = "503 while the daemon stops or its store cannot be written.",
            .answers = { { 200, "Ready", "Cache-Control", "The daemon can accept runs" } }),
    ANSWERS("GET", "/metrics", handlers_meta_metrics, "Service", "getMetrics", HEALTH, METRICS,
            .formats = "prometheus", .params = NO_PARAMS,
            .summary = "The service's figures for Prometheus",
            .help =
                "Requests, streams, queue, runs, solvers, store and process, in the text format "
                "0.0.4. With the scope `metrics`, also what owners use and when tokens expire.",
            .answers = { { 200, NULL, "Cache-Control", "The figures" } }),
    ANSWERS("GET", "/version", handlers_meta_version, "Service", "getVersion", NONE, NONE,
            .formats = "json", .params = PARAMS(CONDITIONS), .summary = "Which build this is",
            .help = "For bug reports.",
            .answers = { { 200, "Version", CACHED, "The build" }, UNCHANGED }),
    ANSWERS("GET", "/problems/{kind}", handlers_meta_problem, "Service", "getProblemKind", NONE,
            NONE, .formats = "json", .params = PARAMS(&routes__problem_word, CONDITIONS),
            .summary = "What a kind of problem means",
            .help = "The `type` of a problem document leads here.",
            .answers = { { 200, "ProblemKind", CACHED, "The kind of problem" }, UNCHANGED }),
    ANSWERS("GET", "/openapi.json", handlers_meta_openapi, "Service", "getDocument", STORE, NONE,
            .formats = "json", .params = PARAMS(CONDITIONS),
            .summary = "This API as an OpenAPI 3.1 document",
            .help = "Generated from the tables by which the daemon handles requests.",
            .answers = { { 200, "Document", CACHED, "This document" }, UNCHANGED }),
};

const route *routes_list(size_t *ret_n)
{
    *ret_n = sizeof table / sizeof *table;
    return table;
}
