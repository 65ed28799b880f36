// Event streams: a stream sleeps (its connection is suspended) while the store has nothing for it,
// and http_notify() wakes it. No wake-up may be lost, and MHD forbids to suspend what is suspended
// and to resume what is not.
//
// The protocol. Under http.lock each stream has a counter of wake-ups (n_notified) and one flag
// (is_suspended), which says what MHD was told last.
//
//     reader (MHD's thread)                         waker (any thread, after a commit)
//     R1  lock; seen = n_notified; unlock           W1  lock
//     R2  read the store                            W2  n_notified++
//     R3  something came: hand it out, later R1     W3  if is_suspended: is_suspended = false,
//     R4  lock                                            MHD_resume_connection()
//     R5  n_notified != seen: unlock, go to R1      W4  unlock
//     R6  MHD_suspend_connection(),
//         is_suspended = true; unlock; return 0
//
// Take a commit that R2 did not see. It became visible after R2 began, so its waker runs W1 after
// R1. If W2 comes before R4, R5 sees it and reads again. If it comes after R6, W3 sees the flag and
// resumes. There is nothing in between, because R4 to R6 and W1 to W4 exclude each other. And since
// the flag changes only together with the call to MHD, suspend and resume strictly alternate; the
// reader is not called while the connection is suspended, so it never suspends twice.
//
// The same holds for all other reasons to wake: a heartbeat that is due, a client that left (both
// seen by the watching thread), and the end (is_stopping), which R4 checks too: after it nothing
// suspends any more.
//
// A stream owns no queue: its cursor says how far it is, and one batch of at most about
// HTTP_STREAM_BATCH bytes is in memory while the client takes it. While it sleeps it owns nothing.

#include "server/http/http_priv.h"

#include "core/base/check.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <microhttpd.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/socket.h>

enum { STREAM_ACK_MS = 30000 }; // a client that acknowledges nothing for so long is gone

// What the reader finds when it looks at its flags.
typedef struct stream_look {
    uint64_t seen;       // n_notified
    bool is_stopping;    // the server stops
    bool has_left;       // the client hung up
    bool owes_heartbeat; // something must be sent
} stream_look;

static void fill_in(http_stream *s, const http_request *r)
{
    const body_source *source = &r->response.source;
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(r->mhd, MHD_CONNECTION_INFO_CONNECTION_FD);

    s->mhd = r->mhd;
    s->fd = info->connect_fd;
    s->n_runs = source->n_runs;
    memcpy(s->runs, source->runs, source->n_runs * sizeof *source->runs);
    s->sent_ms = clock_monotonic_ms();
}

bool http__stream_begin(http_request *r)
{
    http *h = r->server;
    http_stream *s = &r->stream;
    unsigned ack_ms = STREAM_ACK_MS;

    fill_in(s, r);
    lock_take(&h->lock);
    if (h->is_stopping || h->n_streams >= h->options.stream_limit) {
        lock_give(&h->lock);
        return false;
    }
    h->n_streams++;
    s->next = h->streams;
    if (s->next != NULL)
        s->next->previous = s;
    h->streams = s;
    r->is_stream = true;
    metrics_add(METRICS_STREAMS, 0, 1);
    lock_give(&h->lock);
    (void)setsockopt(s->fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &ack_ms, sizeof ack_ms);
    (void)MHD_set_connection_option(r->mhd, MHD_CONNECTION_OPTION_TIMEOUT,
                                    (unsigned)HTTP_STREAM_IDLE_S);
    return true;
}

void http__stream_end(http_request *r)
{
    http *h = r->server;
    http_stream *s = &r->stream;

    if (!r->is_stream)
        return;
    lock_take(&h->lock);
    BF_CHECK(!s->is_suspended);
    if (s->previous != NULL)
        s->previous->next = s->next;
    else
        h->streams = s->next;
    if (s->next != NULL)
        s->next->previous = s->previous;
    h->n_streams--;
    r->is_stream = false;
    lock_give(&h->lock);
    metrics_add(METRICS_STREAMS, 0, -1);
    buffer_fini(&s->batch);
}

static void wake(http *h, http_stream *s)
{
    lock_assert_held(&h->lock);
    s->n_notified++;
    if (!s->is_suspended)
        return;
    s->is_suspended = false;
    MHD_resume_connection(s->mhd);
}

