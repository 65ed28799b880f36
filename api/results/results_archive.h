/// All results of a run that has ended as one ZIP archive, made while it is sent.
///
/// It holds what `beltflow solve --out` leaves, under the same names (results_files.h), and with VTK
/// files also an image of each snapshot, the parts of each, and a ParaView collection of either. A
/// summary is there if the run has one, and it is the last file. At most one file is in memory; of
/// snapshots, and of parts as NumPy files, a piece.

#pragma once

#include "api/body.h"
#include "api/services.h"

/// What is in an archive.
typedef enum results_archive_kind {
    RESULTS_ARCHIVE_PLAIN, ///< what `beltflow solve` leaves
    RESULTS_ARCHIVE_VTK,   ///< VTK's files, too
} results_archive_kind;

/// Begin the archive of *of, which must have ended: its files carry the time of that. *ret_source is
/// the caller's; its destroy() frees it.
BF_MUST_CHECK bf_status results_archive_open(const api_run *of, results_archive_kind kind,
                                             const api_services *services, body_source *ret_source,
                                             bf_error *err);
