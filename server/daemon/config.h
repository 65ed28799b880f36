/// Settings of the daemon, as one table: file (INI), environment and flags, in rising precedence.
/// Help text, sample configuration and checks follow from the table.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"
#include "server/base/log.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// X(name, kind, default, least, most, when, help): name is the key in the file; BELTFLOW_<NAME> in the
/// environment; --name on the command line, with '-' for '_'. A change takes effect when the
/// settings are reloaded (RELOAD, by SIGHUP), or only after a RESTART.
#define CONFIG_LIST(X)                                                                             \
    X(listen, TEXT, "127.0.0.1:8080", 0, 0, RESTART, "address and port; port 0 picks a free one")  \
    X(plaintext, TEXT, "loopback", 0, 0, RESTART,                                                  \
      "loopback, proxy or open: who may reach the address to listen on without TLS")               \
    X(access, TEXT, "tokens", 0, 0, RESTART,                                                       \
      "tokens or open: whether a store that was used with tokens may be served when there are "    \
      "none")                                                                                      \
    X(data, TEXT, "beltflow-data", 0, 0, RESTART, "directory of the store, created if missing")    \
    X(web, TEXT, "", 0, 0, RELOAD, "directory of the page's files; empty: beside the program")     \
    X(program, TEXT, "", 0, 0, RESTART,                                                            \
      "what solves a run; empty: beltflow-worker beside beltflowd")                                \
    X(executor, TEXT, "local", 0, 0, RESTART,                                                      \
      "local: this machine solves runs; pull: workers that ask for them; slurm: those that Slurm " \
      "starts")                                                                                    \
    X(workers, NUMBER, "0", 0, 64, RELOAD, "runs that are solved at once; 0: one for each core")   \
    X(threads, NUMBER, "1", 1, 256, RELOAD, "threads of each run")                                 \
    X(run_memory_bytes, NUMBER, "8589934592", 0, 1e15, RELOAD,                                     \
      "address space of a run; 0: unlimited")                                                      \
    X(run_cpu_s, NUMBER, "86400", 0, 1e9, RELOAD, "CPU seconds of a run; 0: unlimited")            \
    X(run_output_bytes, NUMBER, "34359738368", 0, 1e15, RELOAD,                                    \
      "of results that a run may send; 0: unlimited")                                              \
    X(run_stall_s, NUMBER, "900", 0, 1e9, RELOAD,                                                  \
      "seconds without a step after which a run fails; 0: unlimited")                              \
    X(run_wall_s, NUMBER, "604800", 0, 1e9, RELOAD,                                                \
      "seconds that a run may take, all attempts together; 0: unlimited")                          \
    X(run_attempts, NUMBER, "5", 0, 1000, RESTART,                                                 \
      "at a run that fail or end with the daemon, until it fails; 0: any number")                  \
    X(checkpoint_ms, NUMBER, "5000", 10, 3600000, RELOAD, "between checkpoints of a run")          \
    X(queue_limit, NUMBER, "1000", 1, 1000000, RELOAD, "runs that may wait")                       \
    X(idempotency_hours, NUMBER, "24", 1, 8760, RESTART,                                           \
      "that answers to Idempotency-Key are kept")                                                  \
    X(retention_days, NUMBER, "0", 0, 36500, RELOAD,                                               \
      "that runs are kept after their end; 0: for ever")                                           \
    X(retention_runs, NUMBER, "0", 0, 1e9, RELOAD, "ended runs that are kept; 0: all")             \
    X(retention_bytes, NUMBER, "0", 0, 1e15, RELOAD,                                               \
      "of the store that runs may fill; 0: no limit")                                              \
    X(stop_grace_ms, NUMBER, "5000", 0, 600000, RELOAD,                                            \
      "for runs to be handed back when stopping")                                                  \
    X(http_threads, NUMBER, "2", 1, 64, RESTART, "threads that serve connections")                 \
    X(request_threads, NUMBER, "8", 1, 256, RESTART,                                               \
      "threads for requests that write to the store")                                              \
    X(connections, NUMBER, "1200", 8, 100000, RESTART, "connections at once")                      \
    X(connections_per_address, NUMBER, "300", 0, 100000, RESTART,                                  \
      "of them from one client; 0: no limit")                                                      \
    X(streams, NUMBER, "1000", 1, 100000, RELOAD, "event streams at once")                         \
    X(downloads, NUMBER, "16", 1, 10000, RELOAD, "results.zip that are sent at once")              \
    X(waits, NUMBER, "1000", 0, 100000, RELOAD, "requests that wait for a run at once")            \
    X(queue_share, NUMBER, "250", 0, 1000000, RELOAD,                                              \
      "runs of one client that may wait; 0: no limit")                                             \
    X(requests_per_minute, NUMBER, "6000", 0, 1000000, RELOAD, "of one client; 0: no limit")       \
    X(work_per_minute, NUMBER, "600", 0, 1000000, RELOAD, "requests that make work; 0: no limit")  \
    X(owner_queue, NUMBER, "250", 0, 1000000, RELOAD, "runs of one owner that may wait; 0: all")   \
    X(owner_cpu_s, NUMBER, "864000", 0, 1e12, RELOAD,                                              \
      "CPU seconds of one owner's runs in 24 hours; 0: no limit")                                  \
    X(owner_bytes, NUMBER, "274877906944", 0, 1e15, RELOAD,                                        \
      "of results that one owner may keep; 0: no limit")                                           \
    X(owner_measurements, NUMBER, "200", 0, 2000, RELOAD,                                          \
      "measurements that one owner may keep; 0: no limit")                                         \
    X(owner_studies, NUMBER, "100", 0, 1000, RELOAD,                                               \
      "studies of one owner that have not ended; 0: no limit")                                     \
    X(hosts, TEXT, "", 0, 0, RESTART,                                                              \
      "names that requests may be sent to, beside the address to listen on")                       \
    X(trusted_proxies, TEXT, "", 0, 0, RESTART, "addresses whose X-Forwarded-For is believed")     \
    X(cors_origins, TEXT, "", 0, 0, RESTART,                                                       \
      "pages elsewhere that may read answers: origins, or *")                                      \
    X(body_bytes, NUMBER, "1048576", 1024, 1073741824, RELOAD, "largest body of a request")        \
    X(answers_bytes, NUMBER, "1073741824", 1048576, 1e15, RELOAD,                                  \
      "memory of all answers together")                                                            \
    X(header_deadline_ms, NUMBER, "5000", 100, 600000, RELOAD, "for a complete request header")    \
    X(body_deadline_ms, NUMBER, "20000", 100, 600000, RELOAD, "for a complete request body")       \
    X(heartbeat_ms, NUMBER, "15000", 100, 600000, RELOAD, "between comments on idle streams")      \
    X(slurm_url, TEXT, "", 0, 0, RESTART, "where workers that Slurm starts reach this service")    \
    X(slurm_token_file, TEXT, "", 0, 0, RESTART,                                                   \
      "file with the access token of these workers, on compute nodes; empty: none")                \
    X(slurm_program, TEXT, "", 0, 0, RESTART,                                                      \
      "the program beltflow on compute nodes; empty: its path here, beside beltflowd")             \
    X(slurm_template, TEXT, "", 0, 0, RESTART,                                                     \
      "file with the batch script that starts a worker; empty: the one of beltflowd")              \
    X(slurm_workers, NUMBER, "8", 1, 10000, RESTART, "workers that Slurm is to run at most")       \
    X(slurm_cores, NUMBER, "4", 1, 1024, RESTART, "cores of a worker that Slurm starts")           \
    X(slurm_walltime_s, NUMBER, "14400", 300, 31536000, RESTART,                                   \
      "seconds that Slurm lets a worker run")                                                      \
    X(slurm_idle_s, NUMBER, "120", 5, 86400, RESTART,                                              \
      "seconds without a run until a worker that Slurm started ends")                              \
    X(slurm_interval_s, NUMBER, "60", 1, 3600, RESTART, "seconds between looks at Slurm's queue")  \
    X(check_every, NUMBER, "100", 0, 1000000, RESTART,                                             \
      "one of so many runs is solved again by a worker with another token, and compared; 0: none") \
    X(access_log, NUMBER, "0", 0, 1, RELOAD,                                                       \
      "1: a line in the log for each request, with its client")                                    \
    X(log_level, TEXT, "info", 0, 0, RELOAD, "error, warn, info or debug")

