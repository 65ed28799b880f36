/// Warnings about how a line is operated: rates of feeds that belts cannot carry (feed_capacity()), actions in a circle, where a
/// belt is stopped by its own cargo in a beam, and nothing but photo eyes above belts that stand likewise starts it again;
/// failures that are too rare for the run.

#pragma once

#include "core/advice/review.h"
#include "core/base/status.h"
#include "core/scene/scene.h"

/// Add the warnings about a resolved and checked scenario. BF_ENOMEM.
BF_MUST_CHECK bf_status review_operation(const scene *s, review_warnings *ret_warnings,
                                         bf_error *err);
