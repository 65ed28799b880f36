// The daemon: settings, then store, supervisor and HTTP, in this order, until SIGTERM or SIGINT;
// then back in the reverse order. SIGHUP reloads the settings.
//
// Threads  signals are blocked before the first thread starts, so that every thread inherits that
//          and only main takes them. A commit of the store's thread reaches supervisor and streams through
//          `commit_listener`, because they start after the store and stop before it.
// Watchdog main probes every part at half the service manager's watchdog interval, and notifies the
//          manager only if all parts have answered the previous probe. Without
//          a watchdog main sleeps until a signal comes, or it is time to write down the last uses of tokens.

#include "server/base/clock.h"
#include "server/base/lock.h"
#include "server/base/log.h"
#include "server/base/metrics.h"
#include "server/daemon/admission.h"
#include "server/daemon/config.h"
#include "server/daemon/executors.h"
#include "server/daemon/maintenance.h"
#include "server/daemon/notify.h"
#include "server/daemon/service.h"
#include "server/http/http.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    EXIT_SETTINGS = 2,
    STATUS_SIZE = 200,
    SAVE_MS = 60000,
    HOUR_MS = 3600 * 1000,
    DAY_MS = 24 * HOUR_MS
};

const char *argp_program_version = "beltflowd " BELTFLOW_BUILD;

// Who is notified of commits.
typedef struct commit_listener {
    lock lock;              // guards what follows
    http *http;             // NULL while there is none
    supervisor *supervisor; // NULL while there is none
    studies *studies;       // NULL while there are none
} commit_listener;

// The daemon: its settings and parts.
typedef struct parts {
    const config_flags *flags; // of the command line, for reading the settings again
    config settings;           // that count at the moment
    commit_listener commit_listener;
    executors executors;
    service service;
    http *http;
} parts;

typedef bf_status write_settings(const config *c, bf_buffer *out, bf_error *err);

static bf_status write_script(const config *c, bf_buffer *out, bf_error *err)
{
    const slurm_settings settings = executors_slurm_settings(c);

    return slurm_write_script(&settings, out, err);
}

static bf_status write_sample(const config *c, bf_buffer *out, bf_error *err)
{
    (void)c;
    return config_sample(out, err);
}

static int fail(const char *program, const bf_error *err, bf_status status)
{
    (void)fprintf(stderr, "%s%s\n", program, err->text);
    return status == BF_EINPUT ? EXIT_SETTINGS : EXIT_FAILURE;
}

static int print(const config *c, write_settings *write)
{
    bf_buffer text = { 0 };
    bf_error err = { 0 };

    bf_status status = write(c, &text, &err);
    if (status == BF_OK && (fwrite(text.bytes, 1, text.n, stdout) != text.n || fflush(stdout) != 0))
        status = bf_fail(&err, BF_ESYSTEM, "", "standard output takes nothing");
    buffer_fini(&text);
    return status == BF_OK ? EXIT_SUCCESS : fail("beltflowd: ", &err, status);
}

// Blocks the signals that main waits for, in this and all later threads.
static sigset_t prepare_process(void)
{
    struct rlimit files;
    sigset_t signals;

    // A descriptor below 3 that is closed would become that of a file or a client, and the log go there.
    int fd = open("/dev/null", O_RDWR | O_CLOEXEC);
    while (fd >= 0 && fd <= STDERR_FILENO)
        fd = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (fd >= 0)
        (void)close(fd);
    (void)setenv("TZ", "UTC0", 1); // ZIP archives have local times in them, and shall be the same
    (void)signal(SIGPIPE, SIG_IGN);
    (void)sigemptyset(&signals);
    (void)sigaddset(&signals, SIGTERM);
    (void)sigaddset(&signals, SIGINT);
    (void)sigaddset(&signals, SIGHUP);
    (void)pthread_sigmask(SIG_BLOCK, &signals, NULL);
    if (getrlimit(RLIMIT_NOFILE, &files) == 0) {
        files.rlim_cur = files.rlim_max;
        (void)setrlimit(RLIMIT_NOFILE, &files);
    }
    return signals;
}

