/// Where the results of a run lie: below the directory of `beltflow solve --out` and in results.zip.

#pragma once

#include <stdint.h>

enum { RESULTS_FILES_NAME_SIZE = 40 }; ///< bytes of a name with its terminator

/// X(file, folder, stem, ending): stem "" is the number of a snapshot, at least six digits.
#define RESULTS_FILES_LIST(X)                                                                      \
    X(RESULTS_FILES_SCENARIO, "", "scenario", "json")                                              \
    X(RESULTS_FILES_CURVE, "", "curve", "csv")                                                     \
    X(RESULTS_FILES_PHOTO_EYES, "", "photo_eyes", "csv")                                           \
    X(RESULTS_FILES_SNAPSHOTS, "", "snapshots", "json")                                            \
    X(RESULTS_FILES_SNAPSHOTS_SERIES, "", "snapshots", "pvd")                                      \
    X(RESULTS_FILES_PARTS_SERIES, "", "parts", "pvd")                                              \
    X(RESULTS_FILES_SNAPSHOT, "snapshots/", "", "npy")                                             \
    X(RESULTS_FILES_SNAPSHOT_VTK, "snapshots/", "", "vti")                                         \
    X(RESULTS_FILES_PARTS, "parts/", "", "npy")                                                    \
    X(RESULTS_FILES_PARTS_VTK, "parts/", "", "vtp")                                                \
    X(RESULTS_FILES_SUMMARY, "", "summary", "json")

/// The files.
typedef enum results_files {
#define X(file, folder, stem, ending) file,
    RESULTS_FILES_LIST(X)
#undef X
        RESULTS_FILES_COUNT
} results_files;

/// Write the name of a file, "snapshots/000012.npy", into ret_name (RESULTS_FILES_NAME_SIZE bytes).
/// index counts where there is one for each snapshot. Returns the part of it after the last '/'.
const char *results_files_name(results_files file, uint64_t index, char *ret_name);
