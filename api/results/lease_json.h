/// Leases of workers (api/leases.h) as JSON, for the service and for workers, and the sections of frames that they send.
///
/// A section is 16 bytes, little-endian: u32 number of the job, u32 n, u64 offset of its first byte in the whole of the
/// job's frames; and n bytes.

#pragma once

#include "api/json/members.h"
#include "api/leases.h"
#include "core/base/faults.h"

enum { LEASE_SECTIONS_MAX = 4096 }; ///< of a request

/// Documents of workers: POST /v1/leases, POST /v1/leases/{id}/renew.
extern const member_table lease_json_worker_members;
extern const member_table lease_json_renewal_members;

/// Answers.
extern const member_table lease_json_lease;
extern const member_table lease_json_job;
extern const member_table lease_json_states;
extern const member_table lease_json_state;
extern const member_table lease_json_workers;
extern const member_table lease_json_worker;
extern const member_table lease_json_view;

/// Read the documents; faults are noted in *faults. *ret_renewal is the caller's: api_renewal_fini().
BF_MUST_CHECK bf_status lease_json_read_worker(const char *json, size_t n, api_worker *ret_worker,
                                               bf_faults *faults, bf_error *err);
BF_MUST_CHECK bf_status lease_json_read_renewal(const char *json, size_t n,
                                                api_renewal *ret_renewal, bf_faults *faults,
                                                bf_error *err);

/// Read at most LEASE_SECTIONS_MAX sections, which point into bytes. BF_EINPUT: the bytes are not such sections.
BF_MUST_CHECK bf_status lease_json_read_sections(const void *bytes, size_t n,
                                                 api_lease_section *ret_sections, size_t *ret_n,
                                                 bf_error *err);

/// Append the answers.
BF_MUST_CHECK bf_status lease_json_write(const api_lease *lease, bf_buffer *out, bf_error *err);
BF_MUST_CHECK bf_status lease_json_write_states(const api_job_states *states, bf_buffer *out,
                                                bf_error *err);
BF_MUST_CHECK bf_status lease_json_write_workers(const api_worker_list *list, bf_buffer *out,
                                                 bf_error *err);

/// The worker's side: append the bodies of POST /v1/leases, POST /v1/leases/{id}/renew, and a section.
BF_MUST_CHECK bf_status lease_json_write_worker(const api_worker *worker, bf_buffer *out,
                                                bf_error *err);
BF_MUST_CHECK bf_status lease_json_write_renewal(const api_renewal *renewal, bf_buffer *out,
                                                 bf_error *err);
BF_MUST_CHECK bf_status lease_json_write_section(const api_lease_section *section, bf_buffer *out,
                                                 bf_error *err);

/// Read answers. BF_ECORRUPT: it is none. *ret_lease, with its jobs numbered 0, 1, ..., is the caller's:
/// api_lease_fini(); free the items of *ret_states.
BF_MUST_CHECK bf_status lease_json_read(const char *json, size_t n, api_lease *ret_lease,
                                        bf_error *err);
BF_MUST_CHECK bf_status lease_json_read_states(const char *json, size_t n,
                                               api_job_states *ret_states, bf_error *err);

/// Copy what a problem document (RFC 9457) says is wrong to *err, with this code; where it is none, its first bytes.
bf_status lease_json_read_problem(const char *body, size_t n, bf_status code, bf_error *err);
