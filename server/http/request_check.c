// Whether a request may be used: its header by the guard, who sent it, to which host, for which page. A request
// that is at fault is refused before its body is read.

#include "server/http/http_priv.h"

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/http/cors.h"
#include "server/http/guard.h"

#include <microhttpd.h>
#include <netinet/in.h>
#include <stdatomic.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>

enum {
    HOST_SIZE = 300,    // of a host with its port
    WARNING_MS = 60000, // between two warnings of the same
};

static enum MHD_Result show_header(void *context, enum MHD_ValueKind kind, const char *name,
                                   size_t n_name, const char *value, size_t n_value)
{
    (void)kind;
    http_guard_header(context, name, n_name, value, n_value);
    return MHD_YES;
}

void http__request_refuse(http_request *r, int status, bf_status code, const char *text)
{
    r->refusal = status;
    (void)bf_fail(&r->fault, code, "", "%s", text);
}

// The guard: sets r->refusal if the request must not be used.
static void check_header(http_request *r, const char *method, const char *version)
{
    http_guard guard = { .next = version + strlen(version) + 2 };
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(r->mhd, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE);

    if (strlen(method) >= sizeof r->method) {
        http__request_refuse(r, 501, BF_EINPUT, "there is no such method");
        return;
    }
    memcpy(r->method, method, strlen(method) + 1);
    // Else there was a zero byte in the request line, which ends the texts of its words early.
    if (r->target != method + strlen(method) + 1 || version != r->target_end + 1) {
        http__request_refuse(r, 400, BF_EINPUT,
                             "the request line is not three words with one space between");
        return;
    }
    if (r->refusal != 0)
        return;
    if (strcmp(r->path, "*") == 0 && strcmp(method, "OPTIONS") != 0) {
        http__request_refuse(r, 400, BF_EINPUT, "only OPTIONS has the target *");
        return;
    }
    (void)MHD_get_connection_values_n(r->mhd, MHD_HEADER_KIND, show_header, &guard);
    if (info != NULL)
        http_guard_end(&guard, method + info->header_size);
    r->refusal = http_guard_verdict(&guard, method, version, &r->fault);
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

void http__request_identify(http_request *r)
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
        http__request_refuse(r, 400, BF_EINPUT,
                             "the Host header is not a host with or without a port");
        return;
    case HTTP_HOST_FOREIGN:
        http__request_refuse(
            r, 421, BF_EINPUT,
            "the service does not answer under this host; the setting hosts adds names to it");
    }
}

void http__request_check(http_request *r, const char *method, const char *version)
{
    check_header(r, method, version);
    http__request_identify(r);
    if (r->refusal == 0)
        check_host(r);
    if (r->refusal == 0) {
        const http_cors_sender sender = { .method = r->method,
                                          .origin = http__request_header(r, "Origin"),
                                          .fetch_site = http__request_header(r, "Sec-Fetch-Site"),
                                          .host = http__request_header(r, "Host") };
        if (http_cors_is_forged(r->server->cors_origins, &sender))
            http__request_refuse(
                r, 403, BF_EINPUT,
                "a page of another origin sent this; the setting cors_origins allows pages");
    }
}
