/// Grants of runs and studies (api/grants.h), as tokens of access.db.
///
/// A grant is named "grant", and has API_SCOPE_GRANTED and the path of what it reads. A version that does not know the scope
/// takes it for a token that allows nothing.

#pragma once

#include "api/grants.h"
#include "core/base/status.h"
#include "server/store/tokens.h"

/// add_grant, list_grants and revoke_grant of api_services.
BF_MUST_CHECK bf_status grants_add(tokens *t, uint32_t expires_in_s, api_grant *grant,
                                   bf_error *err);
BF_MUST_CHECK bf_status grants_list(tokens *t, const char *owner, api_grant_list *ret_list,
                                    bf_error *err);
BF_MUST_CHECK bf_status grants_revoke(tokens *t, const char *owner, uint64_t id, bf_error *err);
