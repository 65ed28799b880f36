/// Inside the store: answers to requests with an idempotency key.
///
/// The first answer to such a request is stored in the transaction of the run or study that it describes, so that the
/// same request gets it again, whatever happened in between (I11). Its table is called `answers`.

#pragma once

#include "server/store/store_priv.h"

/// A request for something new, which may have a key.
typedef struct store__request {
    const char *route; ///< "POST /v1/runs"; keys of different routes and owners are different keys
    const api_sender *sender; ///< of the request
    const char *id;           ///< of what is new
    int64_t now_ms;           ///< when
} store__request;

/// Insert what a request asks for, and set revision and answer of *accepted; of BF_ELIMIT, retry_after_s.
typedef bf_status store__insert_fn(store__connection *writer, void *context,
                                   api_acceptance *accepted, bf_error *err);

/// Accept a request in one transaction: the first answer to its key, or else, where the disk has room, what insert does,
/// with the answer to the key. See api_services.submit, also of its errors.
BF_MUST_CHECK bf_status store__accept(store *s, const store__request *request,
                                      store__insert_fn *insert, void *context,
                                      api_acceptance *ret_acceptance, bf_error *err);

/// Delete the answers from before a time.
BF_MUST_CHECK bf_status store__expire_keys(store__connection *writer, int64_t before_ms,
                                           bf_error *err);
