/// Replications of a run: the study of one point that POST /v1/runs makes where it is asked for several runs.

#pragma once

#include "api/services.h"
#include "api/studies.h"

/// Make the study of a run that was read, with its model, priority and replications: list without parameters, and as values
/// throughput, residence, jams and, of parts, the longest queue. Its name is the run's label, else the scenario's name. BF_OK:
/// *ret_submission is the caller's, study_submission_fini(). BF_ENOMEM.
BF_MUST_CHECK bf_status study_replications_make(const api_submission *base,
                                                api_study_submission *ret_submission,
                                                bf_error *err);
