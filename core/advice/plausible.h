/// Whether what a solver says of a run can be true of its scenario. For solvers elsewhere: whoever says that a run is done
/// must have said all of its results.

#pragma once

#include "core/base/status.h"
#include "core/run/run.h"

/// Compare what a run begins with with its resolved scenario: whose results they are, sizes and steps. BF_ECORRUPT: that is
/// another run.
BF_MUST_CHECK bf_status plausible_begin(const scene *s, run_model model, const frame_begin *begin,
                                        bf_error *err);

/// Compare the end of a run that is done with its scenario: steps, and how many samples and snapshots such a run has, by
/// schedule.h. Values of results are not looked at. BF_ECORRUPT: as of plausible_begin(), or that was not all of it.
BF_MUST_CHECK bf_status plausible_end(const scene *s, run_model model, const frame_begin *begin,
                                      const frame_end *end, bf_error *err);
