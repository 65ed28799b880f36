/// What an end (finish.c) has of appending (append.c) and of claiming (claim.c), so that all three can be one commit.

#pragma once

#include "server/store/store_priv.h"

/// A batch of what a running run sent; opaque.
typedef struct store__appending store__appending;

/// Make one of a batch, which must stay as it is until store__appending_destroy(). NULL: no memory.
store__appending *store__appending_create(const store_batch *batch);

/// Compress its arrays, before it is applied; on any thread.
BF_MUST_CHECK bf_status store__pack_batch(const store__appending *a, bf_error *err);

/// Store it for a running run. What it changes of *row is for the caller to save. BF_ECORRUPT: see store_begin_append().
BF_MUST_CHECK bf_status store__apply_batch(store__connection *writer, store__appending *a,
                                           store__row *row, bf_error *err);

/// Free it; BF_OK: it is stored, and counted in the metrics.
void store__appending_destroy(store__appending *a, bf_status status);

/// What store__apply_next() works on: the store, whose limits count, and the run that it claims.
typedef struct store__claiming {
    const store *store; ///< given
    bool with_trials;   ///< given: a trial will do, too
    store_job job;      ///< the caller's, also after a failure
} store__claiming;

/// An operation on a store__claiming: claim the next run that waits, as store_claim() does. BF_ECONFLICT: it has a
/// checkpoint, which takes too long to be read here.
BF_MUST_CHECK bf_status store__apply_next(store__connection *writer, store__operation *operation,
                                          bf_error *err);
