/// What the daemon offers to the API: store and supervisor behind the table of api/services.h.
///
/// Threads  everything here may be called from any thread, as the table demands.

#pragma once

#include "api/services.h"
#include "server/run/supervisor.h"
#include "server/store/store.h"

#include <stdatomic.h>
#include <stdbool.h>

/// The daemon's parts. Zero-initialise and fill in; owns nothing.
typedef struct service {
    store *store;            ///< open
    supervisor *supervisor;  ///< running
    atomic_bool is_draining; ///< the daemon stops: nothing new is accepted
} service;

/// The table for the API; *s must outlive its use.
api_services service_table(service *s);

/// From now on accept no runs and be not ready (BF_EBUSY).
void service_drain(service *s);
