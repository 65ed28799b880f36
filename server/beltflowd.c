// The daemon: settings, then store, supervisor and HTTP, in this order, until SIGTERM or SIGINT;
// then back in the reverse order.
//
// Threads  signals are blocked before the first thread starts, so that every thread inherits that
//          and only main takes them, by sigwait(). A commit of the store's thread reaches the
//          streams through `gate`, because HTTP starts after the store and stops before it.

#include "server/config.h"
#include "server/http.h"
#include "server/lock.h"
#include "server/log.h"
#include "server/maintenance.h"
#include "server/service.h"

#include <argp.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

enum { EXIT_SETTINGS = 2, FLAGS_MAX = 64, KEY_CONFIG = 256, KEY_PRINT, KEY_VERIFY, KEY_ROWS };
enum { N_OWN = 3 }; // flags that are no settings
enum { HOUR_MS = 3600 * 1000, DAY_MS = 24 * HOUR_MS };

const char *argp_program_version = "beltflowd " BELTFLOW_VERSION;

typedef enum command { COMMAND_SERVE, COMMAND_BACKUP, COMMAND_VERIFY } command;

// What the command line says, to be applied after file and environment.
typedef struct arguments {
    const char *file;              // --config; NULL: none
    bool prints_config;            // --print-config
    command command;               // the first word
    const char *subject;           // the word after it; NULL: none
    const char *values[FLAGS_MAX]; // of the settings, in the order of the table; NULL: not given
} arguments;

// The way from the store to the streams.
typedef struct gate {
    lock lock;  // guards http
    http *http; // NULL while there is none
} gate;

// The daemon's parts.
typedef struct parts {
    gate gate;
    service service;
    http *http;
} parts;

static void take_word(arguments *a, const char *word, const struct argp_state *state)
{
    if (a->command != COMMAND_SERVE && a->subject == NULL)
        a->subject = word;
    else if (a->command == COMMAND_SERVE && strcmp(word, "backup") == 0)
        a->command = COMMAND_BACKUP;
    else if (a->command == COMMAND_SERVE && strcmp(word, "verify") == 0)
        a->command = COMMAND_VERIFY;
    else
        argp_error(state, "this is no command, and nothing else fits here: '%s'", word);
}

static error_t take_argument(int key, char *value, struct argp_state *state)
{
    arguments *a = state->input;
    size_t n = 0;

    (void)config_rows(&n);
    if (key == KEY_CONFIG)
        a->file = value;
    else if (key == KEY_PRINT)
        a->prints_config = true;
    else if (key >= KEY_ROWS && (size_t)(key - KEY_ROWS) < n)
        a->values[key - KEY_ROWS] = value;
    else if (key == KEY_VERIFY)
        a->command = COMMAND_VERIFY;
    else if (key == ARGP_KEY_ARG)
        take_word(a, value, state);
    else if (key == ARGP_KEY_END && a->command == COMMAND_BACKUP && a->subject == NULL)
        argp_error(state, "backup wants the name of a new file");
    else
        return ARGP_ERR_UNKNOWN;
    return 0;
}

// The flag of a setting, without its dashes, in storage of 64 bytes.
static char *flag_of(const char *name, char *storage)
{
    (void)snprintf(storage, 64, "%s", name);
    for (char *c = storage; *c != '\0'; c++)
        *c = *c == '_' ? '-' : *c;
    return storage;
}

static void parse_arguments(int argc, char **argv, arguments *ret_arguments)
{
    static char names[FLAGS_MAX][64];
    static char helps[FLAGS_MAX][160];
    struct argp_option options[FLAGS_MAX + N_OWN + 1] = {
        { "config", KEY_CONFIG, "FILE", 0, "read settings from FILE (lines 'name = value')", 0 },
        { "print-config", KEY_PRINT, NULL, 0, "print a sample of FILE with all settings", 0 },
        { "verify", KEY_VERIFY, NULL, 0, "the same as the command verify", 0 },
    };
    const struct argp argp = { options,
                               take_argument,
                               "\nbackup FILE\nverify [FILE]",
                               "Solves material flow on conveyor belts and offers it over HTTP. "
                               "With backup, copies the store to a new FILE, also while it is in "
                               "use; with verify, checks the store, or a copy of it."
                               "\vA flag goes before the environment (BELTFLOW_<NAME>), and that "
                               "before FILE.",
                               NULL,
                               NULL,
                               NULL };
    size_t n = 0;
    const config_row *rows = config_rows(&n);

    for (size_t i = 0; i < n && i < FLAGS_MAX; i++) {
        const char *initial = rows[i].initial[0] == '\0' ? "empty" : rows[i].initial;
        (void)snprintf(helps[i], sizeof helps[i], "%s (default: %s)", rows[i].help, initial);
        options[i + N_OWN].name = flag_of(rows[i].name, names[i]);
        options[i + N_OWN].key = KEY_ROWS + (int)i;
        options[i + N_OWN].arg = "VALUE";
        options[i + N_OWN].doc = helps[i];
        options[i + N_OWN].group = 1;
    }
    argp_err_exit_status = EXIT_SETTINGS;
    (void)argp_parse(&argp, argc, argv, 0, NULL, ret_arguments);
}

