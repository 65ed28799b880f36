// Deadlines of connections, and the thread that watches them.
//
// MHD's own timeout is for inactivity only: a client that sends a byte now and then would hold its
// connection indefinitely. So each connection has an absolute deadline for what is due next (a
// complete header, then a complete body), and one thread shuts down the sockets of those that are
// late; MHD notices and closes. Between requests the deadline is that of the next header and the
// time for which a connection may be idle, together.
//
// MHD does not notice a client that sends something and disconnects at once: one epoll event reports both,
// MHD reads the bytes and waits for another event, which never comes. The same thread looks for such
// sockets: disconnected, nothing left to be read, and a request still incomplete, at two looks in a row.
//
// Connections that say nothing must not shut others out: when few are left, the thread closes those that have
// been idle for longest.
//
// A socket of the list is open: MHD reports a connection's end before it closes the socket, and
// the list is only looked at under http.lock.
//
// A client whose request was refused may still be sending. If its socket were closed at once, the kernel
// would answer with a reset, and the client might never read the refusal. A duplicate of such a socket
// stays open for LINGER_MS, and what is received is discarded.

#include "server/http/http_priv.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/thread.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    WATCH_TICK_MS = 100,         // between two looks while there are connections
    WATCH_TICK_LINGER_MS = 10,   // while sockets linger
    IDLE_LEAST_MS = 200,         // before a connection is closed to make room
    WATCH_DISCONNECTED_MS = 500, // between two looks for disconnected clients
    WATCH_DRAIN_READS = 8,       // reads of one lingering socket at one look
    RESERVE_MAX = 16,            // connections kept for the daemon's health
    LINGER_MS = 2000,            // for which a refused connection is drained
};

static unsigned reserve_of(const http *h)
{
    unsigned limit = h->options.connection_limit;

    return limit / 8 < RESERVE_MAX ? limit / 8 : RESERVE_MAX;
}

// True if its client has more connections with it than one may have.
static bool is_one_too_many(const http *h, const http_connection *opened)
{
    const http_connection *c;
    unsigned n = 0;

    lock_assert_held(&h->lock);
    if (h->options.per_address_limit == 0 || !opened->has_key)
        return false;
    TAILQ_FOREACH(c, &h->connections, entry)
        n += c->has_key && memcmp(c->key, opened->key, sizeof c->key) == 0;
    return n > h->options.per_address_limit;
}

http_connection *http__connection_open(http *h, int fd, const struct sockaddr *peer)
{
    http_connection *c = memory_alloc(1, sizeof *c);

    if (c == NULL)
        return NULL;
    c->server = h;
    c->fd = fd;
    c->has_key = http_client_of_connection(peer, &h->proxies, c->key);
    c->received = (http_recv){ .framing = { .body_limit = h->options.body_limit },
                               .refuse = http__request_refuse_framing,
                               .context = c };
    if (!http_recv_begin(fd, &c->received)) {
        memory_free(c);
        return NULL;
    }
    c->deadline_ms = clock_monotonic_ms() + h->options.header_deadline_ms;
    metrics_add(METRICS_CONNECTIONS, 0, 1);
    lock_acquire(&h->lock);
    c->idle_since_ms = clock_monotonic_ms();
    TAILQ_INSERT_HEAD(&h->connections, c, entry);
    if (is_one_too_many(h, c))
        (void)shutdown(fd, SHUT_RDWR);
    if (h->n_connections++ == 0)
        lock_wake_all(&h->changed);
    lock_release(&h->lock);
    return c;
}

static void start_lingering(http *h, int fd)
{
    lock_assert_held(&h->lock);
    if (h->n_lingering == HTTP_LINGER_MAX || h->is_stopping)
        return;
    int copy = fcntl(fd, F_DUPFD_CLOEXEC, 0);
    if (copy < 0)
        return;
    h->linger_fds[h->n_lingering] = copy;
    h->linger_until[h->n_lingering++] = clock_monotonic_ms() + LINGER_MS;
    lock_wake_all(&h->changed);
}

void http__connection_close(http_connection *c)
{
    if (c == NULL)
        return;
    http *h = c->server;

    http_recv_end(c->fd);
    lock_acquire(&h->lock);
    TAILQ_REMOVE(&h->connections, c, entry);
    h->n_connections--;
    if (c->lingers)
        start_lingering(h, c->fd);
    lock_release(&h->lock);
    metrics_add(METRICS_CONNECTIONS, 0, -1);
    memory_free(c);
}

void http__connection_occupy(http_connection *c, bool has_request)
{
    http *h = c->server;

    lock_acquire(&h->lock);
    c->has_request = has_request;
    if (!has_request) {
        c->idle_since_ms = clock_monotonic_ms();
        TAILQ_REMOVE(&h->connections, c, entry);
        TAILQ_INSERT_HEAD(&h->connections, c, entry);
    }
    lock_release(&h->lock);
}

void http__connection_deadline(http_connection *c, int64_t ms)
{
    lock_acquire(&c->server->lock);
    c->deadline_ms = ms < 0 ? -1 : clock_monotonic_ms() + ms;
    lock_release(&c->server->lock);
}

