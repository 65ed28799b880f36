#include "api/json/number.h"
#include "server/http/answer_memory.h"
#include "server/http/http_priv.h"
#include "server/http/pool.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/http/guard.h"

#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { ID_LENGTH = API_ID_SIZE - 1 };

// The request whose line was the last one to be parsed on this thread, until its header is complete.
static _Thread_local http_request *opened;

http_request *http__request_open(http *h, struct MHD_Connection *mhd, const char *target)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(mhd, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    http_connection *c = info == NULL ? NULL : info->socket_context;
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
    opened = r;
    return r;
}

const char *http__request_header(void *context, const char *name)
{
    const http_request *r = context;
    return MHD_lookup_connection_value(r->mhd, MHD_HEADER_KIND, name);
}

// Answers a request whose body is not, or not wholly, received.
static void answer_refused_body(http_request *r)
{
    r->connection->lingers = true;
    http__respond_refuse(r, r->refusal, r->fault.code, "%s", r->fault.text);
    http__respond_past_body(r);
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
                          .reserve = http__answer_reserve,
                          .is_cancelled = &r->server->is_ending,
                          .header_context = r,
                          .body = r->body.bytes,
                          .n_body = r->body.n,
                          .body_limit = r->server->options.body_limit,
                          .client = r->client.is_local ? NULL : r->client.text };
}

void http__request_refuse_length(void)
{
    http_request *r = opened;
    const char *length = r == NULL ? NULL : http__request_header(r, "Content-Length");
    uint64_t n;

    if (length == NULL || http__request_header(r, "Transfer-Encoding") != NULL ||
        number_read_digits(length, 0, UINT64_MAX, &n))
        return;
    opened = NULL;
    r->begun_ns = clock_monotonic_ns();
    count(r, 1);
    http__request_identify(r);
    if (length[strspn(length, "0123456789")] == '\0' && *length != '\0')
        refuse_body(r);
    else
        http__request_refuse(r, 400, BF_EINPUT, "Content-Length is not a number");
    answer_refused_body(r);
    (void)shutdown(r->connection->fd, SHUT_WR);
}

// True if the framing of this request's body is at fault, as far as it was received.
static bool is_misframed(http_request *r)
{
    const http_framing *f = &r->connection->received.framing;

    if (f->refusal == 0 || f->n_messages != r->connection->n_begun)
        return false;
    http__request_refuse(r, f->refusal, f->refusal == 413 ? BF_ELIMIT : BF_EINPUT, f->fault);
    return true;
}

bool http__request_refuse_framing(void *connection)
{
    const http_connection *c = connection;
    http_request *r = c->request;

    if (r == NULL || r->stage != HTTP_STAGE_BODY || !is_misframed(r))
        return false;
    answer_refused_body(r);
    return true;
}

static bool has_rate(const http_request *r)
{
    return !r->client.is_local && r->cost != API_COST_HEALTH;
}

// False: the client exceeded its rate and the answer is set. Local clients are exempt.
static bool check_rate(http_request *r)
{
    if (!has_rate(r))
        return true;
    r->verdict = http_limit_take(r->server->limit, r->client.key, r->cost >= API_COST_WORK,
                                 r->server->options.clocks.monotonic_ms());
    if (!r->verdict.is_refused)
        return true;
    http__respond_refuse(r, 429, BF_EBUSY,
                         "too many requests of %s; the next one is welcome in %u s", r->client.text,
                         r->verdict.retry_after_s);
    return false;
}