static bf_status apply_flags(const arguments *a, config *c, bf_error *err)
{
    size_t n = 0;
    const config_row *rows = config_rows(&n);
    bf_status status = BF_OK;

    for (size_t i = 0; status == BF_OK && i < n && i < FLAGS_MAX; i++) {
        char name[64], where[80];
        if (a->values[i] == NULL)
            continue;
        (void)snprintf(where, sizeof where, "--%s", flag_of(rows[i].name, name));
        status = config_set(c, rows[i].name, a->values[i], where, err);
    }
    return status;
}

static bf_status locate(config *c, bf_error *err)
{
    char folder[CONFIG_TEXT_SIZE];
    ssize_t n = readlink("/proc/self/exe", folder, sizeof folder - 1);

    if (n <= 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot find out where this program lies");
    folder[n] = '\0';
    char *slash = strrchr(folder, '/');
    if (slash != NULL)
        *slash = '\0';
    return config_locate(c, folder, err);
}

static bf_status read_settings(const arguments *a, config *c, bf_error *err)
{
    config_init(c);
    bf_status status = a->file == NULL ? BF_OK : config_read_file(c, a->file, err);
    if (status == BF_OK)
        status = config_read_environment(c, err);
    if (status == BF_OK)
        status = apply_flags(a, c, err);
    if (status == BF_OK)
        status = locate(c, err);
    return status;
}

static int print_sample(void)
{
    bf_buffer text = { 0 };
    bool is_good = config_sample(&text, NULL) == BF_OK &&
                   fwrite(text.bytes, 1, text.n, stdout) == text.n && fflush(stdout) == 0;

    buffer_fini(&text);
    return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
}

// A descriptor below 3 that is closed would become that of a file or a client, and the log go there.
static void occupy_standard_descriptors(void)
{
    int fd = open("/dev/null", O_RDWR | O_CLOEXEC);

    while (fd >= 0 && fd <= STDERR_FILENO)
        fd = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (fd >= 0)
        (void)close(fd);
}

// Blocks the signals that main waits for, in this and all later threads.
static sigset_t prepare_process(void)
{
    struct rlimit files;
    sigset_t signals;

    occupy_standard_descriptors();
    (void)setenv("TZ", "UTC0", 1); // ZIP archives have local times in them, and shall be the same
    (void)signal(SIGPIPE, SIG_IGN);
    (void)sigemptyset(&signals);
    (void)sigaddset(&signals, SIGTERM);
    (void)sigaddset(&signals, SIGINT);
    (void)pthread_sigmask(SIG_BLOCK, &signals, NULL);
    if (getrlimit(RLIMIT_NOFILE, &files) == 0) {
        files.rlim_cur = files.rlim_max;
        (void)setrlimit(RLIMIT_NOFILE, &files);
    }
    return signals;
}

static void on_commit(void *context, const char *run_id)
{
    gate *g = context;

    lock_take(&g->lock);
    if (g->http != NULL)
        http_notify(g->http, run_id);
    lock_give(&g->lock);
}

static void set_gate(gate *g, http *h)
{
    lock_take(&g->lock);
    g->http = h;
    lock_give(&g->lock);
}

static bf_status start_store(const config *c, parts *p, bf_error *err)
{
    const store_options options = { .directory = c->data,
                                    .queue_limit = c->queue_limit,
                                    .listener = on_commit,
                                    .listener_context = &p->gate,
                                    .answers_ms = (int64_t)c->idempotency_hours * HOUR_MS,
                                    .retention = { .age_ms = (int64_t)c->retention_days * DAY_MS,
                                                   .n_runs = c->retention_runs,
                                                   .n_bytes = c->retention_bytes } };
    return store_open(&options, &p->service.store, err);
}

static bf_status start_share(const config *c, parts *p, bf_error *err)
{
    if (c->queue_share == 0)
        return BF_OK;
    return queue_share_create(c->queue_share, c->queue_limit, &p->service.share, err);
}

static bf_status start_supervisor(const config *c, parts *p, bf_error *err)
{
    const supervisor_options options = { .store = p->service.store,
                                         .program = c->program,
                                         .n_workers = (unsigned)c->workers,
                                         .n_threads = (unsigned)c->threads,
                                         .memory_bytes = c->run_memory_bytes,
                                         .cpu_s = c->run_cpu_s,
                                         .checkpoint_ms = (int64_t)c->checkpoint_ms };
    return supervisor_start(&options, &p->service.supervisor, err);
}

static bf_status start_http(const config *c, parts *p, bf_error *err)
{
    const api_services services = service_table(&p->service);
    const http_options options = { .listen = c->listen,
                                   .services = &services,
                                   .web_directory = c->web[0] == '\0' ? NULL : c->web,
                                   .n_threads = (unsigned)c->http_threads,
                                   .n_request_threads = (unsigned)c->request_threads,
                                   .connection_limit = (unsigned)c->connections,
                                   .per_address_limit = (unsigned)c->connections_per_address,
                                   .stream_limit = (unsigned)c->streams,
                                   .download_limit = (unsigned)c->downloads,
                                   .wait_limit = (unsigned)c->waits,
                                   .cors_origins = c->cors_origins,
                                   .trusted_proxies = c->trusted_proxies,
                                   .requests_per_minute = c->requests_per_minute,
                                   .work_per_minute = c->work_per_minute,
                                   .body_limit = c->body_bytes,
                                   .header_deadline_ms = (int64_t)c->header_deadline_ms,
                                   .body_deadline_ms = (int64_t)c->body_deadline_ms,
                                   .heartbeat_ms = (int64_t)c->heartbeat_ms };
    bf_status status = http_start(&options, &p->http, err);
    if (status == BF_OK)
        set_gate(&p->gate, p->http);
    return status;
}

static void stop(const config *c, parts *p)
{
    service_drain(&p->service);
    set_gate(&p->gate, NULL);
    p->http = http_stop(p->http);
    p->service.supervisor = supervisor_stop(p->service.supervisor, (int64_t)c->stop_grace_ms);
    p->service.store = store_close(p->service.store);
    p->service.share = queue_share_destroy(p->service.share);
}

// The line that scripts wait for.
static void announce(const config *c, const http *h)
{
    int n_host = (int)(strrchr(c->listen, ':') - c->listen);

    (void)printf("beltflowd %s listening on http://%.*s:%u/\n", BELTFLOW_VERSION, n_host, c->listen,
                 http_port(h));
    (void)fflush(stdout);
    log_event(LOG_LEVEL_INFO, "started", "version=%s port=%u", BELTFLOW_VERSION, http_port(h));
}

static bf_status serve(const config *c, const sigset_t *signals, bf_error *err)
{
    parts p = { .http = NULL };
    int taken = 0;

    lock_init(&p.gate.lock);
    bf_status status = start_store(c, &p, err);
    if (status == BF_OK)
        status = start_share(c, &p, err);
    if (status == BF_OK)
        status = start_supervisor(c, &p, err);
    if (status == BF_OK)
        status = start_http(c, &p, err);
    if (status == BF_OK) {
        announce(c, p.http);
        (void)sigwait(signals, &taken);
        log_event(LOG_LEVEL_INFO, "stopping", "signal=%d", taken);
    }
    stop(c, &p);
    lock_fini(&p.gate.lock);
    if (status == BF_OK)
        log_event(LOG_LEVEL_INFO, "stopped", NULL);
    return status;
}

static int maintain(const arguments *a, const config *c)
{
    return a->command == COMMAND_BACKUP ? maintenance_backup(c->data, a->subject)
                                        : maintenance_verify(c->data, a->subject);
}

int main(int argc, char **argv)
{
    arguments a = { .file = NULL };
    bf_error err = { 0 };
    config c;

    parse_arguments(argc, argv, &a);
    if (a.prints_config)
        return print_sample();
    bf_status status = read_settings(&a, &c, &err);
    if (status != BF_OK) {
        (void)fprintf(stderr, "beltflowd: %s\n", err.text);
        return EXIT_SETTINGS;
    }
    (void)umask(077);
    if (a.command != COMMAND_SERVE)
        return maintain(&a, &c);
    sigset_t signals = prepare_process();
    log_set_level(config_log_level(&c));
    status = serve(&c, &signals, &err);
    if (status == BF_OK)
        return EXIT_SUCCESS;
    (void)fprintf(stderr, "beltflowd: %s\n", err.text);
    return status == BF_EINPUT ? EXIT_SETTINGS : EXIT_FAILURE;
}
