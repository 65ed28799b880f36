/// Conditions on numbers of a scenario or on key figures, by which lists of runs are searched.
///
///     angle_deg>50, cargo/mass_kg<=2, /duration_s=60
///
/// A name is a member's, or the end of its JSON pointer in whole names; with a slash before it, it is the whole pointer. A
/// condition holds where any number with this name is so; numbers with the same six significant digits are equal. Two names are
/// of what a document says by other members: `angle_deg` of a straight plate that is written by its ends, and `speed_m_s` of a
/// belt, |velocity_m_s|.

#pragma once

#include "api/run_list.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/// Read them from a text as above. BF_EINPUT: what is wrong with which of them; *ret_conditions is untouched.
BF_MUST_CHECK bf_status condition_list_read(const char *text, api_conditions *ret_conditions,
                                            bf_error *err);

/// Whether each of them holds in one of n documents, texts of JSON of so many bytes. What is no JSON has no numbers.
/// BF_ENOMEM.
BF_MUST_CHECK bf_status condition_list_hold(const api_conditions *conditions,
                                            const char *const *documents, const size_t *lengths,
                                            size_t n, bool *ret_hold, bf_error *err);
