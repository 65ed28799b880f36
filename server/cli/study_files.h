/// The directory of a study on the command line:
///
///     study.json    the document, as it was given
///     trials.csv    a line for each trial; while the study goes on in the order in which they end, then by number
///     best.json     what it found
///
/// A study goes on from these files. A line that was torn by the end of the program is dropped, and its trial made again.

#pragma once

#include "api/study/study_trial.h"

/// The directory of a study; opaque, on the heap.
typedef struct study_files study_files;

/// Open a directory, which is made if it is missing, for a document of n bytes. The caller owns *ret_files:
/// study_files_close(). BF_EINPUT: it is that of another study; BF_EBUSY: another process has it open. BF_ESYSTEM,
/// BF_ENOMEM.
BF_MUST_CHECK bf_status study_files_open(const char *path, const char *json, size_t n,
                                         study_files **ret_files, bf_error *err);

/// Values of a trial with these columns that ended in an earlier session. False: it did not.
bool study_files_find(const study_files *f, const study_columns *columns, size_t trial,
                      double *ret_values);

/// Add a trial that has ended; line is that of study_trial_csv_line(). It is in the file when this returns.
/// BF_ESYSTEM, BF_ENOMEM.
BF_MUST_CHECK bf_status study_files_add(study_files *f, size_t trial, const bf_buffer *line,
                                        bf_error *err);

/// Write trials.csv by number, after its header, and best.json. BF_ESYSTEM, BF_ENOMEM.
BF_MUST_CHECK bf_status study_files_finish(study_files *f, const bf_buffer *header,
                                           const bf_buffer *best, bf_error *err);

/// Read the lines of an earlier session, those of the header's study, and begin the file anew with them. BF_EINPUT: it has
/// another header. BF_ESYSTEM, BF_ENOMEM.
BF_MUST_CHECK bf_status study_files_resume(study_files *f, const study_columns *columns,
                                           const bf_buffer *header, bf_error *err);

/// Free a directory. NULL is fine.
void study_files_close(study_files *f);