static void on_commit(void *context, const char *run_id)
{
    parts *p = context;
    commit_listener *listener = &p->commit_listener;

    service_notify(&p->service, run_id);
    lock_acquire(&listener->lock);
    if (listener->supervisor != NULL)
        supervisor_notify(listener->supervisor);
    if (listener->studies != NULL)
        studies_notify(listener->studies, run_id);
    if (listener->http != NULL)
        http_notify(listener->http, run_id);
    lock_release(&listener->lock);
}

// Whom commits are told, with the studies if there are any.
static void set_commit_listener(parts *p, supervisor *s, http *h)
{
    commit_listener *listener = &p->commit_listener;

    lock_acquire(&listener->lock);
    listener->supervisor = s;
    listener->studies = s == NULL ? NULL : p->service.studies;
    listener->http = h;
    lock_release(&listener->lock);
}

static supervisor_options options_of_supervisor(const parts *p)
{
    const config *c = &p->settings;

    return (supervisor_options){ .store = p->service.store,
                                 .executor = p->executors.executor,
                                 .n_workers = executors_count_workers(c),
                                 .n_threads = (unsigned)c->threads,
                                 .memory_bytes = c->run_memory_bytes,
                                 .cpu_s = c->run_cpu_s,
                                 .output_bytes = c->run_output_bytes,
                                 .stall_s = c->run_stall_s,
                                 .wall_s = c->run_wall_s,
                                 .checkpoint_ms = (int64_t)c->checkpoint_ms };
}

static http_options options_of_http(const config *c)
{
    return (http_options){ .listen = c->listen,
                           .plaintext = c->plaintext,
                           .web_directory = c->web[0] == '\0' ? NULL : c->web,
                           .n_threads = (unsigned)c->http_threads,
                           .n_request_threads = (unsigned)c->request_threads,
                           .connection_limit = (unsigned)c->connections,
                           .per_address_limit = (unsigned)c->connections_per_address,
                           .cors_origins = c->cors_origins,
                           .hosts = c->hosts,
                           .trusted_proxies = c->trusted_proxies,
                           .requests_per_minute = c->requests_per_minute,
                           .work_per_minute = c->work_per_minute,
                           .stream_limit = (unsigned)c->streams,
                           .download_limit = (unsigned)c->downloads,
                           .wait_limit = (unsigned)c->waits,
                           .body_limit = c->body_bytes,
                           .answer_limit = c->answers_bytes,
                           .header_deadline_ms = (int64_t)c->header_deadline_ms,
                           .body_deadline_ms = (int64_t)c->body_deadline_ms,
                           .heartbeat_ms = (int64_t)c->heartbeat_ms,
                           .logs_all = c->access_log != 0 };
}

static store_retention retention_of(const config *c)
{
    return (store_retention){ .age_ms = (int64_t)c->retention_days * DAY_MS,
                              .n_runs = c->retention_runs,
                              .n_bytes = c->retention_bytes };
}

static store_quotas quotas_of(const config *c)
{
    return (store_quotas){ .n_waiting = c->owner_queue,
                           .cpu_s = c->owner_cpu_s,
                           .n_bytes = c->owner_bytes,
                           .n_measurements = c->owner_measurements,
                           .n_studies = c->owner_studies };
}

static void on_queued(void *context)
{
    supervisor_wake(((parts *)context)->service.supervisor);
}

