/// A study as JSON, for resources and events alike.

#pragma once

#include "api/json/members.h"
#include "api/services.h"

/// A study, the numbers of its trials, and its links; the struct of all is api_study.
extern const member_table study_json;
extern const member_table study_json_trials;
extern const member_table study_json_links;

/// A page of a list of studies; the struct is api_page.
extern const member_table study_json_list;

/// Append the study as an object. BF_ENOMEM.
BF_MUST_CHECK bf_status study_json_write(const api_study *about, bf_buffer *out, bf_error *err);
