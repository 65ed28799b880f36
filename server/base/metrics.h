/// Figures for operators, served at /metrics in Prometheus' text form: one table, and counting.
///
/// Values are whole numbers of the metric's unit, but nanoseconds where the unit is seconds. Labels are
/// words from short lists: route templates and never ids, so that no client makes series grow.
///
/// Threads  counting is a relaxed atomic addition, from any thread, without a lock. Values read by
///          metrics_write() are each true at some moment during the call.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

/// X(symbol, type, name, unit, labels, help). Type: COUNTER, GAUGE, or a histogram of durations
/// (TIMES) or of sizes (SIZES). A name ends with its unit, and with _total if it is a counter's.
/// Labels: one of METRICS_LABELS_LIST (base_priv.h).
#define METRICS_LIST(X)                                                                            \
    X(REQUESTS, COUNTER, "beltflow_http_requests_total", "", EXCHANGE, "Requests answered")        \
    X(REQUEST_TIMES, TIMES, "beltflow_http_request_duration_seconds", "seconds", ROUTE,            \
      "From a complete header to the end of the answer, without streams and waits")                \
    X(REQUESTS_NOW, GAUGE, "beltflow_http_requests_in_flight", "", NONE,                           \
      "Requests that are being answered, streams among them")                                      \
    X(CONNECTIONS, GAUGE, "beltflow_http_connections", "", NONE, "Open connections")               \
    X(STREAMS, GAUGE, "beltflow_http_streams", "", NONE, "Open event streams")                     \
    X(STREAM_BYTES, COUNTER, "beltflow_http_stream_bytes_total", "bytes", NONE,                    \
      "Bytes of event streams handed to connections")                                              \
    X(QUEUE_LENGTH, GAUGE, "beltflow_queue_length", "", NONE, "Runs that wait")                    \
    X(QUEUE_AGE, GAUGE, "beltflow_queue_oldest_age_seconds", "seconds", NONE,                      \
      "Age of the oldest run that waits; 0 if none does")                                          \
    X(QUEUE_PREDICTED, GAUGE, "beltflow_queue_predicted_seconds", "seconds", NONE,                 \
      "CPU time that the runs that wait will take, as the oldest ones are predicted")              \
    X(QUOTA_REFUSALS, COUNTER, "beltflow_quota_refusals_total", "", QUOTA,                         \
      "Submissions that were refused for a quota of their client or owner")                        \
    X(RUNS, GAUGE, "beltflow_runs", "", STATE, "Stored runs")                                      \
    X(SOLVER_STEPS, COUNTER, "beltflow_solver_steps_total", "", MODEL, "Steps solved")             \
    X(SOLVER_RATE, GAUGE, "beltflow_solver_steps_per_second", "", MODEL,                           \
      "Steps a second of the runs that are being solved, together")                                \
    X(SOLVER_ITEMS, GAUGE, "beltflow_solver_items", "", MODEL,                                     \
      "Cells (macro) or parts (micro) of the runs that are being solved")                          \
    X(FRAMES, COUNTER, "beltflow_frames_stored_total", "", FRAME,                                  \
      "Frames of runs that were stored, by kind")                                                  \
    X(STORE_SIZE, GAUGE, "beltflow_store_size_bytes", "bytes", NONE, "The database's file")        \
    X(STORE_LOG_SIZE, GAUGE, "beltflow_store_wal_size_bytes", "bytes", NONE,                       \
      "The database's write-ahead log")                                                            \
    X(STORE_DISK, GAUGE, "beltflow_store_disk_free_bytes", "bytes", NONE,                          \
      "Free on the disk of the store")                                                             \
    X(RUNS_SOLVED, COUNTER, "beltflow_runs_solved_total", "", MODEL,                               \
      "Runs and trials that succeeded")                                                            \
    X(RUN_TIME, COUNTER, "beltflow_run_wall_seconds_total", "seconds", MODEL,                      \
      "Time that these took, all attempts together")                                               \
    X(STORE_SUMS, GAUGE, "beltflow_store_page_checksums", "", NONE,                                \
      "1: every page of the database has a checksum; 0: a version without them made it")           \
    X(COMMIT_TIMES, TIMES, "beltflow_store_commit_duration_seconds", "seconds", NONE,              \
      "Transactions, from their begin until they are synced")                                      \
    X(COMMIT_SIZES, SIZES, "beltflow_store_commit_operations", "", NONE,                           \
      "Operations that one transaction committed together")                                        \
    X(COMMIT_FAILURES, COUNTER, "beltflow_store_commit_failures_total", "", NONE,                  \
      "Transactions that failed as a whole")                                                       \
    X(CHILD_EXITS, COUNTER, "beltflow_child_exits_total", "", REASON, "Ends of solver processes")  \
    X(PULL_WORKERS, GAUGE, "beltflow_pull_workers", "", NONE, "Workers that were heard of lately") \
    X(PULL_LEASES, GAUGE, "beltflow_pull_leases", "", NONE, "Leases of workers")                   \
    X(PULL_JOBS, GAUGE, "beltflow_pull_jobs", "", PLACE, "Attempts at runs, by where they are")    \
    X(PULL_LOST, COUNTER, "beltflow_pull_jobs_lost_total", "", NONE,                               \
      "Attempts that were leased and whose worker fell silent, left or forgot them")               \
    X(PULL_FAULTS, COUNTER, "beltflow_pull_faults_total", "", NONE,                                \
      "Attempts that ended by a fault of their worker")                                            \
    X(PULL_DUPLICATES, COUNTER, "beltflow_pull_duplicates_total", "", MATCH,                       \
      "Ends of runs that another worker had ended before, by whether the digests are the same")    \
    X(SLURM_WANTED, GAUGE, "beltflow_slurm_workers_wanted", "", NONE,                              \
      "Workers that the runs which wait or are being solved would keep busy, up to slurm_workers") \
    X(SLURM_TASKS, GAUGE, "beltflow_slurm_tasks", "", TASK, "Tasks in Slurm's queue, by state")    \
    X(SLURM_SUBMITTED, COUNTER, "beltflow_slurm_tasks_submitted_total", "", NONE,                  \
      "Tasks that Slurm took")                                                                     \
    X(SLURM_CANCELLED, COUNTER, "beltflow_slurm_tasks_cancelled_total", "", NONE,                  \
      "Tasks that Slurm could not launch and held")                                                \
    X(SLURM_FAILURES, COUNTER, "beltflow_slurm_command_failures_total", "", NONE,                  \
      "Commands of Slurm that failed")                                                             \
    X(CONFINEMENT, GAUGE, "beltflow_solver_confinement", "", LAYER,                                \
      "1: the kernel keeps solvers from these; 0: it cannot")                                      \
    X(LOG_LINES, COUNTER, "beltflow_log_lines_total", "", LEVEL, "Lines written to the log")       \
    X(RELOAD_GOOD, GAUGE, "beltflow_config_last_reload_successful", "", NONE,                      \
      "1 unless the settings' file was found at fault when it was last read")                      \
    X(BUILD, GAUGE, "beltflow_build_info", "", BUILD, "1; the build stands in the labels")         \
    X(PROCESS_START, GAUGE, "process_start_time_seconds", "seconds", NONE,                         \
      "Start of the process, Unix time")                                                           \
    X(PROCESS_TIME, COUNTER, "process_cpu_seconds_total", "seconds", NONE,                         \
      "CPU time of the process, user and system")                                                  \
    X(PROCESS_RESIDENT, GAUGE, "process_resident_memory_bytes", "bytes", NONE,                     \
      "Resident memory of the process")                                                            \
    X(PROCESS_VIRTUAL, GAUGE, "process_virtual_memory_bytes", "bytes", NONE,                       \
      "Virtual memory of the process")                                                             \
    X(PROCESS_FDS, GAUGE, "process_open_fds", "", NONE, "Open file descriptors")                   \
    X(PROCESS_FDS_MAX, GAUGE, "process_max_fds", "", NONE, "Most file descriptors")

