// What is pulled chunk by chunk on the request threads: bodies that are made while they are sent (event
// streams, downloads), and the end of a wait before the answer is made (long polls, whose chunks are
// empty). While nothing can be sent, the connection is suspended and costs no thread.
//
// A pull is in exactly one of three places, and only its owner there may access it:
//
//     MHD        the connection is not suspended; MHD calls the reader
//     a thread   it is suspended; the request is in the pool's queue, or a request thread has it
//     parked     it is suspended and has no owner; under http.lock any thread may queue it
//
// No wake-up may be lost, and MHD forbids to suspend what is suspended and to resume what is not.
// Under http.lock each pull has a counter of wake-ups (n_notified) and one flag (is_parked).
//
//     request thread                               waker (any thread, after a commit)
//     R1  lock; n_seen = n_notified; unlock        W1  lock
//     R2  next_chunk (reads the store)             W2  n_notified++
//     R3  bytes or the end: resume, to MHD         W3  if is_parked: is_parked = false, queue it
//     R4  lock                                     W4  unlock
//     R5  n_notified != n_seen: unlock, go to R1
//     R6  is_parked = true; unlock
//
//     reader (MHD's thread)
//     M1  bytes of the chunk left: hand them out
//     M2  the chunk was the last: end
//     M3  lock; suspend
//     M4  the chunk ended in BODY_WAIT and n_notified == n_seen: is_parked = true, else queue it
//     M5  unlock; return 0
//
// Take a commit that R2 did not see. It became visible after R2 began, so its waker runs W1 after R1. If
// W2 comes before R4 (or M3), R5 (or M4) sees it and has the next chunk made. If it comes after R6 (or
// M5), W3 sees the flag and queues the request. There is nothing in between, because R4 to R6, M3 to M5
// and W1 to W4 exclude each other. Suspend (M3) and resume (R3) alternate: between them MHD calls
// nothing for the connection.
//
// The same holds for all other reasons to wake: a heartbeat that is due, a client that disconnected, a
// deadline (all three seen by the watching thread), and the end of the server (is_stopping), after
// which nothing is parked or queued any more.
//
// A run that is computed commits many times a second, and many may wait for its end: two looks of a
// long poll are LONG_POLL_INTERVAL_MS apart, and the watching thread does those that were put off.

#include "server/http/pull.h"

#include "core/base/check.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/http/http_priv.h"
#include "server/http/pool.h"

#include <limits.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/socket.h>

enum {
    STREAM_CHUNK = 64 * 1024,    // bytes of events that are read from the store at once
    ARRAY_CHUNK = 128 * 1024,    // bytes of an array that are read at once
    DOWNLOAD_CHUNK = 256 * 1024, // bytes of a download that are made at once
    STREAM_IDLE_S = 60,         // a connection whose client takes none of its stream is closed then
    STREAM_ACK_MS = 30000,      // and one whose client acknowledges nothing
    LONG_POLL_INTERVAL_MS = 20, // between two looks at a run that changes
};

#define NEVER INT64_MAX

static unsigned limit_of(const http *h, http_pull_kind kind)
{
    switch (kind) {
    case HTTP_PULL_STREAM:
        return h->options.stream_limit;
    case HTTP_PULL_DOWNLOAD:
        return h->options.download_limit;
    case HTTP_PULL_ARRAY:
        return UINT_MAX; // limited with the connections, and in memory
    case HTTP_PULL_LONG_POLL:
    case HTTP_PULL_KINDS:
        break;
    }
    return h->options.wait_limit;
}

// A client has a quarter of the downloads, so that slow readers of one do not keep all others waiting. This machine's own
// clients have all of them, as of other limits.
static bool may_download(const http *h, const http_request *r, http_pull_kind kind)
{
    const unsigned n_most = (h->options.download_limit + 3) / 4;
    const http_request *other;
    unsigned n = 0;

    lock_assert_held(&h->lock);
    if (kind != HTTP_PULL_DOWNLOAD || r->client.is_local)
        return true;
    LIST_FOREACH(other, &h->pulls, pull.entry)
        n += other->pull.kind == kind &&
             memcmp(other->client.key, r->client.key, sizeof r->client.key) == 0;
    return n < n_most;
}

