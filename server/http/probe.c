// Liveness of the server's threads. Each round probes every thread and checks whether the probe of the previous
// round was answered.
//
// An epoll thread can only be probed by a request, so each gets a connection of its own: one end of a
// pair of sockets, handed to MHD past the listening socket. While clients hold all connections the thread
// is not probed, since the probe would be refused regardless of the thread's state.
//
// MHD gives a connection to the thread whose number is the descriptor's, modulo their number.

#include "server/http/http_priv.h"
#include "server/http/pool.h"

#include "server/base/clock.h"

#include <fcntl.h>
#include <microhttpd.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { PROBE_TRIES = 64, PROBE_END_MS = 2000 };

static const char question[] =
    "GET /livez HTTP/1.1\r\nHost: localhost\r\nUser-Agent: watchdog\r\nConnection: close\r\n\r\n";
static const char answer[] = "HTTP/1.1 200 ";

// True unless the thread was probed and has not answered; closes our end.
static bool collect(int *fd)
{
    char text[sizeof answer - 1];

    if (*fd <= 0)
        return true;
    bool is_good = recv(*fd, text, sizeof text, MSG_DONTWAIT) == sizeof text &&
                   memcmp(text, answer, sizeof text) == 0;
    (void)close(*fd);
    *fd = 0;
    return is_good;
}

// Gives the descriptor a number that MHD takes for this thread, if one is near.
static int renumber(int fd, unsigned thread, unsigned n_threads)
{
    int found = fd;

    for (int i = 0; i < PROBE_TRIES && found >= 0 && (unsigned)found % n_threads != thread; i++) {
        int next = fcntl(fd, F_DUPFD_CLOEXEC, found + 1);
        if (found != fd)
            (void)close(found);
        found = next;
    }
    if (found < 0)
        return fd;
    if (found != fd)
        (void)close(fd);
    return found;
}

// Our end of the connection of a probe; 0: the thread could not be probed.
static int ask(http *h, unsigned thread)
{
    const struct sockaddr_un unnamed = { .sun_family = AF_UNIX };
    int ends[2];

    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0)
        return 0;
    int theirs = renumber(ends[1], thread, h->options.n_threads);
    if (send(ends[0], question, sizeof question - 1, MSG_DONTWAIT | MSG_NOSIGNAL) ==
            sizeof question - 1 &&
        MHD_add_connection(h->daemon, theirs, (const struct sockaddr *)&unnamed, sizeof unnamed) ==
            MHD_YES)
        return ends[0];
    (void)close(ends[0]);
    return 0;
}

static bool is_full(http *h)
{
    lock_acquire(&h->lock);
    bool is = h->n_connections + h->options.n_threads > h->options.connection_limit;
    lock_release(&h->lock);
    return is;
}

static bool is_watch_alive(http *h)
{
    bool is_alive = !liveness_is_asked(&h->watch_liveness);

    lock_acquire(&h->lock);
    liveness_ask(&h->watch_liveness);
    lock_wake_all(&h->changed);
    lock_release(&h->lock);
    return is_alive;
}

bool http_is_alive(http *h)
{
    unsigned n = h->options.n_threads;
    bool is_alive = true;

    for (unsigned i = 0; i < n && i < HTTP_PROBES_MAX; i++)
        is_alive = collect(&h->probes[i]) && is_alive;
    is_alive = http__pool_is_alive(h->pool) && is_alive;
    is_alive = is_watch_alive(h) && is_alive;
    for (unsigned i = 0; i < n && i < HTTP_PROBES_MAX && !is_full(h); i++)
        h->probes[i] = ask(h, i);
    return is_alive;
}

void http__probe_end(http *h)
{
    int64_t deadline_ms = clock_monotonic_ms() + PROBE_END_MS;

    for (unsigned i = 0; i < HTTP_PROBES_MAX; i++) {
        int64_t left_ms = deadline_ms - clock_monotonic_ms();
        struct pollfd answered = { .fd = h->probes[i], .events = POLLIN };
        if (h->probes[i] > 0 && left_ms > 0)
            (void)poll(&answered, 1, (int)left_ms);
        (void)collect(&h->probes[i]);
    }
}
