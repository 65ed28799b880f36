// The recv() of this program. libmicrohttpd calls it like any function of the C library, and the dynamic linker finds
// this definition first: the one way to see what a connection receives as it was sent, since MHD has no
// callback for it. Bytes are passed on unchanged, after http_framing_follow() looked at them.

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

__attribute__((visibility("default"))) ssize_t recv(int fd, void *bytes, size_t n, int flags)
{
    ssize_t n_received = recvfrom(fd, bytes, n, flags, NULL, NULL);
    http_connection *c = n_received > 0 ? connection_of(fd) : NULL;

    if (c == NULL || (flags & MSG_PEEK) != 0)
        return n_received;
    http_framing_follow(&c->framing, bytes, (size_t)n_received);
    if (c->framing.refusal == 0 || !http__request_refuse_framing(c))
        return n_received;
    errno = ECONNRESET;
    return -1;
}
