/// A run as JSON, for resources and events alike.

#pragma once

#include "api/json/json_out.h"
#include "api/services.h"

#include <stdint.h>

/// Write the members of a run into the object that is open: id, status, progress, model, label,
/// priority, name, created_at, started_at, finished_at, eta_s, error, cached, links.
void run_json_members(json_out *w, const api_run *record);

/// Append the run as an object.
BF_MUST_CHECK bf_status run_json_write(const api_run *record, bf_buffer *out, bf_error *err);

/// Write the member error: null, or {"code", "pointer", "detail"}.
void run_json_error(json_out *w, const bf_error *error);

/// Write a member that is a point in time (Unix ms): "2026-01-31T12:00:00.000Z"; 0 is null.
void run_json_time(json_out *w, const char *key, int64_t unix_ms);
