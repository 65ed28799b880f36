/// A worker: leases jobs of a daemon over HTTP (api/leases.h), solves them with child processes of this machine
/// (server/run/local_executor.h), and delivers the bytes of their frames.
///
/// A connection that is lost is tried again for ever while there is work; solving goes on meanwhile. The whole of what a
/// job sent is kept in a file without a name until the daemon has taken its end, so that a daemon that was started again
/// can have it once more.
///
/// SIGTERM or SIGINT: nothing more is leased, children write a checkpoint and end, what is left is delivered, the lease is
/// left; a second one, or PULL_WORKER_DRAIN_S: at once. Threads: one, which blocks these signals.

#pragma once

#include "api/leases.h"
#include "core/base/status.h"

enum { PULL_WORKER_DRAIN_S = 100 }; ///< from the signal to the end

/// What a worker is. Texts are borrowed for the call.
typedef struct pull_worker_options {
    api_worker who;      ///< as it describes itself
    const char *url;     ///< of the daemon
    const char *token;   ///< access token with the scope `work`; "": none
    const char *ca_file; ///< CA certificates; NULL: those of the system
    const char *program; ///< that solves
    const char *spool;   ///< folder of the files
    /// Of all files at once; before that the longest run is saved and given back
    uint64_t spool_bytes;
    uint64_t lifetime_s; ///< ends by itself as by SIGTERM; 0: never
    uint64_t idle_s;     ///< ends by itself after so long without a job; 0: never
} pull_worker_options;

/// Work until a signal, the lifetime or the idle time. BF_EINPUT: the URL; BF_ECONFLICT: the daemon's solver is another
/// version, or it has no jobs for workers; BF_ENOTFOUND: there is no such service; BF_ESYSTEM: the token is refused, or
/// this machine's fault; BF_ENOMEM.
BF_MUST_CHECK bf_status pull_worker_run(const pull_worker_options *options, bf_error *err);
