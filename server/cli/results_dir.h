/// A directory with the results of one run, as `beltflow solve --out` leaves it:
///
///     scenario.json           resolved, written first
///     curve.csv               whole lines, appended while the run goes on
///     snapshots/NNNNNN.npy    each complete from the moment it has its name
///     parts/NNNNNN.npy        same, of models with parts
///     photo_eyes.csv          written at the end, where a photo eye changed its state
///     snapshots.json          written at the end
///     summary.json            written last, and on the disk only after all the rest: where it is,
///                             the results are complete
///
/// Names are those of results_files.h. Results of an earlier run in the same directory are replaced: its summary goes first, snapshots and
/// parts beyond those of the new run last. A second writer of the same directory is refused.

#pragma once

#include "core/base/status.h"
#include "core/observe/frame.h"

#include <stddef.h>

/// A directory being written; opaque.
typedef struct results_dir results_dir;

/// Create path (and the directories above it) or reuse an existing directory. columns as from
/// scenario_columns(). BF_ESYSTEM: it cannot be written, or another program writes it.
BF_MUST_CHECK bf_status results_dir_open(const char *path, const char *columns,
                                         results_dir **ret_dir, bf_error *err);

/// Write scenario.json: the resolved document, n bytes.
BF_MUST_CHECK bf_status results_dir_scenario(results_dir *d, const char *scenario, size_t n,
                                             bf_error *err);

/// Write what a frame of type begin, curve, snapshot, parts or change has; others are ignored.
/// BF_ESYSTEM: a write failed; no partial file is left.
BF_MUST_CHECK bf_status results_dir_take(results_dir *d, const frame *f, bf_error *err);

/// Write photo_eyes.csv, snapshots.json and, unless summary is NULL (the run was stopped), summary.json.
BF_MUST_CHECK bf_status results_dir_finish(results_dir *d, const char *summary, size_t n_summary,
                                           bf_error *err);

/// Close and free. NULL is fine. Always returns NULL.
results_dir *results_dir_close(results_dir *d);