// Puts the pull into the list. False: there are as many of its kind as may be.
static bool begin(http_request *r, http_pull_kind kind)
{
    http *h = r->server;
    http_pull *p = &r->pull;

    p->kind = kind;
    p->state = BODY_MORE;
    p->sent_ms = clock_monotonic_ms();
    lock_acquire(&h->lock);
    // A long poll that begins now is answered at once.
    bool is_too_late = h->is_stopping && kind != HTTP_PULL_LONG_POLL;
    bool is_admitted =
        !is_too_late && h->n_pulls[kind] < limit_of(h, kind) && may_download(h, r, kind);
    if (is_admitted) {
        h->n_pulls[kind]++;
        p->is_under_way = true;
        LIST_INSERT_HEAD(&h->pulls, r, pull.entry);
    }
    lock_release(&h->lock);
    return is_admitted;
}

static http_pull_kind kind_of(const body_source *source)
{
    if (source->is_stream)
        return HTTP_PULL_STREAM;
    return source->seek != NULL ? HTTP_PULL_ARRAY : HTTP_PULL_DOWNLOAD;
}

size_t http__pull_chunk(const body_source *source)
{
    static const size_t chunks[HTTP_PULL_KINDS] = { [HTTP_PULL_STREAM] = STREAM_CHUNK,
                                                    [HTTP_PULL_ARRAY] = ARRAY_CHUNK,
                                                    [HTTP_PULL_DOWNLOAD] = DOWNLOAD_CHUNK };

    return chunks[kind_of(source)];
}

bool http__pull_begin_body(http_request *r)
{
    unsigned ack_ms = STREAM_ACK_MS;

    r->pull = (http_pull){ .source = r->response.source, .deadline_ms = NEVER };
    if (!begin(r, kind_of(&r->pull.source)))
        return false;
    if (!r->pull.source.is_stream)
        return true;
    metrics_add(METRICS_STREAMS, 0, 1);
    (void)setsockopt(r->connection->fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &ack_ms, sizeof ack_ms);
    (void)MHD_set_connection_option(r->mhd, MHD_CONNECTION_OPTION_TIMEOUT, (unsigned)STREAM_IDLE_S);
    return true;
}

// The chunks of a long poll are empty; the last one comes when there is nothing to wait for any more.
static bf_status next_look(void *state, const api_services *services, size_t limit_bytes,
                           bf_buffer *out, body_state *ret_state, bf_error *err)
{
    const http_request *r = state;

    (void)limit_bytes;
    (void)out;
    (void)err;
    *ret_state = api_long_poll_is_over(services, &r->response.long_poll) ? BODY_DONE : BODY_WAIT;
    return BF_OK;
}

bool http__pull_begin_long_poll(http_request *r)
{
    const api_long_poll *poll = &r->response.long_poll;
    http_pull *p = &r->pull;

    *p = (http_pull){ .source = { .state = r, .next_chunk = next_look, .n_runs = 1 },
                      .interval_ms = LONG_POLL_INTERVAL_MS,
                      .deadline_ms = clock_monotonic_ms() + 1000 * (int64_t)poll->seconds };
    p->source.runs = &poll->run;
    return begin(r, HTTP_PULL_LONG_POLL);
}

void http__pull_end(http_request *r)
{
    http *h = r->server;
    http_pull *p = &r->pull;

    if (!p->is_under_way)
        return;
    lock_acquire(&h->lock);
    BF_CHECK(!p->is_parked);
    LIST_REMOVE(r, pull.entry);
    h->n_pulls[p->kind]--;
    lock_release(&h->lock);
    if (p->kind == HTTP_PULL_STREAM)
        metrics_add(METRICS_STREAMS, 0, -1);
    p->is_under_way = false;
    buffer_fini(&p->chunk);
}

static void queue(http *h, http_request *r)
{
    lock_assert_held(&h->lock);
    r->pull.is_parked = false;
    http__pool_enqueue(h->pool, r);
}

