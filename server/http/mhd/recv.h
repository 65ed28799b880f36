/// The recv() of this program. libmicrohttpd calls it like any function of the C library, and the dynamic linker finds
/// this definition first: the one way to see what a connection receives as it was sent, since MHD has no
/// callback for it. Bytes are passed on as http_framing_follow() leaves them.

#pragma once

#include "server/http/mhd/framing.h"

/// What a connection receives. It must stay while it is followed.
typedef struct http_recv {
    http_framing framing;          ///< by the thread that the connection belongs to
    bool (*refuse)(void *context); ///< the framing is refused; true: nothing more may be read
    void *context;                 ///< its argument
} http_recv;

/// From now on what the descriptor receives is followed. False: it is too high.
bool http_recv_begin(int fd, http_recv *r);

/// It is a connection's no more, and about to be closed.
void http_recv_end(int fd);
