/// Inside the store: the write-ahead log's file, whose writes are gathered. SQLite writes every page of a commit by two calls,
/// its frame's header and its bytes, all of them one behind the other; here they reach the system as one write, before
/// the log is synced, read, measured or cut. A commit of 16 pages costs 2 system calls instead of 33.
///
/// Only for connections with synchronous = FULL, as all are that write to the store: SQLite syncs the log before others
/// learn of new frames in it. With less they would read what is not written yet.

#pragma once

#include <stddef.h>

struct sqlite3_file;
struct sqlite3_vfs;

/// Bytes in front of the system's part of such a file.
extern const size_t store__log_file_bytes;

/// Open a log by the system's VFS below; as xOpen of a VFS whose files have room for both parts.
int store__open_log(struct sqlite3_vfs *below, const char *name, struct sqlite3_file *file,
                    int flags, int *ret_flags);
