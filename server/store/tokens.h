/// Access tokens: who may use the daemon from elsewhere, and for what.
///
/// They are in a database of their own, access.db beside the store, with a rollback journal instead of a WAL: so
/// `beltflowd token` may write to it beside a running daemon, and the store keeps its one writer (I2 of store.h).
///
/// Secret  a token is `bft_` and 32 random bytes in URL-safe base64, shown once. Stored is its BLAKE2b-256: of so
///         many random bits no slow hash is needed. A token that is presented is compared with all of them in
///         constant time.
/// Once there is a token, also an expired or revoked one, requests need one: nobody opens a daemon to everybody by
/// revoking the last one.
/// Threads  all functions may be called from any thread.
/// Errors   BF_ESYSTEM the file cannot be used; BF_ENOSPACE; BF_ENOMEM.

#pragma once

#include "api/access.h"
#include "api/grants.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    TOKENS_MAX = 1000,       ///< that are stored
    TOKENS_GRANTS_MAX = 800, ///< of them grants that count, so that an operator can still add one
    TOKENS_NAME_SIZE = 65,   ///< bytes of a name with its terminator
    TOKENS_FRESH_MS = 1000,  ///< a change by others counts after so long at the latest
};

/// A stored token, without its secret.
typedef struct tokens_record {
    uint64_t id;                      ///< from 1, never used again
    char name[TOKENS_NAME_SIZE];      ///< what it is for
    char owner[API_OWNER_SIZE];       ///< whose it is
    unsigned scopes;                  ///< flags of api_scope
    int64_t created_ms;               ///< Unix time, ms
    int64_t expires_ms;               ///< from then on it does not count; 0: never
    int64_t used_ms;                  ///< last use, to a minute; 0: never
    int64_t revoked_ms;               ///< 0: it was not
    char resource[API_RESOURCE_SIZE]; ///< path of what a grant reads; "": it is none
} tokens_record;

/// The tokens as a daemon knows them; opaque.
typedef struct tokens tokens;

/// Read the tokens in the data directory; the file is created if missing.
BF_MUST_CHECK bf_status tokens_open(const char *directory, tokens **ret_tokens, bf_error *err);

/// Note the last uses and close. NULL is fine. Always returns NULL.
tokens *tokens_close(tokens *t);

/// True if there are tokens, so that requests need one.
bool tokens_exist(tokens *t);

/// What becomes of a token that a request came with (NULL: none); *ret_who, unless it is valid, stays as it was.
/// Changes by others are logged when they are found, and looked for at most once in TOKENS_FRESH_MS.
api_credential tokens_identify(tokens *t, const char *text, api_identity *ret_who);

/// The same of a token by its number.
api_credential tokens_identify_by_id(tokens *t, uint64_t id, api_identity *ret_who);

/// The token of this number. False: there is none.
bool tokens_find(tokens *t, uint64_t id, tokens_record *ret_token);

/// Copy all tokens to ret_tokens, which has room for TOKENS_MAX. Returns how many there are.
size_t tokens_copy(tokens *t, tokens_record *ret_tokens);

/// Write down when tokens were last used. Waits for the disk: not for the way of a request.
void tokens_save_uses(tokens *t);

/// True if a token was not revoked and has not expired at now_ms, Unix time.
bool tokens_counts(const tokens_record *token, int64_t now_ms);

/// Read the file at once, so that what was changed counts from now on.
void tokens_read_again(tokens *t);

/// The data directory whose tokens they are; borrowed.
const char *tokens_directory(const tokens *t);

/// Add a token to a data directory with name, owner, scopes, expires_ms and resource of *token; id and created_ms follow.
/// ret_text (API_TOKEN_SIZE bytes) is the token itself. BF_EINPUT: name or owner is none; BF_ELIMIT:
/// TOKENS_MAX are stored, and none of them has expired or was revoked; or of grants, the owner has API_GRANTS_MAX that
/// count, or TOKENS_GRANTS_MAX are stored.
BF_MUST_CHECK bf_status tokens_add(const char *directory, tokens_record *token, char *ret_text,
                                   bf_error *err);

/// A new token in the place of one that counts, with its name, owner, scopes and, from now on, length of life; the old one ends
/// after overlap_ms, unless it ends before. *ret_token and ret_text as of tokens_add(). BF_ENOTFOUND: there is none of this
/// id that counts; BF_ELIMIT.
BF_MUST_CHECK bf_status tokens_rotate(const char *directory, uint64_t id, int64_t overlap_ms,
                                      tokens_record *ret_token, char *ret_text, bf_error *err);

/// Revoke a token. BF_ENOTFOUND: there is none of this id that was not revoked.
BF_MUST_CHECK bf_status tokens_revoke(const char *directory, uint64_t id, bf_error *err);

/// Called with each token.
typedef void tokens_visit_fn(void *context, const tokens_record *token);

/// Give all tokens, by rising id, to on_token().
BF_MUST_CHECK bf_status tokens_list(const char *directory, tokens_visit_fn *on_token, void *context,
                                    bf_error *err);
