/// What a model saves, in the envelope of a run: run_backend.save and .load.

#pragma once

#include "core/run/run_priv.h"

/// Append it to *out. BF_ENOMEM: *out is as before.
bf_status helper_backend_save(const run_backend *model, const void *solver, bf_buffer *out);

/// Take it from there.
bf_status helper_backend_load(const run_backend *model, void *solver, const bf_buffer *from);
