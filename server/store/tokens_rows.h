/// Inside the store: the rows of access.db (tokens.h).

#pragma once

#include "server/store/columns.h"
#include "server/store/tokens.h"

enum {
    STORE__TOKEN_HASH_BYTES = 32,   ///< of a token's text
    STORE__TOKENS_PATH_SIZE = 1100, ///< of a data directory with its terminator
};

/// A token as it is in memory.
typedef struct store__token {
    tokens_record about;                         ///< what is told of it
    unsigned char hash[STORE__TOKEN_HASH_BYTES]; ///< of its text
    bool is_unsaved;                             ///< about.used_ms is not in the file yet
} store__token;

/// Open access.db of a data directory, with its table; store__disconnect() closes it. With is_new it is created if
/// missing; else that is BF_EINPUT.
BF_MUST_CHECK bf_status store__open_tokens(const char *directory, bool is_new, store__connection *c,
                                           bf_error *err);

/// Read all tokens, by rising id, into TOKENS_MAX places.
BF_MUST_CHECK bf_status store__read_tokens(store__connection *c, store__token *ret_tokens,
                                           size_t *ret_n, bf_error *err);

/// The hash that stands for a token's text.
void store__hash_token(const char *text, unsigned char ret_hash[STORE__TOKEN_HASH_BYTES]);
