#include "server/http/http_priv.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/http/cors.h"
#include "server/http/guard.h"

#include <microhttpd.h>
#include <netinet/in.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    ID_LENGTH = API_ID_SIZE - 1,
    HOST_SIZE = 300,    // of a host with its port
    WARNING_MS = 60000, // between two warnings of the same
};

static http_connection *connection_of(struct MHD_Connection *mhd)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(mhd, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    return info == NULL ? NULL : info->socket_context;
}

http_request *http__request_open(http *h, struct MHD_Connection *mhd, const char *target)
{
    http_connection *c = connection_of(mhd);
    http_request *r = c == NULL ? NULL : memory_alloc(1, sizeof *r);

    if (r == NULL)
        return NULL;
    r->server = h;
    r->connection = c;
    r->mhd = mhd;
    r->file.fd = -1;
    r->target = target;
    r->target_end = target + strlen(target);
    r->refusal = http_guard_target(target, r->path, r->query, &r->fault);
    return r;
}

const char *http__request_header(void *context, const char *name)
{
    const http_request *r = context;
    return MHD_lookup_connection_value(r->mhd, MHD_HEADER_KIND, name);
}

static enum MHD_Result show_header(void *context, enum MHD_ValueKind kind, const char *name,
                                   size_t n_name, const char *value, size_t n_value)
{
    (void)kind;
    http_guard_header(context, name, n_name, value, n_value);
    return MHD_YES;
}

static void refuse(http_request *r, int status, bf_status code, const char *text)
{
    r->refusal = status;
    (void)bf_fail(&r->fault, code, "", "%s", text);
}

// True if method, target and version stand one behind the other: else there was a zero byte in the
// request line, which ends their texts early.
static bool is_line_whole(const http_request *r, const char *method, const char *version)
{
    return r->target == method + strlen(method) + 1 && version == r->target_end + 1;
}

// The guard: sets r->refusal if the request must not be used.
static void check_header(http_request *r, const char *method, const char *version)
{
    http_guard guard = { .next = version + strlen(version) + 2 };
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(r->mhd, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE);

    if (strlen(method) >= sizeof r->method) {
        refuse(r, 501, BF_EINPUT, "there is no such method");
        return;
    }
    memcpy(r->method, method, strlen(method) + 1);
    if (!is_line_whole(r, method, version)) {
        refuse(r, 400, BF_EINPUT, "the request line is not three words with one space between");
        return;
    }
    if (r->refusal != 0)
        return;
    if (strcmp(r->path, "*") == 0 && strcmp(method, "OPTIONS") != 0) {
        refuse(r, 400, BF_EINPUT, "only OPTIONS has the target *");
        return;
    }
    (void)MHD_get_connection_values_n(r->mhd, MHD_HEADER_KIND, show_header, &guard);
    if (info != NULL)
        http_guard_end(&guard, method + info->header_size);
    r->refusal = http_guard_verdict(&guard, method, version, &r->fault);
}

static void check_reserve(http_request *r)
{
    if (http__connection_is_reserved(r->connection) && r->cost != API_COST_HEALTH)
        refuse(r, 503, BF_EBUSY, "too many connections are open");
}

// One value of X-Forwarded-For is added behind those before; context is a bf_buffer.
static enum MHD_Result gather_forwarded(void *context, enum MHD_ValueKind kind, const char *name,
                                        size_t n_name, const char *value, size_t n_value)
{
    static const char wanted[] = "X-Forwarded-For";

    (void)kind;
    (void)n_value;
    if (n_name != sizeof wanted - 1 || strncasecmp(name, wanted, n_name) != 0)
        return MHD_YES;
    return buffer_printf(context, ",%s", value) == BF_OK ? MHD_YES : MHD_NO;
}

// All clients of the proxy then share one client's limit. Warn at most once a minute.
static void warn_of_proxy(http_request *r)
{
    int64_t now_ms = clock_monotonic_ms();
    int64_t before_ms = atomic_load(&r->server->warned_ms);

    if ((before_ms != 0 && now_ms - before_ms < WARNING_MS) ||
        !atomic_compare_exchange_strong(&r->server->warned_ms, &before_ms, now_ms))
        return;
    log_event(LOG_LEVEL_WARN, "proxy_not_trusted",
              "address=%s error=\"a proxy forwards requests, but is not in trusted_proxies: all "
              "its clients "
              "count as one\"",
              r->client.text);
}

