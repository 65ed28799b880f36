/// Copies of a store, and checks of one; both also while a daemon is using it, from connections that only
/// read, so that I2 of store.h holds. What they read is of one moment.

#pragma once

#include "core/base/status.h"

#include <stdbool.h>

/// Copy the store in a data directory to a new file, and its access tokens, if it has any, to FILE.access; each gets its name
/// when it is whole and on disk. They are a store again as beltflow.db and access.db of another data directory. BF_EINPUT:
/// there is no store, or one of the files is there already; BF_ESYSTEM: it cannot be read or written. Nothing is left of
/// a failure.
BF_MUST_CHECK bf_status store_backup(const char *directory, const char *file, bf_error *err);

/// Called with the outcome of each check: name is "I4" or a word, claim what should hold, finding what was
/// found instead, or NULL.
typedef void store_verify_fn(void *context, const char *name, const char *claim,
                             const char *finding);

/// Check the store in the file at path by SQLite's own checks, the invariants of store.h that a file can
/// show, and by unpacking every stored snapshot. *ret_is_sound: nothing was found. BF_EINPUT: there is no such
/// file; BF_ESYSTEM: it cannot be read, is no store, or of another version (a daemon's start brings an
/// older one up to date).
BF_MUST_CHECK bf_status store_verify(const char *path, store_verify_fn *on_finding, void *context,
                                     bool *ret_is_sound, bf_error *err);
