/// Inside the store: the runs of trials, which enter the queue with their study's step and not by a request.

#pragma once

#include "server/store/store_priv.h"

/// Insert the run of a trial, as store_submit() would, but beyond quotas and the queue's limit: who works on a study
/// lets only a few of its runs wait. Its results have no snapshots.
BF_MUST_CHECK bf_status store__submit_trial(store__connection *writer,
                                            const api_submission *submission, const char *study_id,
                                            char ret_run[API_ID_SIZE], bf_error *err);
