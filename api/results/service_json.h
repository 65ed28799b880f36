/// What the service answers of itself.

#pragma once

#include "api/access.h"
#include "api/json/members.h"
#include "api/quotas.h"
#include "core/base/buffer.h"

/// Objects of GET /livez, /readyz, /version and /v1/quota, and of POST /v1/tickets.
extern const member_table service_json_alive_members;
extern const member_table service_json_ready_members;
extern const member_table service_json_version_members;
extern const member_table service_json_ticket_members;
extern const member_table service_json_quota_members;
extern const member_table service_json_quotas_members;

/// Append them.
BF_MUST_CHECK bf_status service_json_alive(bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status service_json_ready(bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status service_json_version(bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status service_json_ticket(const api_ticket *ticket, bf_buffer *out,
                                            bf_error *err);
BF_MUST_CHECK bf_status service_json_quotas(const api_quotas *quotas, bf_buffer *out,
                                            bf_error *err);