bool http__connection_is_reserved(const http_connection *c)
{
    http *h = c->server;

    lock_acquire(&h->lock);
    bool is_reserved = h->n_connections > h->options.connection_limit - reserve_of(h);
    lock_release(&h->lock);
    return is_reserved;
}

static bool has_event(int fd, int events)
{
    struct pollfd p = { .fd = fd, .events = (short)events };

    return poll(&p, 1, 0) > 0 && (p.revents & events) != 0;
}

bool http__connection_is_broken(int fd)
{
    return has_event(fd, POLLHUP | POLLERR);
}

bool http__connection_has_hung_up(int fd)
{
    return has_event(fd, POLLRDHUP | POLLHUP | POLLERR);
}

static bool has_unread(int fd)
{
    int n_unread = 0;

    return ioctl(fd, FIONREAD, &n_unread) != 0 || n_unread > 0;
}

// When connections are few, those that have been idle for longest go until a quarter is free. MHD accepts
// nothing while its limit is reached, so idle ones must not hold all.
static void make_room(http *h, int64_t now_ms)
{
    unsigned limit = h->options.connection_limit;
    unsigned n_left = h->n_connections;

    lock_assert_held(&h->lock);
    if (n_left + 2 * reserve_of(h) < limit)
        return;
    http_connection *c;
    TAILQ_FOREACH_REVERSE(c, &h->connections, http_connections, entry) {
        if (n_left <= limit - limit / 4)
            break;
        if (c->has_request || c->deadline_ms < 0 || now_ms < c->idle_since_ms + IDLE_LEAST_MS ||
            has_unread(c->fd))
            continue;
        c->deadline_ms = -1;
        (void)shutdown(c->fd, SHUT_RDWR);
        n_left--;
    }
}

// Throws away what came in. False: the client is done, or failed.
static bool drain(int fd)
{
    char waste[16384];

    for (int i = 0; i < WATCH_DRAIN_READS; i++) {
        ssize_t n = recv(fd, waste, sizeof waste, MSG_DONTWAIT);
        if (n == 0)
            return false;
        if (n < 0)
            return errno == EAGAIN || errno == EINTR;
    }
    return true;
}

// One look at everything; returns when the next one is due, or -1.
static int64_t look(http *h, int64_t now_ms)
{
    bool looks_for_disconnected = now_ms >= h->polled_ms + WATCH_DISCONNECTED_MS;
    http_connection *c;

    lock_assert_held(&h->lock);
    // Those that are late are cut off.
    TAILQ_FOREACH(c, &h->connections, entry) {
        if (c->deadline_ms < 0 || now_ms < c->deadline_ms)
            continue;
        c->deadline_ms = -1;
        (void)shutdown(c->fd, SHUT_RDWR);
    }
    make_room(h, now_ms);
    if (looks_for_disconnected) {
        h->polled_ms = now_ms;
        // So are those that hung up, of which nothing is left to be read, at the second look at which they have.
        TAILQ_FOREACH(c, &h->connections, entry) {
            bool is_gone =
                c->deadline_ms >= 0 && http__connection_has_hung_up(c->fd) && !has_unread(c->fd);
            if (is_gone && c->seems_disconnected)
                (void)shutdown(c->fd, SHUT_RDWR);
            c->seems_disconnected = is_gone;
        }
    }
    // Of closed ones what still comes is read, until they end or their time is over.
    unsigned n_left = 0;
    for (unsigned i = 0; i < h->n_lingering; i++) {
        if (now_ms >= h->linger_until[i] || !drain(h->linger_fds[i])) {
            (void)close(h->linger_fds[i]);
            continue;
        }
        h->linger_fds[n_left] = h->linger_fds[i];
        h->linger_until[n_left++] = h->linger_until[i];
    }
    h->n_lingering = n_left;
    int64_t due_ms = http__pull_watch(h, now_ms, looks_for_disconnected);
    if (h->n_lingering == 0 && TAILQ_EMPTY(&h->connections))
        return -1;
    int64_t next_ms = now_ms + (h->n_lingering > 0 ? WATCH_TICK_LINGER_MS : WATCH_TICK_MS);
    return due_ms < next_ms ? due_ms : next_ms;
}

static void *watch(void *context)
{
    http *h = context;

    lock_acquire(&h->lock);
    while (!h->watch_ends) {
        liveness_answer(&h->watch_liveness);
        (void)lock_wait(&h->changed, &h->lock, look(h, clock_monotonic_ms()));
    }
    lock_release(&h->lock);
    return NULL;
}

bf_status http__watch_start(http *h, bf_error *err)
{
    const bf_status status = thread_start(&h->watch, watch, h, "connections", err);

    h->has_watch = status == BF_OK;
    return status;
}

void http__watch_stop(http *h)
{
    if (!h->has_watch)
        return;
    lock_acquire(&h->lock);
    h->watch_ends = true;
    lock_wake_all(&h->changed);
    lock_release(&h->lock);
    BF_CHECK(pthread_join(h->watch, NULL) == 0);
    h->has_watch = false;
    lock_acquire(&h->lock);
    for (unsigned i = 0; i < h->n_lingering; i++)
        (void)close(h->linger_fds[i]);
    h->n_lingering = 0;
    lock_release(&h->lock);
}