void http_notify(http *h, const char *run_id)
{
    http_request *r;

    lock_acquire(&h->lock);
    int64_t now_ms = LIST_EMPTY(&h->pulls) ? 0 : clock_monotonic_ms();
    LIST_FOREACH(r, &h->pulls, pull.entry) {
        http_pull *p = &r->pull;
        size_t i = 0;
        while (i < p->source.n_runs && strcmp(p->source.runs[i], run_id) != 0)
            i++;
        if (i == p->source.n_runs)
            continue; // it waits for others
        p->n_notified++;
        if (!p->is_parked)
            continue;
        int64_t due_ms = p->polled_ms + p->interval_ms;
        if (due_ms <= now_ms) {
            queue(h, r);
        } else if (due_ms < p->due_ms) {
            p->due_ms = due_ms;
            lock_wake_all(&h->changed);
        }
    }
    lock_release(&h->lock);
}

// A client that has shut down its sending side may still read, or be gone. Bytes tell: a host answers
// those for a closed socket by a reset. So a stream gets a heartbeat then, and goes on unless the connection
// breaks. A long poll has no bytes to send before its answer, and is answered.
static void look_for_client(http_request *r)
{
    http_pull *p = &r->pull;
    bool has_hung_up = http__connection_has_hung_up(r->connection->fd);

    lock_assert_held(&r->server->lock);
    if (p->source.heartbeat == NULL) {
        p->is_disconnected = has_hung_up;
        return;
    }
    p->is_disconnected = http__connection_is_broken(r->connection->fd);
    p->is_heartbeat_due = has_hung_up && !p->is_half_closed;
    p->is_half_closed = has_hung_up;
}

// False: the token that a stream was asked for with does not count any more. Other bodies end by themselves.
static bool is_token_valid(const http_request *r)
{
    const api_services *services = &r->server->services;
    uint64_t token = r->response.who.token;
    api_identity who;

    return r->pull.kind != HTTP_PULL_STREAM || token == 0 ||
           services->identify_by_id(services->service, token, &who) == API_CREDENTIAL_VALID;
}

int64_t http__pull_watch(http *h, int64_t now_ms, bool looks_for_disconnected)
{
    int64_t next_ms = NEVER;
    http_request *r;

    lock_assert_held(&h->lock);
    LIST_FOREACH(r, &h->pulls, pull.entry) {
        http_pull *p = &r->pull;
        if (!p->is_parked)
            continue;
        if (looks_for_disconnected)
            look_for_client(r);
        if (p->source.heartbeat != NULL && now_ms - p->sent_ms >= h->options.heartbeat_ms)
            p->is_heartbeat_due = true;
        if (p->is_disconnected || p->is_heartbeat_due || now_ms >= p->due_ms ||
            (looks_for_disconnected && !is_token_valid(r)))
            queue(h, r);
        else if (p->due_ms < next_ms)
            next_ms = p->due_ms;
    }
    return next_ms;
}

void http__pull_stop_all(http *h)
{
    http_request *r;

    lock_acquire(&h->lock);
    h->is_stopping = true;
    LIST_FOREACH(r, &h->pulls, pull.entry)
        if (r->pull.is_parked)
            queue(h, r);
    lock_release(&h->lock);
}

// Step R1. False: it ends, even if the store has more. A download that is cut off by a shutdown is reported as
// incomplete; a stream has no defined end, and a long poll is answered.
static bool look(http_request *r, bool *ret_is_heartbeat_due)
{
    http *h = r->server;
    http_pull *p = &r->pull;

    lock_acquire(&h->lock);
    p->n_seen = p->n_notified;
    *ret_is_heartbeat_due = p->is_heartbeat_due;
    p->is_heartbeat_due = false;
    bool is_stopping = h->is_stopping;
    bool is_disconnected = p->is_disconnected;
    lock_release(&h->lock);
    const bool has_end = p->kind == HTTP_PULL_ARRAY || p->kind == HTTP_PULL_DOWNLOAD;
    p->has_failed = is_disconnected || (is_stopping && has_end);
    if (is_stopping || clock_monotonic_ms() >= p->deadline_ms || !is_token_valid(r))
        p->state = BODY_DONE;
    return !p->has_failed && p->state != BODY_DONE;
}

