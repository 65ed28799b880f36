/// Inside the store: what owners use and may use.

#pragma once

#include "server/store/store_priv.h"

/// Charge the owner of a run for what it has used since it was charged last; cpu_s is that of all its attempts. The row
/// is to be saved in the same transaction.
BF_MUST_CHECK bf_status store__charge(store__connection *writer, store__row *row, double cpu_s,
                                      bf_error *err);

/// Charge an owner for CPU time that the service used for him, s.
BF_MUST_CHECK bf_status store__charge_owner(store__connection *writer, const char *owner,
                                            double cpu_s, bf_error *err);

/// Check that an owner may store further results. BF_ENOSPACE.
BF_MUST_CHECK bf_status store__check_bytes(store__connection *writer, const store *s,
                                           const char *owner, bf_error *err);

/// Check that an owner may store a further measurement; have a further study. BF_ECONFLICT.
BF_MUST_CHECK bf_status store__check_measurements(store__connection *writer, const store *s,
                                                  const char *owner, bf_error *err);
BF_MUST_CHECK bf_status store__check_studies(store__connection *writer, const store *s,
                                             const char *owner, bf_error *err);

/// Check that an owner may have a further run solved. BF_ELIMIT; *ret_retry_s is set if it is known when it may.
BF_MUST_CHECK bf_status store__check_owner(store__connection *writer, const store *s,
                                           const char *owner, unsigned *ret_retry_s, bf_error *err);

/// True if an owner's runs wait until less of a quota is used.
BF_MUST_CHECK bf_status store__is_held(store__connection *reader, const store *s, const char *owner,
                                       bool *ret_is_held, bf_error *err);

/// Delete what no quota counts any more, and owners without runs.
BF_MUST_CHECK bf_status store__forget_use(store__connection *writer, bf_error *err);
