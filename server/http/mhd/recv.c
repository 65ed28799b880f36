#include "server/http/mhd/recv.h"

#include <errno.h>
#include <stdatomic.h>
#include <sys/socket.h>

enum { FDS_MAX = 1 << 20 }; // the kernel's default limit (fs.nr_open)

// What is followed, by descriptors; NULL: not one of the server's. Set and read by the thread that the connection
// belongs to.
static _Atomic(http_recv *) followed[FDS_MAX];

bool http_recv_begin(int fd, http_recv *r)
{
    if (fd >= FDS_MAX)
        return false;
    atomic_store(&followed[fd], r);
    return true;
}

void http_recv_end(int fd)
{
    if (fd < FDS_MAX)
        atomic_store(&followed[fd], NULL);
}

// As many bytes as there are and have room. MHD takes fewer than it has room for as a sign that it has to wait for
// more, so bytes that are taken out make room for others.
static ssize_t receive(int fd, http_recv *r, char *bytes, size_t n, int flags)
{
    http_framing *f = &r->framing;
    size_t n_kept = 0;

    while (n - n_kept > f->n_held) {
        const size_t room = n - n_kept - f->n_held;
        ssize_t n_new = recvfrom(fd, bytes + n_kept + f->n_held, room, flags, NULL, NULL);
        if (n_new <= 0)
            return n_kept > 0 ? (ssize_t)n_kept : n_new;
        n_kept += http_framing_follow(f, bytes + n_kept, (size_t)n_new);
        if (f->refusal != 0 && r->refuse(r->context)) {
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
    http_recv *r = fd >= 0 && fd < FDS_MAX ? atomic_load(&followed[fd]) : NULL;

    if (r == NULL || (flags & MSG_PEEK) != 0)
        return recvfrom(fd, bytes, n, flags, NULL, NULL);
    return receive(fd, r, bytes, n, flags);
}