static bool follows(const http_stream *s, const char *run_id)
{
    for (size_t i = 0; i < s->n_runs; i++) {
        if (strcmp(s->runs[i], run_id) == 0)
            return true;
    }
    return false;
}

void http_notify(http *h, const char *run_id)
{
    lock_take(&h->lock);
    for (http_stream *s = h->streams; s != NULL; s = s->next) {
        if (follows(s, run_id))
            wake(h, s);
    }
    http__wait_notify(h, run_id);
    lock_give(&h->lock);
}

void http__stream_watch(http *h, int64_t now_ms)
{
    lock_assert_held(&h->lock);
    for (http_stream *s = h->streams; s != NULL; s = s->next) {
        if (!s->is_suspended)
            continue;
        s->has_left = http__connection_has_hung_up(s->fd);
        s->owes_heartbeat = now_ms - s->sent_ms >= h->options.heartbeat_ms;
        if (s->has_left || s->owes_heartbeat)
            wake(h, s);
    }
}

void http__stream_end_all(http *h)
{
    lock_take(&h->lock);
    h->is_stopping = true;
    for (http_stream *s = h->streams; s != NULL; s = s->next)
        wake(h, s);
    lock_give(&h->lock);
}

static stream_look look(http *h, http_stream *s)
{
    lock_take(&h->lock);
    stream_look seen = { s->n_notified, h->is_stopping, s->has_left, s->owes_heartbeat };
    s->owes_heartbeat = false;
    lock_give(&h->lock);
    return seen;
}

// Steps R4 to R6. False: something happened since the look, read again.
static bool suspend(http *h, http_stream *s, uint64_t seen)
{
    buffer_fini(&s->batch);
    lock_take(&h->lock);
    bool is_quiet = s->n_notified == seen && !h->is_stopping;
    if (is_quiet) {
        MHD_suspend_connection(s->mhd);
        s->is_suspended = true;
    }
    lock_give(&h->lock);
    return is_quiet;
}

// False: the store failed. The client must not take the end of its stream for the end of the runs.
static bool read_batch(http_request *r, bool owes_heartbeat, body_state *ret_state)
{
    http_stream *s = &r->stream;
    body_state state = BODY_DONE;
    bf_error err = { 0 };
    const body_source *source = &r->response.source;
    bf_status status = source->next_chunk(source->state, &r->server->services, HTTP_STREAM_BATCH,
                                          &s->batch, &state, &err);

    if (status == BF_OK && s->batch.n == 0 && state == BODY_WAIT && owes_heartbeat) {
        status = buffer_append(&s->batch, source->heartbeat, strlen(source->heartbeat));
    }
    if (status != BF_OK) {
        char quoted[LOG_QUOTED_SIZE];
        log_event(LOG_LEVEL_WARN, "stream_failed", "run=%s error=%s", s->runs[0],
                  log_quote(err.text, quoted));
        return false;
    }
    *ret_state = state;
    return true;
}

static ssize_t hand_out(http *h, http_stream *s, char *bytes, size_t n)
{
    size_t n_left = s->batch.n - s->n_taken;

    n = n < n_left ? n : n_left;
    memcpy(bytes, s->batch.bytes + s->n_taken, n);
    s->n_taken += n;
    metrics_add(METRICS_STREAM_BYTES, 0, (int64_t)n);
    lock_take(&h->lock);
    s->sent_ms = clock_monotonic_ms();
    lock_give(&h->lock);
    return (ssize_t)n;
}

ssize_t http__stream_read(void *context, uint64_t position, char *bytes, size_t n)
{
    http_request *r = context;
    http_stream *s = &r->stream;

    (void)position;
    for (;;) {
        if (s->n_taken < s->batch.n)
            return hand_out(r->server, s, bytes, n);
        s->n_taken = s->batch.n = 0;
        if (s->is_over)
            return MHD_CONTENT_READER_END_OF_STREAM;
        stream_look seen = look(r->server, s);
        if (seen.has_left)
            return MHD_CONTENT_READER_END_WITH_ERROR;
        if (seen.is_stopping)
            return MHD_CONTENT_READER_END_OF_STREAM;
        body_state state = BODY_DONE;
        if (!read_batch(r, seen.owes_heartbeat, &state))
            return MHD_CONTENT_READER_END_WITH_ERROR;
        s->is_over = state == BODY_DONE;
        if (state == BODY_WAIT && s->batch.n == 0 && suspend(r->server, s, seen.seen))
            return 0;
    }
}
