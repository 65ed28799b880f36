/// Which part is of which kind of cargo, where rows of parts do not say so themselves: in scenarios without feeds.

#pragma once

#include "api/snapshots.h"
#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

/// Kinds of parts in the order of placement. Zero-initialise: none; kinds_fini().
typedef struct part_kinds {
    size_t n;     ///< parts; 0: all are of one kind, or rows have their kinds
    uint32_t *of; ///< index of the kind of each part in the scenario's `cargo`
} part_kinds;

/// Find the kinds of a run's parts by its resolved scenario. *ret_kinds is the caller's: kinds_fini(). BF_ECORRUPT: the
/// document is damaged; BF_ENOMEM. *ret_kinds is then empty.
BF_MUST_CHECK bf_status kinds_find(const char *scenario, size_t n_scenario, const api_parts *parts,
                                   part_kinds *ret_kinds, bf_error *err);

/// Free what they own and zero them.
void kinds_fini(part_kinds *kinds);