// Decides by the header alone what becomes of a request and its body, so that nothing is held for who may not send it.
static bool begin(http_request *r, const char *method, const char *version)
{
    bool has_body = false;

    opened = NULL;
    r->begun_ns = clock_monotonic_ns();
    count(r, 1);
    http__connection_occupy(r->connection, true);
    r->connection->request = r;
    r->connection->n_begun++;

    http__request_check(r, method, version);
    const api_request request = view(r);
    if (r->refusal == 0 && !is_misframed(r)) {
        r->cost = api_request_cost(&request);
        if (http__connection_is_reserved(r->connection) && r->cost != API_COST_HEALTH)
            http__request_refuse(r, 503, BF_EBUSY, "too many connections are open");
    }
    if (r->refusal == 0)
        has_body = check_length(r);
    if (r->refusal == 0 && has_body) {
        const api_body what = api_admit_body(&r->server->services, &request, &r->response);
        r->needs_body = what == API_BODY_NEEDED;
        if (what == API_BODY_REFUSED) {
            (void)check_rate(r); // a refusal counts like any other request
            r->refusal = r->response.status;
        }
    }

    if (r->refusal != 0) {
        r->connection->lingers = true;
        http__connection_deadline(r->connection, -1);
        if (r->response.status == 0)
            http__respond_refuse(r, r->refusal, r->fault.code, "%s", r->fault.text);
        return http__respond(r);
    }
    http__connection_deadline(r->connection, has_body ? r->server->options.body_deadline_ms : -1);
    r->stage = HTTP_STAGE_BODY;
    return true;
}

static bool take_body(http_request *r, const char *bytes, size_t *n)
{
    r->n_body += *n;
    if (r->n_body > r->server->options.body_limit)
        refuse_body(r);
    else if (r->needs_body && buffer_append(&r->body, bytes, *n) != BF_OK)
        http__request_refuse(r, 503, BF_ENOMEM, "there is no memory for the body");
    *n = 0;
    if (r->refusal == 0)
        return true;
    answer_refused_body(r);
    return false;
}

static void handle(http_request *r)
{
    const api_request request = view(r);

    api_handle(&r->server->services, &request, &r->response);
    if (r->response.status == 404 && strncmp(r->path, "/v1/", 4) != 0)
        http__page_answer(r);
}

// True if the answer, just made, waits for a run.
static bool begin_long_poll(http_request *r)
{
    if (r->response.long_poll.seconds == 0)
        return false;
    if (http__pull_begin_long_poll(r)) {
        r->stage = HTTP_STAGE_LONG_POLL;
        r->has_waited = true;
        return true;
    }
    r->response.long_poll.seconds = 0;
    api_response_drop(&r->response, "Preference-Applied");
    // What was accepted stays so: waiting for it was only preferred.
    if (strcmp(r->method, "POST") != 0)
        http__respond_refuse(r, 503, BF_EBUSY,
                             "there are %u requests that wait, which is the limit",
                             r->server->options.wait_limit);
    return false;
}

void http__request_charge(http_request *r, int64_t begun_ns)
{
    const int64_t before_ns = r->cpu_ns;

    if (!has_rate(r))
        return;
    r->cpu_ns += r->server->options.clocks.thread_cpu_ns() - begun_ns;
    http_limit_charge(r->server->limit, r->client.key, r->cost >= API_COST_WORK, before_ns,
                      r->cpu_ns, r->server->options.clocks.monotonic_ms());
}

bool http__request_work(http_request *r)
{
    if (r->stage == HTTP_STAGE_SENT)
        return http__pull_work(r);
    int64_t begun_ns = r->server->options.clocks.thread_cpu_ns();
    bool is_waiting = r->stage == HTTP_STAGE_LONG_POLL;
    if (!is_waiting) {
        handle(r);
        is_waiting = begin_long_poll(r);
    }
    if (is_waiting) {
        http__request_charge(r, begun_ns);
        if (!http__pull_work(r))
            return false;
        begun_ns = r->server->options.clocks.thread_cpu_ns();
        http__pull_end(r);
        // The answer is made again, unless the client has disconnected.
        const api_request request = view(r);
        if (!r->pull.has_failed)
            api_handle_again(&r->server->services, &request, &r->response);
    }
    http__answer_settle(r);
    http__finalize_response(r);
    http__request_charge(r, begun_ns);
    r->stage = HTTP_STAGE_READY;
    return true;
}