// Step R2. After a failure the body is cut off, so that the client detects the truncation.
static void make_chunk(http_request *r, bool is_heartbeat_due)
{
    http_pull *p = &r->pull;
    const body_source *source = &p->source;
    char path[LOG_QUOTED_SIZE], text[LOG_QUOTED_SIZE];
    bf_error err = { 0 };

    const int64_t begun_ns = r->server->options.clocks.thread_cpu_ns();

    p->n_taken = p->chunk.n = 0;
    bf_status status = source->next_chunk(source->state, &r->server->services,
                                          http__pull_chunk(source), &p->chunk, &p->state, &err);
    http__request_charge(r, begun_ns);
    if (status == BF_OK && is_heartbeat_due && p->chunk.n == 0 && p->state == BODY_WAIT)
        status = buffer_append(&p->chunk, source->heartbeat, strlen(source->heartbeat));
    if (status == BF_OK)
        return;
    p->chunk.n = 0;
    p->has_failed = true;
    if (source->is_stream)
        log_event(LOG_LEVEL_WARN, "stream_failed", "run=%s error=%s", source->runs[0],
                  log_quote(err.text, text));
    else
        log_event(LOG_LEVEL_WARN, "download_failed", "path=%s error=%s", log_quote(r->path, path),
                  log_quote(err.text, text));
}

// Steps R4 to R6, and the same from an empty chunk after which there is more: that goes behind all others
// in the queue. False: it must go on at once, as something happened since the look.
static bool leave(http_request *r)
{
    http *h = r->server;
    http_pull *p = &r->pull;

    if (p->state == BODY_WAIT)
        buffer_fini(&p->chunk);
    lock_acquire(&h->lock);
    bool has_news = p->n_notified != p->n_seen;
    bool can_leave = !h->is_stopping && (!has_news || p->interval_ms > 0 || p->state == BODY_MORE);
    if (can_leave && p->state == BODY_MORE) {
        queue(h, r);
    } else if (can_leave) {
        p->polled_ms = clock_monotonic_ms();
        p->due_ms = has_news ? p->polled_ms + p->interval_ms : p->deadline_ms;
        p->is_parked = true;
        if (has_news)
            lock_wake_all(&h->changed);
    }
    lock_release(&h->lock);
    return can_leave;
}

bool http__pull_work(http_request *r)
{
    http_pull *p = &r->pull;
    bool is_heartbeat_due = false;

    while (look(r, &is_heartbeat_due)) {
        make_chunk(r, is_heartbeat_due);
        if (p->chunk.n > 0 || p->state == BODY_DONE || p->has_failed)
            return true;
        if (leave(r))
            return false;
    }
    return true;
}

// Steps M3 to M5. False: the server stops.
static bool suspend(http_request *r)
{
    http *h = r->server;
    http_pull *p = &r->pull;

    if (p->state == BODY_WAIT)
        buffer_fini(&p->chunk);
    lock_acquire(&h->lock);
    bool can_suspend = !h->is_stopping;
    if (can_suspend) {
        MHD_suspend_connection(r->mhd);
        p->due_ms = p->deadline_ms;
        p->is_parked = p->state == BODY_WAIT && p->n_notified == p->n_seen;
        if (!p->is_parked)
            queue(h, r);
    }
    lock_release(&h->lock);
    return can_suspend;
}

static ssize_t hand_out(http_request *r, char *bytes, size_t n)
{
    http_pull *p = &r->pull;
    size_t n_left = p->chunk.n - p->n_taken;

    n = n < n_left ? n : n_left;
    memcpy(bytes, p->chunk.bytes + p->n_taken, n);
    p->n_taken += n;
    if (p->kind != HTTP_PULL_STREAM)
        return (ssize_t)n;
    metrics_add(METRICS_STREAM_BYTES, 0, (int64_t)n);
    p->sent_ms = clock_monotonic_ms(); // the watch reads it of parked ones only
    return (ssize_t)n;
}

ssize_t http__pull_read(void *context, uint64_t position, char *bytes, size_t n)
{
    http_request *r = context;
    http_pull *p = &r->pull;

    (void)position;
    if (p->n_taken < p->chunk.n)
        return hand_out(r, bytes, n);
    if (p->has_failed)
        return MHD_CONTENT_READER_END_WITH_ERROR;
    if (p->state == BODY_DONE)
        return MHD_CONTENT_READER_END_OF_STREAM;
    if (suspend(r))
        return 0;
    return p->kind == HTTP_PULL_STREAM ? MHD_CONTENT_READER_END_OF_STREAM
                                       : MHD_CONTENT_READER_END_WITH_ERROR;
}
