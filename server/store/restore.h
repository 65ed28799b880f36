/// A store from a copy that store_backup() made, in the place of the one in a data directory.

#pragma once

#include "core/base/status.h"

#include <stdbool.h>

/// What was restored.
typedef struct store_restored {
    bool has_tokens;     ///< FILE.access was there, and is access.db now
    char replaced[1088]; ///< the directory where what was there before is; "": nothing was
} store_restored;

/// Put FILE, and FILE.access if it is there, in the place of the store in a data directory, which is created if missing. Both are checked
/// first: SQLite's own checks, and, of a copy of this version, the invariants of store.h. What was there before, also its
/// log, is moved into a new directory in it. Files get the owner of the data directory, and are his alone. BF_EINPUT: FILE is
/// no store, is damaged, was written by a newer Beltflow, or is in use; BF_ECONFLICT: a daemon has the data directory;
/// BF_ESYSTEM: it cannot be read or written; what was there before is then in its place, or in the new directory.
BF_MUST_CHECK bf_status store_restore(const char *directory, const char *file,
                                      store_restored *ret_restored, bf_error *err);
