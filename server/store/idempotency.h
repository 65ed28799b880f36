/// Inside the store: answers to requests with an idempotency key.
///
/// The first answer to such a request is stored in the transaction of the run or study that it describes, so that the
/// same request gets it again, whatever happened in between (I11). Its table is called `answers`.

#pragma once

#include "server/store/store_priv.h"

enum { STORE__ROUTE_SIZE = 32 }; ///< bytes of a route with its terminator

/// A key that a request uses at the moment; on its caller's stack.
struct store__key {
    char
        route[STORE__ROUTE_SIZE + API_OWNER_SIZE]; ///< and after a space the owner, if there is one
    const char *text;                              ///< the key; "": none
    unsigned char digest[STORE__DIGEST_SIZE];      ///< of the request's body
    store__key *next;                              ///< in the store's list
};

/// Begin to use a key, until store__free_key(). Keys of different routes and owners are different keys; those of nobody
/// are the route's alone. BF_ECONFLICT: another request uses it at the moment.
BF_MUST_CHECK bf_status store__use_key(store *s, store__key *key, const char *route,
                                       const char *owner, const char *text, const void *body,
                                       size_t n_body, bf_error *err);

/// Have done with a key.
void store__free_key(store *s, store__key *key);

/// Look for the first answer to a key; accepted->is_replay: there is one. BF_EINPUT: it was to another body.
BF_MUST_CHECK bf_status store__find_answer(store__connection *writer, const store *s,
                                           const store__key *key, int64_t now_ms,
                                           api_acceptance *accepted, bf_error *err);

/// Store the answer to a key.
BF_MUST_CHECK bf_status store__insert_answer(store__connection *writer, const store__key *key,
                                             int64_t at_ms, const api_acceptance *accepted,
                                             bf_error *err);

/// Delete the answers from before a time.
BF_MUST_CHECK bf_status store__expire_keys(store__connection *writer, int64_t before_ms,
                                           bf_error *err);
