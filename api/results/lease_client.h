/// The worker's side of leases (api/leases.h): the documents that it sends, and the answers that it reads. The other
/// side is api/results/lease_json.h.

#pragma once

#include "api/leases.h"
#include "core/base/buffer.h"
#include "core/base/status.h"

/// Append the body of POST /v1/leases.
BF_MUST_CHECK bf_status lease_client_write_worker(const api_worker *worker, bf_buffer *out,
                                                  bf_error *err);

/// Append the body of POST /v1/leases/{id}/renew.
BF_MUST_CHECK bf_status lease_client_write_renewal(const api_renewal *renewal, bf_buffer *out,
                                                   bf_error *err);

/// Append a section of frames.
BF_MUST_CHECK bf_status lease_client_write_section(const api_lease_section *section, bf_buffer *out,
                                                   bf_error *err);

/// Read a lease, with its jobs numbered 0, 1, ...; *ret_lease is the caller's: api_lease_fini(). BF_ECORRUPT: it is
/// none. Members that this version does not know are ignored.
BF_MUST_CHECK bf_status lease_client_read_lease(const char *json, size_t n, api_lease *ret_lease,
                                                bf_error *err);

/// Read states of jobs; free the items. BF_ECORRUPT.
BF_MUST_CHECK bf_status lease_client_read_states(const char *json, size_t n,
                                                 api_job_states *ret_states, bf_error *err);

/// Copy what a problem document (RFC 9457) says is wrong to *err, with this code; where it is none, its first bytes.
bf_status lease_client_read_problem(const char *body, size_t n, bf_status code, bf_error *err);
