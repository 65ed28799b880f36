/// A run as JSON, for resources and events alike.

#pragma once

#include "api/json/members.h"
#include "api/services.h"

/// A run, and its links; the struct of both is api_run.
extern const member_table run_json;
extern const member_table run_json_links;

/// A page of a list of runs; the struct is api_run_list.
extern const member_table run_json_list;

/// Why a run failed; the struct is bf_error.
extern const member_table run_json_error;

/// The kind of a member that is a bf_error: null where its code is BF_OK.
extern const member_kind run_json_error_kind;

/// Append the run as an object.
BF_MUST_CHECK bf_status run_json_write(const api_run *record, bf_buffer *out, bf_error *err);
