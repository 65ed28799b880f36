/// Private to the store: results that several runs share, and answers that several requests get.

#pragma once

#include "server/store/store_priv.h"

/// Digest of what the results follow from, next to the solver: model and identity.
void store__digest_work(const api_submission *submission,
                        unsigned char ret_digest[STORE__DIGEST_SIZE]);

/// Insert an empty set of results for a run that will be solved; row->results follows. digest NULL:
/// it is never shared.
BF_MUST_CHECK bf_status store__insert_results(store__connection *writer,
                                              const unsigned char *digest, store__row *row,
                                              bf_error *err);

/// Move a set of results on in its life.
BF_MUST_CHECK bf_status store__mark_results(store__connection *writer, int64_t results,
                                            store__results state, bf_error *err);

/// What was begun by another version of the solver and is not complete is never to be shared.
BF_MUST_CHECK bf_status store__disown_results(store__connection *writer, bf_error *err);

/// Find a run with complete results of this digest and of this solver.
BF_MUST_CHECK bf_status store__find_solved(store__connection *c,
                                           const unsigned char digest[STORE__DIGEST_SIZE],
                                           store__row *ret_row, bool *ret_is_solved, bf_error *err);

/// Insert *row as a run that has succeeded with the results of *solved, all its texts and events
/// included, and save it.
BF_MUST_CHECK bf_status store__share_results(store__connection *writer, const store__row *solved,
                                             const bf_buffer *scenario, const bf_buffer *summary,
                                             store__row *row, bf_error *err);

/// Append the data of a curve or snapshot event of a run that shares its results, as the run's own
/// would be.
BF_MUST_CHECK bf_status store__tell_shared(store__connection *reader, const store__row *row,
                                           api_event_type type, uint64_t item, bf_buffer *out,
                                           bf_error *err);

/// Delete one step of results, at most STORE__SWEEP_CHUNKS chunks, unless a run has them.
/// *ret_is_over: nothing is left to be deleted; else the set is marked as left over.
BF_MUST_CHECK bf_status store__sweep_results(store__connection *writer, int64_t results,
                                             bool *ret_is_over, bf_error *err);

/// Remove a run with one step of its results, unless others share them; see
/// store__sweep_results().
BF_MUST_CHECK bf_status store__remove_row(store__connection *writer, const store__row *row,
                                          bool *ret_is_over, bf_error *err);

/// A key that a request uses at the moment; on its caller's stack.
typedef struct store__key {
    const char *route;                        ///< keys of different routes are different keys
    const char *text;                         ///< the key; "": none
    unsigned char digest[STORE__DIGEST_SIZE]; ///< of the request's body
    struct store__key *next;                  ///< in the store's list
} store__key;

/// Use a key for a request with this body, or BF_ECONFLICT: it is in use. No key is always free.
/// store__free_key() ends it.
BF_MUST_CHECK bf_status store__use_key(store *s, store__key *key, const void *body, size_t n_body,
                                       bf_error *err);

/// The key is free again.
void store__free_key(store *s, store__key *key);

/// Find the first answer to a key and fill *accepted with it, unless it is older than since_ms.
/// BF_EINPUT: the key came with another body.
BF_MUST_CHECK bf_status store__find_answer(store__connection *writer, const store__key *key,
                                           int64_t since_ms, api_acceptance *accepted,
                                           bf_error *err);

/// Keep the answer to a key. Without a key there is nothing to do.
BF_MUST_CHECK bf_status store__keep_answer(store__connection *writer, const store__key *key,
                                           int64_t at_ms, const api_acceptance *accepted,
                                           bf_error *err);

/// Forget the answers from before a time.
BF_MUST_CHECK bf_status store__forget_answers(store__connection *writer, int64_t before_ms,
                                              bf_error *err);