static void identify(http_request *r)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(r->mhd, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    bf_buffer forwarded = { 0 };
    bool is_forwarded_otherwise = http__request_header(r, "Forwarded") != NULL;

    r->trace = http_trace_read(http__request_header(r, "X-Request-Id"),
                               http__request_header(r, "traceparent"));
    (void)MHD_get_connection_values_n(r->mhd, MHD_HEADER_KIND, gather_forwarded, &forwarded);
    r->client = http_client_find(info->client_addr, forwarded.bytes, is_forwarded_otherwise,
                                 &r->server->proxies);
    r->is_of_network =
        info->client_addr->sa_family == AF_INET || info->client_addr->sa_family == AF_INET6;
    buffer_fini(&forwarded);
    if (r->client.is_unknown_proxy)
        warn_of_proxy(r);
}

// The requested host: the target's if it has one, else that of the Host header.
static http_host_verdict classify_host(const http_request *r, const char *host)
{
    char name[HOST_SIZE];
    size_t n = 0;
    const char *authority = http_guard_authority(r->target, &n);
    http_host_verdict verdict = http_host_classify(&r->server->hosts, host);

    if (authority == NULL || verdict == HTTP_HOST_MALFORMED)
        return verdict;
    if (n >= sizeof name)
        return HTTP_HOST_MALFORMED;
    memcpy(name, authority, n);
    name[n] = '\0';
    return http_host_classify(&r->server->hosts, name);
}

// Exempt are requests without Host (HTTP/1.0) and those over other sockets: no browser sends them.
static void check_host(http_request *r)
{
    const char *host = http__request_header(r, "Host");

    if (host == NULL || !r->is_of_network)
        return;
    switch (classify_host(r, host)) {
    case HTTP_HOST_OURS:
        return;
    case HTTP_HOST_MALFORMED:
        refuse(r, 400, BF_EINPUT, "the Host header is not a host with or without a port");
        return;
    case HTTP_HOST_FOREIGN:
        refuse(r, 421, BF_EINPUT,
               "the service does not answer under this host; the setting hosts adds names to it");
    }
}

static void check_origin(http_request *r)
{
    if (http_cors_is_forged(r->server->cors_origins, r->method, http__request_header(r, "Origin"),
                            http__request_header(r, "Sec-Fetch-Site")))
        refuse(r, 403, BF_EINPUT,
               "a page of another site sent this; the setting cors_origins allows pages");
}

static void refuse_body(http_request *r)
{
    r->refusal = 413;
    (void)bf_fail(&r->fault, BF_ELIMIT, "", "the body is larger than %llu bytes, the limit",
                  (unsigned long long)r->server->options.body_limit);
}

// True if a body follows the header; one that says that it is too long is refused at once.
static bool check_length(http_request *r)
{
    const char *length = http__request_header(r, "Content-Length");

    if (length == NULL)
        return http__request_header(r, "Transfer-Encoding") != NULL;
    unsigned long long n = strtoull(length, NULL, 10);
    if (n > r->server->options.body_limit)
        refuse_body(r);
    return n > 0;
}

static void count(http_request *r, int change)
{
    http *h = r->server;

    lock_acquire(&h->lock);
    h->n_requests += (unsigned)change;
    if (h->n_requests == 0 && h->is_stopping)
        lock_wake_all(&h->changed);
    lock_release(&h->lock);
    metrics_add(METRICS_REQUESTS_NOW, 0, change);
    r->is_counted = change > 0;
}

static api_request view(http_request *r)
{
    return (api_request){ .method = r->method,
                          .path = r->path,
                          .query = r->query,
                          .header = http__request_header,
                          .header_context = r,
                          .body = r->body.bytes,
                          .n_body = r->body.n,
                          .client = r->client.is_local ? NULL : r->client.text };
}

