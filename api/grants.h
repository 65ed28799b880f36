/// Grants: access tokens of the scope API_SCOPE_GRANTED, each of which reads one run or study, for a link to it.

#pragma once

#include "api/access.h"

#include <stddef.h>
#include <stdint.h>

enum {
    API_GRANTS_MAX = 50,            ///< of an owner that count at once
    API_GRANT_MIN_S = 60,           ///< a grant counts for at least so long, s,
    API_GRANT_MAX_S = 366 * 86400,  ///< at most so long,
    API_GRANT_USUAL_S = 30 * 86400, ///< and so long where nothing is said
};

/// A grant.
typedef struct api_grant {
    uint64_t id;                      ///< number of its token
    char resource[API_RESOURCE_SIZE]; ///< what it reads: "/v1/runs/ID" or "/v1/studies/ID"
    char owner[API_OWNER_SIZE];       ///< who made it
    int64_t created_ms;               ///< Unix time, ms
    int64_t expires_ms;               ///< from then on it does not count
    char token[API_TOKEN_SIZE];       ///< the token itself, of one that was just made; else ""
} api_grant;

/// Grants, by rising id. Zero-initialise; free with api_grant_list_fini().
typedef struct api_grant_list {
    size_t n;          ///< grants
    api_grant *grants; ///< owned
} api_grant_list;

/// Free what the list owns and zero it. NULL is fine.
void api_grant_list_fini(api_grant_list *list);