// Each part needs those before it. Where one fails, stop() stops those.
static bf_status start(parts *p, bf_error *err)
{
    const config *c = &p->settings;
    service *s = &p->service;

    BF_TRY(executors_create(&p->executors, c, err));
    if (p->executors.kind != CONFIG_LOCAL)
        s->leases = &p->executors.leases;

    const store_options storing = { .directory = c->data,
                                    .queue_limit = c->queue_limit,
                                    .client_quota = c->queue_share,
                                    .quotas = quotas_of(c),
                                    .listener = on_commit,
                                    .listener_context = p,
                                    .still_runs = supervisor_still_runs,
                                    .still_runs_context = p->executors.executor,
                                    .attempts_max = c->run_attempts,
                                    .idempotency_ms = (int64_t)c->idempotency_hours * HOUR_MS,
                                    .retention = retention_of(c) };
    BF_TRY(store_open(&storing, &s->store, err));
    BF_TRY(tickets_draw(&s->tickets, err));
    BF_TRY(tokens_open(c->data, &s->tokens, err));
    BF_TRY(admission_check(c, s->store, s->tokens, err));
    BF_TRY(predictor_start(s->store, &s->predictor, err));
    executors_set_predictor(&p->executors, s->predictor);

    const supervisor_options supervising = options_of_supervisor(p);
    BF_TRY(supervisor_start(&supervising, &s->supervisor, err));
    set_commit_listener(p, s->supervisor, NULL);

    const studies_options studying = { .store = s->store,
                                       .n_workers = supervising.n_workers,
                                       .age_ms = retention_of(c).age_ms,
                                       .queued = on_queued,
                                       .context = p };
    BF_TRY(studies_start(&studying, &s->studies, err));
    set_commit_listener(p, s->supervisor, NULL);

    const api_services services = service_table(s);
    http_options serving = options_of_http(c);
    serving.services = &services;
    serving.has_tokens = tokens_exist(s->tokens);
    BF_TRY(http_start(&serving, &p->http, err));
    set_commit_listener(p, s->supervisor, p->http);
    return executors_start(&p->executors, c, s->store, err);
}

static void stop(parts *p)
{
    executors_stop(&p->executors);
    service_drain(&p->service);
    // Requests that wait for a run to end need the supervisor until HTTP has stopped.
    set_commit_listener(p, p->service.supervisor, NULL);
    p->http = http_stop(p->http);
    set_commit_listener(p, NULL, NULL);
    p->service.studies = studies_stop(p->service.studies);
    p->service.supervisor =
        supervisor_stop(p->service.supervisor, (int64_t)p->settings.stop_grace_ms);
    p->service.predictor = predictor_stop(p->service.predictor);
    executors_destroy(&p->executors);
    p->service.tokens = tokens_close(p->service.tokens);
    p->service.store = store_close(p->service.store);
}

// What the daemon does, in words, in STATUS_SIZE bytes.
static const char *describe(const parts *p, char *storage)
{
    store_stats figures;

    store_read_stats(p->service.store, &figures);
    (void)snprintf(storage, STATUS_SIZE, "port %u; %llu runs are being solved, %llu wait",
                   http_port(p->http), (unsigned long long)figures.n_runs[RUN_RUNNING],
                   (unsigned long long)figures.n_runs[RUN_QUEUED]);
    return storage;
}

static void log_change(void *context, const config_row *row, const char *before, const char *after)
{
    char quoted[2][LOG_QUOTED_SIZE];

    (void)context;
    log_event(row->can_reload ? LOG_LEVEL_INFO : LOG_LEVEL_WARN,
              row->can_reload ? "setting_changed" : "setting_needs_restart",
              "name=%s from=%s to=%s", row->name, log_quote(before, quoted[0]),
              log_quote(after, quoted[1]));
}

static void apply(parts *p)
{
    const supervisor_options supervising = options_of_supervisor(p);
    const http_options serving = options_of_http(&p->settings);
    const store_retention retention = retention_of(&p->settings);
    const store_quotas quotas = quotas_of(&p->settings);
    char quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };

    log_set_level(config_log_level(&p->settings));
    store_set_queue_limit(p->service.store, p->settings.queue_limit);
    store_set_client_quota(p->service.store, p->settings.queue_share);
    store_set_quotas(p->service.store, &quotas);
    store_set_retention(p->service.store, &retention);
    supervisor_reconfigure(p->service.supervisor, &supervising);
    studies_reconfigure(p->service.studies, supervising.n_workers, retention.age_ms);
    if (http_reconfigure(p->http, &serving, &err) != BF_OK)
        log_event(LOG_LEVEL_ERROR, "page_not_changed", "error=%s", log_quote(err.text, quoted));
}

