#include "server/http/http_priv.h"
#include "server/http/pool.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/http/cors.h"

#include <errno.h>
#include <fcntl.h>
#include <microhttpd.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    OPTIONS_MAX = 16,
    STACK_SIZE = 2 * 1024 * 1024,
    HEADER_BYTES =
        32768, // MHD's memory for a request's header and its answer's; beyond it MHD answers 431
    STOP_MS = 1000, // for answers under way when stopping
    LENIENT = 0,    // the guard is the strict one; MHD would answer with its own pages
};

// MHD's own decoding is lenient; the guard decodes strictly.
static size_t leave_as_it_is(void *context, struct MHD_Connection *mhd, char *text)
{
    (void)context;
    (void)mhd;
    return strlen(text);
}

static void *on_target(void *context, const char *target, struct MHD_Connection *mhd)
{
    return http__request_open(context, mhd, target == NULL ? "" : target);
}

static enum MHD_Result on_request(void *context, struct MHD_Connection *mhd, const char *url,
                                  const char *method, const char *version, const char *bytes,
                                  size_t *n, void **request)
{
    (void)context;
    (void)mhd;
    (void)url;
    if (*request == NULL)
        return MHD_NO;
    return http__request_advance(*request, method, version, bytes, n) ? MHD_YES : MHD_NO;
}

static void on_completed(void *context, struct MHD_Connection *mhd, void **request,
                         enum MHD_RequestTerminationCode how)
{
    (void)context;
    (void)mhd;
    (void)how;
    http__request_close(*request);
    *request = NULL;
}

// While the server stops nobody is taken in. MHD_quiesce_daemon() would say so, too; but it takes the listening socket out of
// the epoll sets while their threads may do so, and whoever is second ends the process (0.9.75).
static enum MHD_Result on_accept(void *context, const struct sockaddr *peer, socklen_t n)
{
    const http *h = context;

    (void)peer;
    (void)n;
    return atomic_load(&h->is_ending) ? MHD_NO : MHD_YES;
}

