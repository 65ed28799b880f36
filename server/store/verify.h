/// Whether a store is sound: SQLite's own checks, the invariants of store.h that a file can show, and
/// every stored snapshot unpacked. The store is only read, also while a daemon uses it.

#pragma once

#include "core/base/status.h"

#include <stdbool.h>

/// Take the outcome of one check: name is "I4" or a word, claim what should hold, finding what was
/// found instead, or NULL.
typedef void store_verify_take(void *context, const char *name, const char *claim,
                               const char *finding);

/// Check the store in the file at path. *ret_is_sound: nothing was found. BF_EINPUT: there is no such
/// file; BF_ESYSTEM: it cannot be read, is no store, or of another version (a daemon's start brings an
/// older one up to date).
BF_MUST_CHECK bf_status store_verify(const char *path, store_verify_take *take, void *context,
                                     bool *ret_is_sound, bf_error *err);
