/// Grants as JSON: a request for one, one, and the list of them.

#pragma once

#include "api/grants.h"
#include "api/json/members.h"

/// A request for a grant.
typedef struct grant_json_request {
    uint32_t expires_in_s; ///< from now on, s
} grant_json_request;

extern const member_table grant_json_request_members; ///< of a grant_json_request
extern const member_table grant_json_members;         ///< of an api_grant
extern const member_table grant_json_list_members;    ///< of an api_grant_list

/// Read n bytes of a request. BF_EINPUT: faults tell the places.
BF_MUST_CHECK bf_status grant_json_read(const char *json, size_t n, grant_json_request *ret_request,
                                        bf_faults *faults, bf_error *err);
