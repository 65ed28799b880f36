/// Private to the HTTP transport: signs of life of its threads (http_probe.c).

#pragma once

#include "server/base/liveness.h"
#include "server/http/http.h"

enum { HTTP_PROBES_MAX = 64 }; ///< epoll threads that are asked whether they live

/// What is asked of whom.
typedef struct http_alive {
    int probes[HTTP_PROBES_MAX]; ///< main's: our ends of connections to epoll threads; 0: none
    pulse pulse;                 ///< of the thread that watches
} http_alive;

/// Close what the last probes have left open.
void http__probe_end(http *h);
