/// JSON text laid out for people: two blanks a level, and on one line whatever fits there.

#pragma once

#include "core/base/buffer.h"

/// Append the JSON text of n bytes, laid out, to *out, with a last line end. The text must be valid
/// JSON and must not lie in *out.
/// BF_ENOMEM: *out is as before.
BF_MUST_CHECK bf_status json_layout(const char *json, size_t n, bf_buffer *out, bf_error *err);
