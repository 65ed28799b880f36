/// Stores that daemons of earlier versions wrote (tests/golden).

#pragma once

#include "tests/unit/server/helper_store.h"

/// Close the store, and put the one of this schema version in its place.
void helper_golden_put(helper_store *h, int version);
