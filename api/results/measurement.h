/// What was measured elsewhere: what a client posts, and what it gets back.
///
///     {"label": "...", "counter": "upstream", "t_s": [...], "count": [...]}
///
/// or CSV with the header "t_s,count" or "t_s,<counter>". A measurement has 2 to
/// API_MEASUREMENT_SAMPLES_MAX samples at rising times, and counts that are not negative. It belongs to
/// a counter: a column of the curves that it is compared with. Profiles and lists of arrivals of feeds are CSV
/// (api/scenario/feed_csv.h), and are kept as they came.

#pragma once

#include "api/json/members.h"
#include "api/services.h"
#include "core/base/faults.h"

#include <stddef.h>

/// The JSON body as a table. Its struct is the reader's own.
extern const member_table measurement_members;

/// A measurement with its samples. Zero-initialise; measurement_fini().
typedef struct measurement {
    api_measurement about; ///< without id and time of creation before it is stored
    api_curve curve;       ///< one column, the counter; empty where it is no curve
    bf_buffer csv;         ///< the text where it is none
} measurement;

/// Read a JSON body. All faults that can be found are noted in *faults with their JSON pointers. BF_OK:
/// *ret_measurement is the caller's. Else the status of the first fault, or BF_ENOMEM, and
/// *ret_measurement is untouched. *faults must be empty before; the caller limits n.
BF_MUST_CHECK bf_status measurement_read_json(const char *json, size_t n,
                                              measurement *ret_measurement, bf_faults *faults,
                                              bf_error *err);

/// Same of CSV: the first column after the time. Its faults have the pointers "/line/<number>", from 1.
/// label (NULL: none) and counter (NULL: the name of the column; that of "count" is "upstream") come
/// with the request; their faults have the pointers "/label" and "/counter".
BF_MUST_CHECK bf_status measurement_read_csv(const char *text, size_t n, const char *label,
                                             const char *counter, measurement *ret_measurement,
                                             bf_faults *faults, bf_error *err);

/// Same of a profile or schedule (kind), with the same pointers, up to the first fault.
BF_MUST_CHECK bf_status measurement_read_feed(const char *text, size_t n, api_measured kind,
                                              const char *label, measurement *ret_measurement,
                                              bf_faults *faults, bf_error *err);

/// What is answered: a measurement without its samples (the struct is api_measurement) and its links,
/// one with them, and a page of a list (api_page).
extern const member_table measurement_item;
extern const member_table measurement_links;
extern const member_table measurement_stored;
extern const member_table measurement_list;

/// Append a measurement with its samples or its text as JSON.
BF_MUST_CHECK bf_status measurement_json(const api_measurement *about, const api_curve *curve,
                                         const bf_buffer *csv, bf_buffer *out, bf_error *err);

/// Free what a measurement owns and zero it. NULL is fine.
void measurement_fini(measurement *m);
