/// Inside the store: what owners use and may use, and whose run is next.

#pragma once

#include "server/store/store_priv.h"

/// What owners may use at the moment.
store_quotas store__quotas(const store *s);

/// Charge the owner of a run for what it has used since it was charged last; cpu_s is that of all its attempts. The row
/// is to be saved in the same transaction.
BF_MUST_CHECK bf_status store__charge(store__connection *writer, store__row *row, double cpu_s,
                                      bf_error *err);

/// Check that an owner may store further results. BF_ENOSPACE.
BF_MUST_CHECK bf_status store__check_bytes(store__connection *writer, const store *s,
                                           const char *owner, bf_error *err);

/// Check that an owner may have a further run solved. BF_ELIMIT; *ret_retry_s is set if it is known when it may.
BF_MUST_CHECK bf_status store__check_owner(store__connection *writer, const store *s,
                                           const char *owner, unsigned *ret_retry_s, bf_error *err);

/// Find the run that is next: of those with the highest priority of owners within their quotas, that of the owner who was
/// served longest ago, and of theirs the oldest. BF_ENOTFOUND: no run waits; BF_ELIMIT: only such of owners beyond
/// their quotas.
BF_MUST_CHECK bf_status store__find_next(store__connection *reader, const store *s,
                                         store__row *ret_row, bf_error *err);

/// The owner was served: all others come first.
BF_MUST_CHECK bf_status store__end_turn(store__connection *writer, const char *owner,
                                        bf_error *err);

/// Delete what no quota counts any more, and owners without runs.
BF_MUST_CHECK bf_status store__forget_use(store__connection *writer, bf_error *err);
