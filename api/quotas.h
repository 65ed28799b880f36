/// What an owner of access tokens uses of the service, and may use.

#pragma once

#include "api/access.h"

#include <stdint.h>

enum { API_QUOTA_WINDOW_S = 86400 }; ///< in which CPU time counts

/// What is used of a quota.
typedef struct api_quota {
    uint64_t used;    ///< at the moment
    uint64_t allowed; ///< 0: there is no quota
    /// CPU time that is used up: when less is used again, Unix time, ms; else 0
    int64_t release_ms;
} api_quota;

/// What an owner uses and may use.
typedef struct api_quotas {
    char owner[API_OWNER_SIZE]; ///< "": everybody without a token
    api_quota waiting;          ///< runs that wait
    api_quota cpu_s;            ///< CPU seconds of solvers within API_QUOTA_WINDOW_S
    api_quota bytes;            ///< of stored results
} api_quotas;
