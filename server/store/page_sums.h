/// Inside the store: checksums of the database's pages, as a VFS of SQLite over the system's own.
///
/// Every page of a database that is made here ends with STORE__SUM_BYTES of SQLite's reserved space: SipHash-2-4
/// of the bytes before them (Aumasson, Bernstein 2012), with the place of the page in the key, so that a page in
/// the wrong place does not pass either. They are set where a page is written to the file and compared where one
/// is read from it; what does not fit is SQLITE_IOERR_DATA. So nothing is served of a page whose bytes have
/// changed on the disk. SQLite's checksum VFS works the same way (sqlite.org/cksumvfs.html).
///
/// Not covered: pages in the write-ahead log, which has SQLite's own sums, compared when it is recovered; and
/// databases without reserved bytes, as earlier versions made them: they are read and written as they are until a start
/// has converted them (server/store/convert.h).

#pragma once

#include "core/base/status.h"

#include <stdbool.h>

enum { STORE__SUM_BYTES = 8 }; ///< at the end of each page

/// Name of the VFS, for sqlite3_open_v2().
#define STORE__PAGE_SUMS "beltflow-sums"

struct sqlite3;

/// Make the VFS known to SQLite; again and from any thread is fine. BF_ESYSTEM: SQLite has none of its own.
BF_MUST_CHECK bf_status store__register_page_sums(bf_error *err);

/// True if the pages of a database that has been read from have sums.
bool store__has_page_sums(struct sqlite3 *db);

/// Have a database that is still empty get room for the sums.
BF_MUST_CHECK bf_status store__reserve_page_sums(struct sqlite3 *db, bf_error *err);