static bool begin(http_request *r, const char *method, const char *version)
{
    bool has_body = false;

    r->begun_ns = clock_monotonic_ns();
    count(r, 1);
    http__connection_occupy(r->connection, true);
    check_header(r, method, version);
    identify(r);
    if (r->refusal == 0)
        check_host(r);
    if (r->refusal == 0)
        check_origin(r);
    if (r->refusal == 0) {
        const api_request request = view(r);
        r->cost = api_request_cost(&request);
        check_reserve(r);
    }
    if (r->refusal == 0)
        has_body = check_length(r);
    if (r->refusal != 0) {
        r->connection->lingers = true;
        http__connection_deadline(r->connection, -1);
        http__respond_refuse(r, r->refusal, &r->fault);
        return http__respond(r);
    }
    http__connection_deadline(r->connection, has_body ? r->server->options.body_deadline_ms : -1);
    r->stage = HTTP_STAGE_BODY;
    return true;
}

static bool take_body(http_request *r, const char *bytes, size_t *n)
{
    if (r->body.n + *n > r->server->options.body_limit)
        refuse_body(r);
    else if (buffer_append(&r->body, bytes, *n) != BF_OK)
        refuse(r, 503, BF_ENOMEM, "there is no memory for the body");
    *n = 0;
    if (r->refusal == 0)
        return true;
    r->connection->lingers = true;
    http__respond_refuse(r, r->refusal, &r->fault);
    http__respond_past_body(r);
    return false;
}

static bool is_for_page(const http_request *r)
{
    return r->response.status == 404 && strncmp(r->path, "/v1/", 4) != 0;
}

static void handle(http_request *r)
{
    const api_request request = view(r);

    api_handle(&r->server->services, &request, &r->response);
    if (is_for_page(r))
        http__page_answer(r);
}

// Answer to a long poll beyond the limit of long polls.
static void refuse_long_poll(http_request *r)
{
    bf_error err = { 0 };

    r->response.long_poll.seconds = 0;
    api_response_drop(&r->response, "Preference-Applied");
    if (strcmp(r->method, "POST") == 0)
        return; // it was accepted; waiting was only preferred
    (void)bf_fail(&err, BF_EBUSY, "", "there are %u requests that wait, which is the limit",
                  r->server->options.wait_limit);
    http__respond_refuse(r, 503, &err);
}

// True if the answer, just made, waits for a run.
static bool begin_long_poll(http_request *r)
{
    if (r->response.long_poll.seconds == 0)
        return false;
    if (!http__pull_begin_long_poll(r)) {
        refuse_long_poll(r);
        return false;
    }
    r->stage = HTTP_STAGE_LONG_POLL;
    r->has_waited = true;
    return true;
}

// Make the answer again, unless the client has disconnected.
static void end_long_poll(http_request *r)
{
    const api_request request = view(r);

    http__pull_end(r);
    if (!r->pull.has_failed)
        api_handle_again(&r->server->services, &request, &r->response);
}

bool http__request_work(http_request *r)
{
    if (r->stage == HTTP_STAGE_SENT)
        return http__pull_work(r);
    bool is_waiting = r->stage == HTTP_STAGE_LONG_POLL;
    if (!is_waiting) {
        handle(r);
        is_waiting = begin_long_poll(r);
    }
    if (is_waiting) {
        if (!http__pull_work(r))
            return false;
        end_long_poll(r);
    }
    http__finalize_response(r);
    r->stage = HTTP_STAGE_READY;
    return true;
}

// False: the client exceeded its rate and the answer is set. Local clients are exempt.
static bool check_rate(http_request *r)
{
    bf_error err = { 0 };

    if (r->client.is_local || r->cost == API_COST_HEALTH)
        return true;
    r->verdict = http_limit_take(r->server->limit, r->client.key, r->cost == API_COST_WORK,
                                 clock_monotonic_ms());
    if (!r->verdict.is_refused)
        return true;
    (void)bf_fail(&err, BF_EBUSY, "", "too many requests of %s; the next one is welcome in %u s",
                  r->client.text, r->verdict.retry_after_s);
    http__respond_refuse(r, 429, &err);
    return false;
}

