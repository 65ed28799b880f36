/// A stored curve as CSV, made piece by piece, so that one of any length takes little memory. It has the same bytes as
/// results_curve_csv().

#pragma once

#include "api/body.h"
#include "api/services.h"
#include "core/base/buffer.h"

#include <stdbool.h>
#include <stdint.h>

/// A curve of some length. Owns nothing.
typedef struct curve_file {
    char id[API_ID_SIZE]; ///< of its run
    uint64_t n;           ///< samples
    uint64_t n_values;    ///< numbers: of each sample its time and a value of each column
    uint64_t at;          ///< the sample that comes next
    bool has_header;      ///< the first line was read
} curve_file;

/// Begin to read the first n samples of a run's curve.
BF_MUST_CHECK bf_status curve_file_open(const api_services *services, const char *id, uint64_t n,
                                        curve_file *ret_file, bf_error *err);

/// True if all was read.
bool curve_file_is_over(const curve_file *file);

/// Append the next lines to *out, some 100 KiB of them. Errors are those of api_services.read_curve(); BF_ENOTFOUND
/// also where there are fewer samples than before.
BF_MUST_CHECK bf_status curve_file_read(curve_file *file, const api_services *services,
                                        bf_buffer *out, bf_error *err);

/// Make a body of the file.
BF_MUST_CHECK bf_status curve_file_send(const curve_file *file, body_source *ret_source,
                                        bf_error *err);
