/// Inside the store: which run is next.

#pragma once

#include "server/store/store_priv.h"

/// Find the run that is next: of those by themselves with the highest priority, of owners within their quotas, that of the
/// owner who was served longest ago, and of theirs the oldest. Where there is none, and with_trials, the first trial that
/// waits of a study that is running: of those with the highest priority, of the owner whose trial began longest ago, that
/// of the study whose trial did. BF_ENOTFOUND: no run waits; BF_ELIMIT: only such of owners beyond their quotas.
BF_MUST_CHECK bf_status store__find_next(store__connection *reader, const store *s,
                                         bool with_trials, store__row *ret_row, bf_error *err);

/// The owner, or the study, of a run was served: all others come first.
BF_MUST_CHECK bf_status store__end_turn(store__connection *writer, const store__row *row,
                                        bf_error *err);

/// Check that a run, if it is a trial, may begin. BF_ECONFLICT: its study is not running any more.
BF_MUST_CHECK bf_status store__check_study(store__connection *writer, const store__row *row,
                                           bf_error *err);
