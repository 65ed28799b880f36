/// The data of events: one JSON object in one line for each frame of a run worth telling.

#pragma once

#include "api/services.h"
#include "core/base/buffer.h"
#include "core/run/frame.h"

/// {"id", "status", "progress", ...}: the run as GET /v1/runs/{id} shows it.
BF_MUST_CHECK bf_status events_status(const api_run *run, bf_buffer *out, bf_error *err);

/// {"t_s", "progress", "steps_per_s", "eta_s"}.
BF_MUST_CHECK bf_status events_progress(const frame_progress *p, double steps_per_s, bf_buffer *out,
                                        bf_error *err);

/// {"first", "t_s": [...], "<counter id>": [...], ..., "left_domain": [...]}. columns as from
/// scenario_columns().
BF_MUST_CHECK bf_status events_curve(const frame_curve *c, const char *columns, bf_buffer *out,
                                     bf_error *err);

/// {"n", "t_s", "peak", "mass", "url"}.
BF_MUST_CHECK bf_status events_snapshot(const char *run_id, const frame_snapshot *s, bf_buffer *out,
                                        bf_error *err);

/// {"status", "t_s", ...}: the last event of a run.
BF_MUST_CHECK bf_status events_end(const api_run *run, bf_buffer *out, bf_error *err);
