/// What a study found, as JSON, and its trials as CSV.

#pragma once

#include "api/study/study_document.h"
#include "core/base/buffer.h"

/// How a trial ended.
typedef enum study_best_state {
    STUDY_TRIAL_SUCCEEDED,
    STUDY_TRIAL_FAILED,     ///< its run failed
    STUDY_TRIAL_INFEASIBLE, ///< its scenario is not valid
    STUDY_TRIAL_PRUNED,     ///< its run could not become the best any more
    STUDY_TRIAL_STATES
} study_best_state;

/// Their words, in the CSV.
extern const char *const study_best_states[];

/// Append what is known so far: the best point with its parameters and values, of replications their mean, standard
/// deviation and 95 % interval (Student), of jams their probability (Wilson); the points that the microscopic model
/// confirmed, and how far the models are apart there; curves that were left out, and profiles of parameters; warnings of the
/// best scenario, as run_review_of() has them, of the macroscopic model wherever that was used. Changes the document's base.
/// BF_ENOMEM.
BF_MUST_CHECK bf_status study_best_write(study_document *document, const study *s, bf_buffer *out,
                                         bf_error *err);

/// Append the header of the CSV: "trial,point,model,substream,<pointers>,state,<values>,fault". BF_ENOMEM.
BF_MUST_CHECK bf_status study_best_csv_header(const study_document *document, bf_buffer *out,
                                              bf_error *err);

/// Append the line of a trial with its values, NAN: empty; fault: why it has none, or NULL. BF_ENOMEM.
BF_MUST_CHECK bf_status study_best_csv_line(const study_document *document, const study *s,
                                            size_t trial, study_best_state state,
                                            const double *values, const char *fault, bf_buffer *out,
                                            bf_error *err);

/// Read the number and the values of a line of n bytes. False: it is none of such a study.
bool study_best_csv_read(const study_document *document, const char *line, size_t n,
                         size_t *ret_trial, double *ret_values);
