#include "server/daemon/grants.h"

#include "core/base/memory.h"
#include "server/base/clock.h"

#include <inttypes.h>
#include <stdbool.h>
#include <string.h>

bf_status grants_add(tokens *t, uint32_t expires_in_s, api_grant *grant, bf_error *err)
{
    tokens_record token = { .name = "grant",
                            .scopes = API_SCOPE_GRANTED,
                            .expires_ms = clock_unix_ms() + 1000 * (int64_t)expires_in_s };

    if (!tokens_exist(t))
        return bf_fail(err, BF_ECONFLICT, "",
                       "this service has no access tokens: whoever reaches it can read %s",
                       grant->resource);
    memcpy(token.owner, grant->owner, sizeof token.owner);
    memcpy(token.resource, grant->resource, sizeof token.resource);
    BF_TRY(tokens_add(tokens_directory(t), &token, grant->token, err));
    tokens_read_again(t);
    grant->id = token.id;
    grant->created_ms = token.created_ms;
    grant->expires_ms = token.expires_ms;
    return BF_OK;
}

// Whether it is a grant that counts, of this owner ("": of anybody).
static bool is_grant_of(const tokens_record *token, const char *owner)
{
    return token->resource[0] != '\0' && tokens_counts(token, clock_unix_ms()) &&
           (owner[0] == '\0' || strcmp(token->owner, owner) == 0);
}

bf_status grants_list(tokens *t, const char *owner, api_grant_list *ret_list, bf_error *err)
{
    tokens_record *all = memory_alloc(TOKENS_MAX, sizeof *all);
    api_grant *grants = memory_alloc(TOKENS_MAX, sizeof *grants);
    size_t n = 0;

    if (all == NULL || grants == NULL) {
        memory_free(all);
        memory_free(grants);
        return bf_fail_memory(err);
    }
    const size_t n_all = tokens_copy(t, all);
    for (size_t i = 0; i < n_all; i++) {
        const tokens_record *token = &all[i];
        if (!is_grant_of(token, owner))
            continue;
        api_grant *grant = &grants[n++];
        *grant = (api_grant){ .id = token->id,
                              .created_ms = token->created_ms,
                              .expires_ms = token->expires_ms };
        memcpy(grant->owner, token->owner, sizeof grant->owner);
        memcpy(grant->resource, token->resource, sizeof grant->resource);
    }
    memory_free(all);
    *ret_list = (api_grant_list){ .n = n, .grants = grants };
    return BF_OK;
}

bf_status grants_revoke(tokens *t, const char *owner, uint64_t id, bf_error *err)
{
    tokens_record token;

    if (!tokens_find(t, id, &token) || !is_grant_of(&token, owner))
        return bf_fail(err, BF_ENOTFOUND, "", "there is no grant %" PRIu64 " that counts", id);
    BF_TRY(tokens_revoke(tokens_directory(t), id, err));
    tokens_read_again(t);
    return BF_OK;
}
