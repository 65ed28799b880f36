/// Inside the store: databases that versions without page checksums made are written anew, with them.

#pragma once

#include "core/base/status.h"
#include "server/store/store_priv.h"

struct sqlite3;

/// Write what a database has into a new file whose pages have sums, and which can give free pages back. `file` is
/// missing or empty; it is not synced. The connection may be a reader's.
BF_MUST_CHECK bf_status store__copy_with_sums(struct sqlite3 *db, const char *file, bf_error *err);

/// Put a database with sums in the place of the store's, which nobody has open, if that has none and is not larger than
/// some hundred MB: before the store is opened, so that only a start waits. What keeps it from that is logged, and the
/// store stays as it was; a process that is killed meanwhile leaves the one or the other. BF_ESYSTEM: the disk fails when
/// the new one is to be synced and put in its place.
BF_MUST_CHECK bf_status store__convert(const store *s, bf_error *err);
