/// What a client submits as a study: its document, which may name measurements that the service has stored.
///
/// A feed of the base's scenario names them as in every submission, and a curve as {"counter": ID, "measurement": ID}. The
/// stored document has what they stand for, so that it is read without the service.

#pragma once

#include "api/json/json_in.h"
#include "api/studies.h"
#include "core/base/faults.h"

#include <stddef.h>

enum { STUDY_SUBMISSION_TEXTS_MAX = 8 * 1024 * 1024 }; ///< bytes of all texts that it may name

/// The kind of texts that curves name: {"t_s": [...], "count": [...]}.
extern const char study_submission_curve[];

/// Read a document of n bytes and check it, its base, too. All faults that can be found are noted in *faults. BF_OK:
/// *ret_submission has name, line, method, model, priority, limit, document and columns and is the caller's,
/// study_submission_fini(). Else the status of the first fault, or BF_ENOMEM, or the failure of texts, and *ret_submission
/// is untouched.
BF_MUST_CHECK bf_status study_submission_read(const char *json, size_t n, json_in_texts *texts,
                                              api_study_submission *ret_submission,
                                              bf_faults *faults, bf_error *err);

/// Free what a submission owns and zero it. NULL is fine.
void study_submission_fini(api_study_submission *submission);