enum {
    CONFIG_TEXT_SIZE = 512,   ///< bytes of a text setting with its terminator
    CONFIG_ORIGIN_SIZE = 160, ///< bytes of the word where it comes from with its terminator
};

/// The settings by number.
enum {
#define X(name, kind, initial, least, most, when, help) CONFIG_##name,
    CONFIG_LIST(X)
#undef X
        CONFIG_COUNT ///< how many there are
};

/// The settings.
typedef struct config {
#define CONFIG_TEXT(name)                               char name[CONFIG_TEXT_SIZE];
#define CONFIG_NUMBER(name)                             uint64_t name;
#define X(name, kind, initial, least, most, when, help) CONFIG_##kind(name)
    CONFIG_LIST(X)
#undef X
#undef CONFIG_TEXT
#undef CONFIG_NUMBER
    char origins[CONFIG_COUNT]
                [CONFIG_ORIGIN_SIZE]; ///< its origin: "default", "file:7", "--workers"
} config;

/// One row of the table.
typedef struct config_row {
    const char *name;    ///< key in the file
    const char *initial; ///< default, as text
    const char *help;    ///< one line
    bool can_reload;     ///< a change counts without a restart
} config_row;

/// The table, in its order; *ret_n is how many rows it has. Static.
const config_row *config_rows(size_t *ret_n);

