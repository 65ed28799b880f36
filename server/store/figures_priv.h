/// Private parts of what the store says about itself: figures (store_figures.c), a sign of life, and
/// whether it can write (store_ready.c).

#pragma once

#include "server/base/liveness.h"
#include "server/store/store.h"

#include <stdbool.h>
#include <stdint.h>

enum { STORE__COUNT_MS = 1000 }; ///< between two counts of the figures

/// The figures and when they are counted; under the store's lock.
typedef struct store__tally {
    store_figures figures; ///< as counted last
    bool has_changed;      ///< since then
    int64_t count_at_ms;   ///< monotonic; they are not counted again before
    pulse pulse;           ///< of the store's thread
} store__tally;

/// What a write test said; under the store's lock.
typedef struct store__verdict {
    int64_t until_ms; ///< monotonic; until then it counts
    bf_status status; ///< of the test
    bf_error error;   ///< of a status that is not BF_OK
} store__verdict;

/// Count the figures by the writer's connection.
BF_MUST_CHECK bf_status store__count(store *s, store_figures *ret_figures, bf_error *err);