// True if handling it can wait for the disk or takes a while, so that it needs a request thread. Of the health routes only
// liveness does not: readiness writes to the store, and many figures take some milliseconds, in which nobody would hear
// whether the daemon lives. A run that is at hand now may not be in a moment; then it is read here.
static bool can_block(http_request *r)
{
    const api_request request = view(r);

    if (r->cost == API_COST_HEALTH)
        return strcmp(r->path, "/livez") != 0;
    if (r->cost == API_COST_STORE && api_request_is_cached(&r->server->services, &request))
        return false;
    return r->cost > API_COST_HEALTH || http__page_may_have(r->server, r->path);
}

// MHD reads from the socket when a connection resumes that was suspended while it waited for more of the
// request, and takes the end of what a client sends for the end of the client. So the connection is
// suspended at MHD's second call for the complete request, by when MHD waits for us and not for the socket.
static bool dispatch(http_request *r)
{
    http__connection_deadline(r->connection, -1);
    if (!check_rate(r))
        return http__respond(r);
    if (can_block(r)) {
        r->stage = HTTP_STAGE_COMPLETE;
        return true;
    }
    const int64_t begun_ns = has_rate(r) ? r->server->options.clocks.thread_cpu_ns() : 0;
    handle(r);
    http__answer_settle(r);
    http__request_charge(r, begun_ns);
    return http__respond(r);
}

static bool queue(http_request *r)
{
    if (http__pool_suspend(r->server->pool, r))
        return true;
    http__respond_refuse(r, 503, BF_EBUSY, "too many requests are waiting");
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

void http__request_close(http_request *r)
{
    if (r == NULL)
        return;
    if (opened == r)
        opened = NULL;
    if (r->connection->request == r)
        r->connection->request = NULL;
    http__pull_end(r);
    http__connection_deadline(r->connection,
                              HTTP_IDLE_S * 1000 + r->server->options.header_deadline_ms);
    if (r->is_counted) {
        const char *route = r->response.route;
        // A wait that the client asked for is no measure of the service's latency.
        const bool is_timed = !r->response.source.is_stream && !r->has_waited;
        const api_identity *identity = &r->response.who;
        char who[API_OWNER_SIZE + 48] = ""; // with tokens in use, who changed something
        char method[LOG_QUOTED_SIZE], path[LOG_QUOTED_SIZE], id[API_ID_SIZE];
        const bool is_write = strcmp(r->method, "POST") == 0 || strcmp(r->method, "PATCH") == 0 ||
                              strcmp(r->method, "DELETE") == 0;
        const bool logs_all = r->server->options.logs_all;
        if (identity->token != 0)
            (void)snprintf(who, sizeof who, " token=%llu owner=%s",
                           (unsigned long long)identity->token, identity->owner);
        log_event(is_write || logs_all ? LOG_LEVEL_INFO : LOG_LEVEL_DEBUG, "request",
                  "method=%s path=%s status=%d ms=%lld run=%s request_id=%s trace=%s%s%s%s",
                  log_quote(r->method, method), log_quote(r->path, path), r->response.status,
                  (long long)((clock_monotonic_ns() - r->begun_ns) / 1000000), run_of(r, id),
                  r->trace.id, r->trace.parent[0] == '\0' ? "-" : r->trace.parent, who,
                  logs_all ? " client=" : "", logs_all ? r->client.text : "");
        metrics_count_request(route == NULL ? METRICS_NO_ROUTE : route, r->method,
                              r->response.status,
                              is_timed ? clock_monotonic_ns() - r->begun_ns : -1);
        count(r, -1);
        http__connection_occupy(r->connection, false);
    }
    if (r->file.fd >= 0)
        (void)close(r->file.fd);
    buffer_fini(&r->body);
    api_response_fini(&r->response);
    http__answer_release(r);
    memory_free(r);
}