// Settings at fault leave all as it was.
static void reload(parts *p)
{
    char text[STATUS_SIZE], quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };
    config fresh;

    notify_reloading();
    bf_status status = config_read(p->flags, &fresh, &err);
    metrics_set(METRICS_RELOAD_GOOD, 0, status == BF_OK);
    if (status == BF_OK) {
        config_reload(&p->settings, &fresh, log_change, NULL);
        apply(p);
        log_event(LOG_LEVEL_INFO, "settings_read", NULL);
    } else {
        log_event(LOG_LEVEL_ERROR, "settings_refused", "error=%s", log_quote(err.text, quoted));
    }
    notify_ready("%s", describe(p, text));
}

// Every part is probed each time, even if another one has failed.
static void report_liveness(const parts *p)
{
    bool has_store = store_is_alive(p->service.store);
    bool has_supervisor = supervisor_is_alive(p->service.supervisor);
    bool has_studies = studies_is_alive(p->service.studies);
    bool has_http = http_is_alive(p->http);
    char text[STATUS_SIZE];

    if (has_store && has_supervisor && has_studies && has_http)
        notify_alive("%s", describe(p, text));
    else
        log_event(LOG_LEVEL_ERROR, "subsystem_stalled", "store=%s supervisor=%s studies=%s http=%s",
                  has_store ? "alive" : "hangs", has_supervisor ? "alive" : "hangs",
                  has_studies ? "alive" : "hangs", has_http ? "alive" : "hangs");
}

// The next signal; 0: until_ms (clock_monotonic_ms(), -1: never) has come.
static int await_signal(const sigset_t *signals, int64_t until_ms)
{
    int64_t left_ms = until_ms - clock_monotonic_ms();
    const struct timespec left = { .tv_sec = left_ms / 1000, .tv_nsec = left_ms % 1000 * 1000000 };
    int taken;

    if (until_ms >= 0 && left_ms <= 0)
        return 0;
    do
        taken = until_ms < 0 ? sigwaitinfo(signals, NULL) : sigtimedwait(signals, NULL, &left);
    while (taken < 0 && errno == EINTR && until_ms < 0);
    return taken < 0 ? 0 : taken;
}

// Returns the signal that ended it.
static int run_until_signal(parts *p, const sigset_t *signals)
{
    int64_t interval_ms = notify_watchdog_ms() / 2;
    int64_t report_ms = interval_ms == 0 ? -1 : clock_monotonic_ms() + interval_ms;
    int64_t save_ms = clock_monotonic_ms() + SAVE_MS;
    bool has_noted = false;

    for (;;) {
        int taken =
            await_signal(signals, report_ms >= 0 && report_ms < save_ms ? report_ms : save_ms);
        if (taken == SIGTERM || taken == SIGINT)
            return taken;
        if (taken == SIGHUP)
            reload(p);
        if (clock_monotonic_ms() >= save_ms) {
            tokens_save_uses(p->service.tokens);
            admission_note(p->service.store, p->service.tokens, &has_noted);
            save_ms = clock_monotonic_ms() + SAVE_MS;
        }
        if (report_ms < 0 || clock_monotonic_ms() < report_ms)
            continue;
        report_liveness(p);
        report_ms = clock_monotonic_ms() + interval_ms;
    }
}

static bf_status serve(parts *p, const sigset_t *signals, bf_error *err)
{
    lock_init(&p->commit_listener.lock);
    service_init(&p->service);
    bf_status status = start(p, err);
    if (status == BF_OK) {
        // The line that scripts wait for, and the word that a service manager waits for.
        const config *c = &p->settings;
        int n_host = (int)(strrchr(c->listen, ':') - c->listen);
        char text[STATUS_SIZE];
        (void)printf("beltflowd %s listening on http://%.*s:%u/\n", BELTFLOW_VERSION, n_host,
                     c->listen, http_port(p->http));
        (void)fflush(stdout);
        log_event(LOG_LEVEL_INFO, "started", "version=%s port=%u", BELTFLOW_BUILD,
                  http_port(p->http));
        notify_ready("%s", describe(p, text));
        int taken = run_until_signal(p, signals);
        admission_note(p->service.store, p->service.tokens, &(bool){ false });
        log_event(LOG_LEVEL_INFO, "stopping", "signal=%d", taken);
        notify_stopping("handing back what is being solved");
    }
    stop(p);
    service_fini(&p->service);
    lock_fini(&p->commit_listener.lock);
    if (status == BF_OK)
        log_event(LOG_LEVEL_INFO, "stopped", NULL);
    return status;
}

