/// What the daemon offers to the API: store, supervisor and studies behind the table of api/services.h.
///
/// Threads  everything here may be called from any thread, as the table demands.

#pragma once

#include "api/services.h"
#include "server/base/lock.h"
#include "server/daemon/run_cache.h"
#include "server/run/predictor.h"
#include "server/run/supervisor.h"
#include "server/store/store.h"
#include "server/store/tickets.h"
#include "server/store/tokens.h"
#include "server/study/studies.h"

#include <stdatomic.h>
#include <sys/queue.h>

typedef struct service_waiter service_waiter;

/// The daemon's parts. Zero-initialise, service_init() and fill in; owns nothing.
typedef struct service {
    store *store;                        ///< open
    supervisor *supervisor;              ///< running
    studies *studies;                    ///< at work
    predictor *predictor;                ///< running
    run_cache found;                     ///< runs that were found lately
    tokens *tokens;                      ///< open
    const api_leases *leases;            ///< NULL: this machine solves runs
    tickets tickets;                     ///< drawn
    atomic_bool is_draining;             ///< the daemon stops: nothing new is accepted
    lock lock;                           ///< guards waiters
    lock_condition committed;            ///< a waiter was notified
    LIST_HEAD(, service_waiter) waiters; ///< requests that wait for a commit of a run
} service;

/// Prepare the lock of *s, and free it.
void service_init(service *s);
void service_fini(service *s);

/// A commit has changed this run. May be called by a store_listener.
void service_notify(service *s, const char *run_id);

/// The table for the API; *s must outlive its use.
api_services service_table(service *s);

/// From now on accept no runs and be not ready (BF_EBUSY).
void service_drain(service *s);