static void on_connection(void *context, struct MHD_Connection *mhd, void **connection,
                          enum MHD_ConnectionNotificationCode what)
{
    if (what == MHD_CONNECTION_NOTIFY_CLOSED) {
        http__connection_close(*connection);
        return;
    }
    const union MHD_ConnectionInfo *fd =
        MHD_get_connection_info(mhd, MHD_CONNECTION_INFO_CONNECTION_FD);
    const union MHD_ConnectionInfo *peer =
        MHD_get_connection_info(mhd, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    *connection = http__connection_open(context, fd->connect_fd, peer->client_addr);
}

static void on_message(void *context, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

static void on_message(void *context, const char *format, va_list arguments)
{
    char text[LOG_QUOTED_SIZE], quoted[LOG_QUOTED_SIZE];

    (void)context;
    (void)vsnprintf(text, sizeof text, format, arguments);
    log_event(LOG_LEVEL_DEBUG, "http", "text=%s", log_quote(text, quoted));
    http__request_refuse_length();
}

// Request threads may be using the descriptor of the directory, so a new directory takes over its number.
static bf_status open_web(http *h, const char *directory, bf_error *err)
{
    if (directory == NULL)
        return BF_OK;
    int fd = open(directory, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0 && h->web_fd < 0) {
        h->web_fd = fd;
        return BF_OK;
    }
    bool is_good = fd >= 0 && dup3(fd, h->web_fd, O_CLOEXEC) >= 0;
    int error = errno;
    if (fd >= 0)
        (void)close(fd);
    if (is_good)
        return BF_OK;
    return bf_fail(err, BF_ESYSTEM, "", "cannot use the page's directory %s: %s", directory,
                   strerror(error));
}

static void list_quotas(const http_options *options, uint64_t ret_quotas[HTTP_LIMIT_COUNT])
{
    ret_quotas[HTTP_LIMIT_REQUESTS] = options->requests_per_minute;
    ret_quotas[HTTP_LIMIT_WORK] = options->work_per_minute;
}

// A copy of n bytes as a text. NULL: no memory.
static char *copy(const char *text, size_t n)
{
    char *to = memory_alloc(n + 1, 1);

    if (to != NULL)
        memcpy(to, text, n);
    return to;
}

// Checks and copies the settings about other origins, hosts, proxies and limits.
static bf_status prepare_policies(http *h, bf_error *err)
{
    const char *origins = h->options.cors_origins == NULL ? "" : h->options.cors_origins;
    const char *proxies = h->options.trusted_proxies == NULL ? "" : h->options.trusted_proxies;
    const char *names = h->options.hosts == NULL ? "" : h->options.hosts;
    uint64_t quotas[HTTP_LIMIT_COUNT];

    list_quotas(&h->options, quotas);
    BF_TRY(http_cors_check(origins, err));
    BF_TRY(http_host_check(names, err));
    BF_TRY(http_client_read_proxies(proxies, &h->proxies, err));
    BF_TRY(http_limit_create(quotas, HTTP_LIMIT_CLIENTS, &h->limit, err));
    h->cors_origins = copy(origins, strlen(origins));
    h->host_names = copy(names, strlen(names));
    if (h->cors_origins == NULL || h->host_names == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the HTTP server");
    return BF_OK;
}

// Listens, and lists the addresses and names under which requests are answered.
static bf_status start_listening(http *h, bf_error *err)
{
    const char *address = h->options.listen;
    struct sockaddr_storage listened = { 0 };
    socklen_t n = sizeof listened;
    BF_TRY(http_listen(address, &h->listen_fd, &h->port, err));
    h->listened = copy(address, (size_t)(strrchr(address, ':') - address));
    if (h->listened == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the HTTP server");
    if (getsockname(h->listen_fd, (struct sockaddr *)&listened, &n) != 0)
        return bf_fail(err, BF_ESYSTEM, "", "the address of the listening socket is not known");
    h->hosts = http_host_list(h->host_names, h->listened, (const struct sockaddr *)&listened);
    if (h->hosts.is_loopback)
        return BF_OK;
    const char *plaintext = h->options.plaintext == NULL ? "loopback" : h->options.plaintext;
    BF_TRY(http_allow_plaintext(plaintext, h->options.has_tokens, address, err));
    if (!h->options.has_tokens)
        log_event(LOG_LEVEL_WARN, "listens_to_the_network",
                  "address=%s error=\"whoever reaches this address may submit, read and remove\"",
                  h->listened);
    return BF_OK;
}

static void add_option(struct MHD_OptionItem *items, enum MHD_OPTION option, uint64_t value)
{
    size_t n = 0;

    while (items[n].option != MHD_OPTION_END)
        n++;
    items[n].option = option;
    items[n].value = (intptr_t)value;
}

static bf_status start_daemon(http *h, bf_error *err)
{
    struct MHD_OptionItem items[OPTIONS_MAX] = { { MHD_OPTION_END, 0, NULL } };
    unsigned flags =
        MHD_USE_EPOLL_INTERNAL_THREAD | MHD_USE_ITC | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG;

    add_option(items, MHD_OPTION_LISTEN_SOCKET, (uint64_t)h->listen_fd);
    add_option(items, MHD_OPTION_CONNECTION_LIMIT, h->options.connection_limit);
    add_option(items, MHD_OPTION_CONNECTION_TIMEOUT, HTTP_IDLE_S);
    add_option(items, MHD_OPTION_CONNECTION_MEMORY_LIMIT, HEADER_BYTES);
    add_option(items, MHD_OPTION_STRICT_FOR_CLIENT, LENIENT);
    add_option(items, MHD_OPTION_THREAD_STACK_SIZE, STACK_SIZE);
    if (h->options.n_threads > 1)
        add_option(items, MHD_OPTION_THREAD_POOL_SIZE, h->options.n_threads);
    h->daemon = MHD_start_daemon(
        flags, 0, on_accept, h, on_request, h, MHD_OPTION_EXTERNAL_LOGGER, on_message, h,
        MHD_OPTION_URI_LOG_CALLBACK, on_target, h, MHD_OPTION_UNESCAPE_CALLBACK, leave_as_it_is, h,
        MHD_OPTION_NOTIFY_COMPLETED, on_completed, h, MHD_OPTION_NOTIFY_CONNECTION, on_connection,
        h, MHD_OPTION_ARRAY, items, MHD_OPTION_END);
    if (h->daemon == NULL)
        return bf_fail(err, BF_ESYSTEM, "", "the HTTP server cannot be started");
    return BF_OK;
}

bf_status http_start(const http_options *options, http **ret_http, bf_error *err)
{
    http *h = memory_alloc(1, sizeof *h);

    if (h == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the HTTP server");
    h->options = *options;
    if (h->options.clocks.monotonic_ms == NULL)
        h->options.clocks.monotonic_ms = clock_monotonic_ms;
    if (h->options.clocks.thread_cpu_ns == NULL)
        h->options.clocks.thread_cpu_ns = clock_thread_cpu_ns;
    h->services = *options->services;
    h->listen_fd = -1;
    h->web_fd = -1;
    lock_init(&h->lock);
    TAILQ_INIT(&h->connections);
    http_content_lengths_init(&h->lengths);
    lock_condition_init(&h->changed);
    bf_status status = open_web(h, options->web_directory, err);
    if (status == BF_OK)
        status = prepare_policies(h, err);
    if (status == BF_OK)
        status = start_listening(h, err);
    if (status == BF_OK)
        status = http__pool_start(options->n_request_threads, &h->pool, err);
    if (status == BF_OK)
        status = http__watch_start(h, err);
    if (status == BF_OK)
        status = start_daemon(h, err);
    h->options.listen = h->options.web_directory = NULL;
    h->options.cors_origins = h->options.trusted_proxies = h->options.hosts = NULL;
    if (status != BF_OK) {
        (void)http_stop(h);
        return status;
    }
    *ret_http = h;
    return BF_OK;
}

bf_status http_reconfigure(http *h, const http_options *options, bf_error *err)
{
    uint64_t quotas[HTTP_LIMIT_COUNT];

    list_quotas(options, quotas);
    http_limit_change(h->limit, quotas);
    h->options.stream_limit = options->stream_limit;
    h->options.download_limit = options->download_limit;
    h->options.wait_limit = options->wait_limit;
    h->options.body_limit = options->body_limit;
    h->options.answer_limit = options->answer_limit;
    h->options.header_deadline_ms = options->header_deadline_ms;
    h->options.body_deadline_ms = options->body_deadline_ms;
    h->options.heartbeat_ms = options->heartbeat_ms;
    h->options.logs_all = options->logs_all;
    return open_web(h, options->web_directory, err);
}

unsigned http_port(const http *h)
{
    return h->port;
}

http *http_stop(http *h)
{
    if (h == NULL)
        return NULL;
    atomic_store(&h->is_ending, true);
    http__pull_stop_all(h);
    http__pool_end(h->pool);
    if (h->daemon != NULL) {
        // Lets answers that are under way reach their clients.
        int64_t deadline_ms = clock_monotonic_ms() + STOP_MS;
        lock_acquire(&h->lock);
        while (h->n_requests > 0 && lock_wait(&h->changed, &h->lock, deadline_ms))
            ;
        lock_release(&h->lock);
    }
    http__watch_stop(h);
    http__probe_end(h);
    if (h->daemon != NULL)
        MHD_stop_daemon(h->daemon); // closes the listening socket
    else if (h->listen_fd >= 0)
        (void)close(h->listen_fd);
    h->pool = http__pool_free(h->pool);
    if (h->web_fd >= 0)
        (void)close(h->web_fd);
    h->limit = http_limit_destroy(h->limit);
    memory_free(h->cors_origins);
    memory_free(h->host_names);
    memory_free(h->listened);
    http_content_lengths_fini(&h->lengths);
    lock_condition_fini(&h->changed);
    lock_fini(&h->lock);
    memory_free(h);
    return NULL;
}