// A token for a store that nobody serves would never count. An administrator works as who owns the data directory, so that
// the daemon can read what he leaves.
static bf_status prepare_tokens(const config *c, bf_error *err)
{
    struct stat whose;

    const bool is_there = stat(c->data, &whose) == 0;
    if (!is_there && strcmp(c->origins[CONFIG_data], "default") == 0)
        return bf_fail(err, BF_EINPUT, "",
                       "there is no store in %.200s: name it with --data, or the settings with "
                       "--config",
                       c->data);
    if (geteuid() != 0 || !is_there || whose.st_uid == 0)
        return BF_OK;
    if (setgroups(0, NULL) != 0 || setgid(whose.st_gid) != 0 || setuid(whose.st_uid) != 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot work as the owner of %.200s: %s", c->data,
                       strerror(errno));
    return BF_OK;
}

static int maintain_token(const config_flags *flags, const config *c)
{
    const maintenance_token wanted = { .name = flags->subject,
                                       .owner = flags->owner,
                                       .scopes = flags->scopes,
                                       .expires = flags->expires };
    bf_error err = { 0 };

    const bf_status status = prepare_tokens(c, &err);
    if (status != BF_OK)
        return fail("beltflowd: ", &err, status);
    if (strcmp(flags->action, "add") == 0)
        return maintenance_token_add(c->data, &wanted);
    if (strcmp(flags->action, "rotate") == 0)
        return maintenance_token_rotate(c->data, flags->subject, flags->overlap);
    return strcmp(flags->action, "list") == 0 ? maintenance_token_list(c->data)
                                              : maintenance_token_revoke(c->data, flags->subject);
}

static int maintain(const config_flags *flags, const config *c)
{
    switch (flags->command) {
    case CONFIG_SCRIPT:
        return print(c, write_script);
    case CONFIG_TOKEN:
        return maintain_token(flags, c);
    case CONFIG_BACKUP:
        return maintenance_backup(c->data, flags->file, flags->subject, flags->copies);
    case CONFIG_RESTORE:
        return maintenance_restore(c->data, flags->file, flags->subject);
    default:
        return maintenance_verify(c->data, flags->subject);
    }
}

// Where the settings are lost, those of the copy say where the data directory is.
static bf_status read_settings(const config_flags *flags, config *ret_config, bf_error *err)
{
    config_flags changed = *flags;
    char of_copy[CONFIG_TEXT_SIZE];

    if (flags->command == CONFIG_RESTORE && flags->file != NULL && access(flags->file, F_OK) != 0 &&
        snprintf(of_copy, sizeof of_copy, "%s.conf", flags->subject) < (int)sizeof of_copy &&
        access(of_copy, F_OK) == 0)
        changed.file = of_copy;
    return config_read(&changed, ret_config, err);
}

int main(int argc, char **argv)
{
    config_flags flags;
    static parts p;
    bf_error err = { 0 };

    metrics_set(METRICS_PROCESS_START, 0, clock_unix_ms() * 1000000);
    metrics_set(METRICS_RELOAD_GOOD, 0, 1);
    config_parse_flags(argc, argv, &flags);
    if (flags.is_sample)
        return print(NULL, write_sample);
    // All errors of settings are reported as BF_EINPUT: only the operator can correct them.
    if (read_settings(&flags, &p.settings, &err) != BF_OK)
        return fail(flags.is_check ? "" : "beltflowd: ", &err, BF_EINPUT);
    if (flags.is_check)
        return EXIT_SUCCESS;
    if (flags.is_print)
        return print(&p.settings, config_print);
    (void)umask(077);
    if (flags.command != CONFIG_SERVE)
        return maintain(&flags, &p.settings);
    p.flags = &flags;
    sigset_t signals = prepare_process();
    log_open();
    log_set_level(config_log_level(&p.settings));
    bf_status status = serve(&p, &signals, &err);
    return status == BF_OK ? EXIT_SUCCESS : fail("beltflowd: ", &err, status);
}