/// Why a solver's process ended, X(symbol, word): its run came to an end or was stopped in order, its
/// input was at fault, it failed, a signal ended it, it was out of time, or it was ended because its results were
/// larger than run_output_bytes.
#define METRICS_REASON_LIST(X)                                                                     \
    X(METRICS_EXIT_OK, "ok")                                                                       \
    X(METRICS_EXIT_INPUT, "input")                                                                 \
    X(METRICS_EXIT_ERROR, "error")                                                                 \
    X(METRICS_EXIT_SIGNAL, "signal")                                                               \
    X(METRICS_EXIT_TIMEOUT, "timeout")                                                             \
    X(METRICS_EXIT_OUTPUT, "output")

/// The reasons.
typedef enum metrics_reason {
#define X(reason, word) reason,
    METRICS_REASON_LIST(X)
#undef X
        METRICS_EXIT_COUNT
} metrics_reason;

/// Quotas, X(symbol, word): settings.
#define METRICS_QUOTA_LIST(X)                                                                      \
    X(METRICS_QUOTA_CLIENT, "queue_share")                                                         \
    X(METRICS_QUOTA_QUEUE, "owner_queue")                                                          \
    X(METRICS_QUOTA_CPU, "owner_cpu_s")                                                            \
    X(METRICS_QUOTA_BYTES, "owner_bytes")

