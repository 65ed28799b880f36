/// What a client submits: a scenario with the model to solve it with, as the body of a POST.
///
///     {"scenario": {...}, "model": "macro", "label": "...", "line": "...", "priority": 0, "fresh": false, "replications": 1}
///
/// Reading is as strict as scenario_read(); pointers are those of the body ("/scenario/belts/0").
/// All but `scenario` may be left out.

#pragma once

#include "api/json/members.h"
#include "api/services.h"
#include "core/base/faults.h"

#include <stddef.h>

/// The body as a table. Its struct is the reader's own.
extern const member_table submission_members;

/// Priorities that a client may give.
extern const bf_range submission_priorities;

enum {
    SUBMISSION_TEXTS_MAX = 2 * 1024 * 1024, ///< bytes of all texts that a scenario may name
    SUBMISSION_PARTS_MAX = 20000,           ///< parts that a validation may list
    SUBMISSION_REPLICATIONS_MAX = 1000,     ///< runs of one submission
};

/// Read a body, resolve and check its scenario. All faults that can be found are noted in *faults.
/// BF_OK: *ret_submission has the resolved document, its identity and the columns of its curve (no
/// key) and is the caller's, submission_fini(). Else the status of the first fault, or BF_ENOMEM, and
/// *ret_submission is untouched. Text that is not JSON is one fault with pointer "" and line and
/// column in its text. *faults must be empty before; the caller limits n. What the scenario names by the ids of
/// measurements is read from texts, whose failure is one of the reading.
BF_MUST_CHECK bf_status submission_read(const char *json, size_t n, json_in_texts *texts,
                                        api_submission *ret_submission, bf_faults *faults,
                                        bf_error *err);

/// Make the submission of a scenario that is resolved and checked for the model, with no label, line, priority or key. BF_OK:
/// *ret_submission is the caller's, submission_fini(). BF_ENOMEM.
BF_MUST_CHECK bf_status submission_make(const scene *s, run_model model,
                                        api_submission *ret_submission, bf_error *err);

/// Append what a resolved scenario of n bytes is without its name, the identity that submission_make() gives it. BF_ECORRUPT:
/// it is damaged; BF_ENOMEM.
BF_MUST_CHECK bf_status submission_identity(const char *scenario, size_t n, bf_buffer *out,
                                            bf_error *err);

/// What POST /v1/validate answers to a submission that is valid, and a part in it; the structs are the writer's own.
extern const member_table submission_validation_members;
extern const member_table submission_part_members;

/// Append it: {"valid", "model", "warnings", "predicted_s", "validity", "parts", "resolved"}, with `validity` where the
/// model is the macroscopic one, and no prediction without speed (NULL). Of the parts at the start at most parts_max are
/// listed, evenly chosen in their order; 0: there is no list. BF_ENOMEM.
BF_MUST_CHECK bf_status submission_validation(const api_submission *submission,
                                              const prediction_speed *speed, size_t parts_max,
                                              bf_buffer *out, bf_error *err);

/// Free what a submission owns and zero it. NULL is fine.
void submission_fini(api_submission *submission);
