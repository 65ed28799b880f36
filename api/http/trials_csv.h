/// The trials of a study that have ended, as CSV, page by page: a long study is never in memory as a whole.

#pragma once

#include "api/body.h"
#include "api/study/study_trial.h"

/// Make the trials that had ended when the study was found, by number, the body of a response: a header and a line each, as
/// the command line writes them. *ret_source is the caller's; its destroy() frees it. BF_ENOMEM.
BF_MUST_CHECK bf_status trials_csv_open(const api_study *about, const study_columns *columns,
                                        body_source *ret_source, bf_error *err);
