/// The data of events: one JSON object in one line.
///
/// The first member of every object is "run", the id, so that a client that follows several runs in
/// one stream can tell them apart.

#pragma once

#include "api/json/members.h"
#include "api/results/key_figures.h"
#include "api/services.h"
#include "core/base/buffer.h"
#include "core/observe/frame.h"

#include <stdbool.h>

/// The data of each kind of event. Of a curve event there is one more list for each counter, under its
/// id; `data` of a snapshot event is added where a stream is asked for it.
extern const member_table events_status_data;
extern const member_table events_progress_data;
extern const member_table events_curve_data;
extern const member_table events_snapshot_data;
extern const member_table events_end_data;
extern const member_table events_figures_data;
extern const member_table events_eye_data;
extern const member_table events_action_data;
extern const member_table events_drive_data;
extern const member_table events_belt_data;

/// {"run", "id", "status", "progress", ...}: the run as GET /v1/runs/{id} shows it.
BF_MUST_CHECK bf_status events_status(const api_run *record, bf_buffer *out, bf_error *err);

/// {"run", "t_s", "progress", "steps_per_s", "eta_s"}. steps_per_s 0: not known yet.
BF_MUST_CHECK bf_status events_progress(const char *run_id, const frame_progress *p,
                                        double steps_per_s, bf_buffer *out, bf_error *err);

/// {"run", "first", "t_s": [...], "<counter id>": [...], ..., "left_domain": [...]}. columns as from
/// scenario_columns(), c->n_columns of them.
BF_MUST_CHECK bf_status events_curve(const char *run_id, const frame_curve *c, const char *columns,
                                     bf_buffer *out, bf_error *err);

/// {"run", "n", "t_s", "peak", "mass", "shape": [rows, columns], "url"}, and "parts_url" where the
/// parts come with the snapshot.
BF_MUST_CHECK bf_status events_snapshot(const char *run_id, const frame_snapshot *s, bool has_parts,
                                        bf_buffer *out, bf_error *err);

/// {"run", "t_s", "key_figures"}: the key figures so far. BF_ECORRUPT: see key_figures_check().
BF_MUST_CHECK bf_status events_figures(const char *run_id, const key_figures *figures,
                                       bf_buffer *out, bf_error *err);

/// {"run", "t_s", "photo_eye", "state"} or {"run", "t_s", "action", "target"}.
BF_MUST_CHECK bf_status events_change(const char *run_id, const frame_change *c, bf_buffer *out,
                                      bf_error *err);

/// The data of an event as they are of another run that has the same results. BF_ECORRUPT: no run is named in them.
BF_MUST_CHECK bf_status events_of_run(const char *run_id, const char *data, size_t n,
                                      bf_buffer *out, bf_error *err);

/// {"run", "status", "progress", "finished_at", "n_samples", "n_snapshots", "error"}: the last event
/// of a run.
BF_MUST_CHECK bf_status events_end(const api_run *record, bf_buffer *out, bf_error *err);
