/// Sinks that take nothing, because nothing comes to them.

#pragma once

#include "core/advice/review.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

/// Warn of each sink over which no belt moves. BF_ENOMEM.
BF_MUST_CHECK bf_status review_sinks(const scene *s, review_warnings *ret_warnings, bf_error *err);