// True if handling it can wait for the disk, so it needs a request thread. Of the health routes
// only readiness does: it writes to the store.
static bool can_block(const http_request *r)
{
    return r->cost == API_COST_HEALTH
               ? strcmp(r->path, "/readyz") == 0
               : r->cost > API_COST_HEALTH || http__page_may_have(r->server, r->path);
}

// MHD reads from the socket when a connection resumes that was suspended while it waited for more of the
// request, and takes the end of what a client sends for the end of the client. So the connection is
// suspended at MHD's second call for the complete request, by when MHD waits for us and not for the socket.
static bool dispatch(http_request *r)
{
    http__connection_deadline(r->connection, -1);
    if (!check_rate(r))
        return http__respond(r);
    if (!can_block(r)) {
        handle(r);
        return http__respond(r);
    }
    r->stage = HTTP_STAGE_COMPLETE;
    return true;
}

static bool queue(http_request *r)
{
    if (http__pool_suspend(r->server->pool, r))
        return true;
    bf_error err = { 0 };
    (void)bf_fail(&err, BF_EBUSY, "", "too many requests are waiting");
    http__respond_refuse(r, 503, &err);
    return http__respond(r);
}

bool http__request_advance(http_request *r, const char *method, const char *version,
                           const char *bytes, size_t *n)
{
    switch (r->stage) {
    case HTTP_STAGE_HEADER:
        return begin(r, method, version);
    case HTTP_STAGE_BODY:
        return *n > 0 ? take_body(r, bytes, n) : dispatch(r);
    case HTTP_STAGE_COMPLETE:
        return queue(r);
    case HTTP_STAGE_READY:
        return http__respond(r);
    case HTTP_STAGE_WORKING:
    case HTTP_STAGE_LONG_POLL:
    case HTTP_STAGE_SENT:
        break;
    }
    return false;
}

// The run that the request is about, or "-": from its path, or where a new one was put.
static const char *run_of(const http_request *r, char *storage)
{
    static const char prefix[] = "/v1/runs/";
    const char *location = api_response_find(&r->response, "Location");
    const char *place = location == NULL ? r->path : location;
    const char *id = strstr(place, prefix);
    if (id == NULL || strspn(id + sizeof prefix - 1, "0123456789abcdef-") < ID_LENGTH)
        return "-";
    memcpy(storage, id + sizeof prefix - 1, ID_LENGTH);
    storage[ID_LENGTH] = '\0';
    return storage;
}

static void log_request(const http_request *r)
{
    char method[LOG_QUOTED_SIZE], path[LOG_QUOTED_SIZE], id[API_ID_SIZE];
    bool is_write = strcmp(r->method, "POST") == 0 || strcmp(r->method, "DELETE") == 0;

    log_event(is_write ? LOG_LEVEL_INFO : LOG_LEVEL_DEBUG, "request",
              "method=%s path=%s status=%d ms=%lld run=%s request_id=%s trace=%s",
              log_quote(r->method, method), log_quote(r->path, path), r->response.status,
              (long long)((clock_monotonic_ns() - r->begun_ns) / 1000000), run_of(r, id),
              r->trace.id, r->trace.parent[0] == '\0' ? "-" : r->trace.parent);
}

// A wait that the client asked for is no measure of the service's latency.
static bool is_timed(const http_request *r)
{
    return !r->response.source.is_stream && !r->has_waited;
}

static void measure_request(const http_request *r)
{
    const char *route = r->response.route;

    metrics_count_request(route == NULL ? METRICS_NO_ROUTE : route, r->method, r->response.status,
                          is_timed(r) ? clock_monotonic_ns() - r->begun_ns : -1);
}

void http__request_close(http_request *r)
{
    if (r == NULL)
        return;
    http__pull_end(r);
    http__connection_deadline(r->connection,
                              HTTP_IDLE_S * 1000 + r->server->options.header_deadline_ms);
    if (r->is_counted) {
        log_request(r);
        measure_request(r);
        count(r, -1);
        http__connection_occupy(r->connection, false);
    }
    if (r->file.fd >= 0)
        (void)close(r->file.fd);
    buffer_fini(&r->body);
    api_response_fini(&r->response);
    memory_free(r);
}
