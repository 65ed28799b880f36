/// What a study found, as JSON.

#pragma once

#include "api/study/study_document.h"
#include "core/base/buffer.h"

/// Append what is known so far: the best point with its parameters and values, of replications their mean, standard
/// deviation and 95 % interval (Student), of jams their probability (Wilson); the points that the microscopic model
/// confirmed, and how far the models are apart there; curves that were left out, and profiles of parameters; warnings of the
/// best scenario, as advice_of() has them, of the macroscopic model wherever that was used. Changes the document's base.
/// BF_ENOMEM.
BF_MUST_CHECK bf_status study_best_write(study_document *document, const study *s, bf_buffer *out,
                                         bf_error *err);
