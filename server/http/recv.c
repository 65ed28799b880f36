// The recv() of this program. libmicrohttpd calls it like any function of the C library, and the dynamic linker finds
// this definition first: the one way to see what a connection receives as it was sent, since MHD has no
// callback for it. Bytes are passed on as http_framing_follow() leaves them.

#include "server/http/http_priv.h"

#include <errno.h>
#include <stdatomic.h>
#include <sys/socket.h>

enum { FDS_MAX = 1 << 20 }; // the kernel's default limit (fs.nr_open)

// The connection of a descriptor; NULL: not one of the server's. Set and read by the thread that the connection
// belongs to.
static _Atomic(http_connection *) connections[FDS_MAX];

bool http__recv_begin(http_connection *c)
{
    if (c->fd >= FDS_MAX)
        return false;
    atomic_store(&connections[c->fd], c);
    return true;
}

void http__recv_end(const http_connection *c)
{
    if (c->fd < FDS_MAX)
        atomic_store(&connections[c->fd], NULL);
}

static http_connection *connection_of(int fd)
{
    return fd >= 0 && fd < FDS_MAX ? atomic_load(&connections[fd]) : NULL;
}

// As many bytes as there are and have room. MHD takes fewer than it has room for as a sign that it has to wait for
// more, so bytes that are taken out make room for others.
static ssize_t receive(http_connection *c, char *bytes, size_t n, int flags)
{
    http_framing *f = &c->framing;
    size_t n_kept = 0;

    while (n - n_kept > f->n_held) {
        const size_t room = n - n_kept - f->n_held;
        ssize_t n_new = recvfrom(c->fd, bytes + n_kept + f->n_held, room, flags, NULL, NULL);
        if (n_new <= 0)
            return n_kept > 0 ? (ssize_t)n_kept : n_new;
        n_kept += http_framing_follow(f, bytes + n_kept, (size_t)n_new);
        if (f->refusal != 0 && http__request_refuse_framing(c)) {
            errno = ECONNRESET;
            return -1;
        }
        if ((size_t)n_new < room) {
            errno = EAGAIN;
            return n_kept > 0 ? (ssize_t)n_kept : -1;
        }
    }
    return (ssize_t)(n_kept + http_framing_release(f, bytes + n_kept, n - n_kept));
}

__attribute__((visibility("default"))) ssize_t recv(int fd, void *bytes, size_t n, int flags)
{
    http_connection *c = connection_of(fd);

    if (c == NULL || (flags & MSG_PEEK) != 0)
        return recvfrom(fd, bytes, n, flags, NULL, NULL);
    return receive(c, bytes, n, flags);
}
