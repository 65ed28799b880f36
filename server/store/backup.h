/// A copy of a store, also of one that a daemon is using: SQLite's online backup from a connection that
/// only reads, so that I2 of store.h holds. The copy is of one moment.

#pragma once

#include "core/base/status.h"

/// Copy the store in a data directory to a new file, which gets its name when it is whole and on disk.
/// It is a store again as beltflow.db of another data directory. BF_EINPUT: there is no store, or the
/// file is there already; BF_ESYSTEM: it cannot be read or written. Nothing is left of a failure.
BF_MUST_CHECK bf_status store_backup(const char *directory, const char *file, bf_error *err);
