/// Inside the store: the versions of lines. Runs of an owner that belong to one line have the numbers of its scenarios, from 1
/// in the order of their first use. A number is its scenario's as long as a run has it.

#pragma once

#include "server/store/store_priv.h"

/// Number a run whose owner and line are filled in by what its resolved scenario is without its name (submission_identity()).
/// Of a run without a line, and of a trial, there is no number.
BF_MUST_CHECK bf_status store__number_version(store__connection *writer, store__row *row,
                                              const bf_buffer *identity, bf_error *err);

/// The same of a stored run.
BF_MUST_CHECK bf_status store__renumber_version(store__connection *writer, store__row *row,
                                                bf_error *err);