/// The defaults of the table.
void config_init(config *c);

/// Set one setting from text. where is the origin ("--workers", "beltflowd.conf:7"), for the error.
/// BF_EINPUT: unknown (with a suggestion), not a number, out of range, or a text that a line of a file
/// could not say.
BF_MUST_CHECK bf_status config_set(config *c, const char *name, const char *value,
                                   const char *where, bf_error *err);

/// Read an INI file of `name = value` lines. BF_ESYSTEM: cannot be read; BF_EINPUT with its line.
BF_MUST_CHECK bf_status config_read_file(config *c, const char *path, bf_error *err);

/// Take the BELTFLOW_... variables that name a setting; others are left alone.
BF_MUST_CHECK bf_status config_read_environment(config *c, bf_error *err);

/// Set empty paths to files in the folder of the running program: program, slurm_program, and
/// web if there is one (installed, or in a build tree; else it stays empty).
/// BF_ELIMIT: a path is too long.
BF_MUST_CHECK bf_status config_locate(config *c, const char *folder, bf_error *err);

/// Who solves runs, X(symbol, word of `executor`): this machine; workers that ask; workers that Slurm starts, which ask.
#define CONFIG_EXECUTOR_LIST(X)                                                                    \
    X(CONFIG_LOCAL, "local")                                                                       \
    X(CONFIG_PULL, "pull")                                                                         \
    X(CONFIG_SLURM, "slurm")

/// The kinds.
typedef enum config_executor {
#define X(kind, word) kind,
    CONFIG_EXECUTOR_LIST(X)
#undef X
        CONFIG_EXECUTOR_COUNT
} config_executor;

/// The kind that executor names.
config_executor config_find_executor(const config *c);

/// The level that log_level names.
log_level config_log_level(const config *c);

/// Append a sample file: every setting with its help and default, commented out.
BF_MUST_CHECK bf_status config_sample(bf_buffer *out, bf_error *err);

/// Append the current settings as a settings file, with the origin of each as a comment.
BF_MUST_CHECK bf_status config_print(const config *c, bf_buffer *out, bf_error *err);

/// Called for each setting that has changed, with both values as text.
typedef void config_change_fn(void *context, const config_row *row, const char *before,
                              const char *after);

/// Take over from *fresh what can be changed without a restart, and report all differences.
void config_reload(config *c, const config *fresh, config_change_fn *on_change, void *context);

/// What the daemon is to do: its first word.
typedef enum config_command {
    CONFIG_SERVE,   ///< no word
    CONFIG_BACKUP,  ///< backup FILE
    CONFIG_RESTORE, ///< restore FILE
    CONFIG_VERIFY,  ///< verify [FILE], or --verify
    CONFIG_TOKEN,   ///< token add NAME, token list, token rotate ID, token revoke ID
    CONFIG_SCRIPT,  ///< slurm --dry-run
} config_command;

/// What the command line of the daemon says. Its texts are argv's.
typedef struct config_flags {
    const char *file; ///< --config; NULL: none, or, of commands, what config_parse_flags() found
    bool is_check;    ///< --check-config
    bool is_print;    ///< --print-config
    bool is_sample;   ///< --sample-config
    bool is_dry_run;  ///< --dry-run
    config_command command; ///< what to do
    const char *action;     ///< of a token: add, list, rotate or revoke; NULL: none
    const char *subject;    ///< its FILE, NAME or ID; NULL: none
    const char *owner;      ///< --owner of a new token; NULL: none
    const char *scopes;     ///< --scopes of it; NULL: none
    const char *expires;    ///< --expires of it; NULL: never
    const char *overlap;    ///< --overlap of one that is rotated; NULL: the default
    const char *copies;     ///< --copies of backup; NULL: all stay
    /// Of the settings, in the order of the table; NULL: not given
    const char *values[CONFIG_COUNT];
} config_flags;

/// Where the package has the settings. Commands that name neither a file nor a data directory use those, or the file that
/// BELTFLOW_CONFIG names.
#define CONFIG_PACKAGED "/etc/beltflow/beltflow.conf"

/// Read the command line. Ends the program for --help, --version, and with status 2 for what is no flag.
void config_parse_flags(int argc, char **argv, config_flags *ret_flags);

/// The settings that defaults, file, environment and flags give together, with what lies beside the
/// running program filled in. BF_EINPUT names the place; BF_ESYSTEM: the file cannot be read.
BF_MUST_CHECK bf_status config_read(const config_flags *flags, config *ret_config, bf_error *err);