/// The quotas.
typedef enum metrics_quota {
#define X(quota, word) quota,
    METRICS_QUOTA_LIST(X)
#undef X
        METRICS_QUOTA_COUNT
} metrics_quota;

/// Where an attempt is that workers take, X(symbol, word).
#define METRICS_PLACE_LIST(X)                                                                      \
    X(METRICS_PLACE_WAITING, "waiting")                                                            \
    X(METRICS_PLACE_LEASED, "leased")

/// The places.
typedef enum metrics_place {
#define X(place, word) place,
    METRICS_PLACE_LIST(X)
#undef X
        METRICS_PLACE_COUNT
} metrics_place;

/// Where a task of Slurm is, X(symbol, word).
#define METRICS_TASK_LIST(X)                                                                       \
    X(METRICS_TASK_PENDING, "pending")                                                             \
    X(METRICS_TASK_RUNNING, "running")

/// The states.
typedef enum metrics_task {
#define X(task, word) task,
    METRICS_TASK_LIST(X)
#undef X
        METRICS_TASK_COUNT
} metrics_task;

/// How the ends of two attempts compare, X(symbol, word).
#define METRICS_MATCH_LIST(X)                                                                      \
    X(METRICS_MATCH_EQUAL, "equal")                                                                \
    X(METRICS_MATCH_UNEQUAL, "unequal")

/// The results of that.
typedef enum metrics_match {
#define X(match, word) match,
    METRICS_MATCH_LIST(X)
#undef X
        METRICS_MATCH_COUNT
} metrics_match;

/// What solvers are kept from, X(symbol, word); server/run/confinement.h says how.
#define METRICS_LAYER_LIST(X)                                                                      \
    X(METRICS_LAYER_FILES, "files")                                                                \
    X(METRICS_LAYER_TCP, "tcp")                                                                    \
    X(METRICS_LAYER_SIGNALS, "signals")                                                            \
    X(METRICS_LAYER_CALLS, "system_calls")

/// The layers of confinement.
typedef enum metrics_layer {
#define X(layer, word) layer,
    METRICS_LAYER_LIST(X)
#undef X
        METRICS_LAYER_COUNT
} metrics_layer;

/// The metrics.
typedef enum metrics_id {
#define X(symbol, type, name, unit, labels, help) METRICS_##symbol,
    METRICS_LIST(X)
#undef X
        METRICS_COUNT
} metrics_id;

/// Add to a counter or gauge; series is the label's value as a number of its list, 0 without labels.
void metrics_add(metrics_id metric, size_t series, int64_t n);

/// Set a gauge, or a counter whose value is counted elsewhere.
void metrics_set(metrics_id metric, size_t series, int64_t value);

/// Count a value in a histogram.
void metrics_observe(metrics_id metric, size_t series, int64_t value);

/// The present value of a counter or gauge.
int64_t metrics_value(metrics_id metric, size_t series);

/// Values of the route label without a route's template: files of the page, and requests without a route.
#define METRICS_PAGE     "page"
#define METRICS_NO_ROUTE "none"

/// Count a request that was answered: the template of its route or one of the words above, its
/// method, its status, and how long it took, ns (-1: a stream, which is not timed).
void metrics_count_request(const char *template, const char *method, int status, int64_t ns);

/// Bring the process_... metrics up to date, all but its start: they are read from /proc.
void metrics_read_process(void);

/// Append all metrics in Prometheus' text form, version 0.0.4. BF_ENOMEM.
BF_MUST_CHECK bf_status metrics_write(bf_buffer *out, bf_error *err);
