/// Trials of a study as JSON and as lines of CSV.

#pragma once

#include "api/json/members.h"
#include "api/studies.h"
#include "api/study/study_document.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>

/// Names of the parameters and values of a study's trials, which all of them have in common.
typedef struct study_columns {
    size_t n_parameters;                                ///< at least 1
    char parameters[STUDY_PARAMETERS][BF_POINTER_SIZE]; ///< their pointers
    size_t n_values;                                    ///< at least 1
    char values[STUDY_VALUES][STUDY_DOCUMENT_COLUMN];   ///< see study_document_column()
} study_columns;

/// A trial with the names of what it has.
typedef struct study_trial_item {
    const study_columns *columns; ///< of its study; borrowed
    api_trial trial;              ///< what it is
} study_trial_item;

/// A trial as JSON; the struct is study_trial_item.
extern const member_table study_trial_members;

/// The columns of a document's trials.
void study_columns_of(const study_document *document, study_columns *ret_columns);

/// Append the columns as {"parameters": [...], "values": [...]}; and read that. BF_ENOMEM; BF_ECORRUPT: it is not such an
/// object.
BF_MUST_CHECK bf_status study_columns_write(const study_columns *columns, bf_buffer *out,
                                            bf_error *err);
BF_MUST_CHECK bf_status study_columns_read(const char *json, size_t n, study_columns *ret_columns,
                                           bf_error *err);

/// A trial before it begins: its number, point, model, substream and parameters; queued, without values.
void study_trial_of(const study_document *document, const study *s, size_t number,
                    api_trial *ret_trial);

/// Append the header of the CSV: "trial,point,model,substream,<pointers>,state,<values>,fault". BF_ENOMEM.
BF_MUST_CHECK bf_status study_trial_csv_header(const study_columns *columns, bf_buffer *out,
                                               bf_error *err);

/// Append the line of a trial; values that are NAN are empty, and so is the fault of one that succeeded. BF_ENOMEM.
BF_MUST_CHECK bf_status study_trial_csv_line(const api_trial *trial, bf_buffer *out, bf_error *err);

/// Read the number and the values of a line of n bytes. False: it is none of such a study.
bool study_trial_csv_read(const study_columns *columns, const char *line, size_t n,
                          size_t *ret_number, double *ret_values);
