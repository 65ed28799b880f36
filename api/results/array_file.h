/// Files that are a stored array of numbers between two texts: NumPy files and VTK images. They are read piece by piece,
/// so that one of any size takes little memory, and have the same bytes as those of results.h.

#pragma once

#include "api/body.h"
#include "api/services.h"
#include "core/base/buffer.h"

#include <stddef.h>
#include <stdint.h>

/// A file. Zero-initialise; array_file_fini().
typedef struct array_file {
    bf_buffer head;    ///< before the numbers
    api_slices slices; ///< the numbers
    size_t item_size;  ///< bytes of a number
    bf_buffer tail;    ///< behind them
} array_file;

/// As what a snapshot is read: its density as a NumPy file or a VTK image, its parts as a NumPy file.
typedef enum array_file_form {
    ARRAY_FILE_NPY,
    ARRAY_FILE_VTI,
    ARRAY_FILE_PARTS_NPY
} array_file_form;

/// Begin to read a snapshot. Errors are those of api_services.read_array(). *ret_file is the caller's.
BF_MUST_CHECK bf_status array_file_open(const api_services *services, const char *id,
                                        uint64_t index, array_file_form form, array_file *ret_file,
                                        bf_error *err);

/// Bytes of the file.
uint64_t array_file_size(const array_file *file);

/// Append bytes of the file from number `at` on to *out, limit_bytes at most, and at least one unless `at` is its end.
/// Errors are those of api_services.read_slice().
BF_MUST_CHECK bf_status array_file_read(array_file *file, const api_services *services, uint64_t at,
                                        size_t limit_bytes, bf_buffer *out, bf_error *err);

/// Make a body of the file, which it takes over: *file is zeroed in any case.
BF_MUST_CHECK bf_status array_file_send(array_file *file, body_source *ret_source, bf_error *err);

/// Free what the file owns and zero it.
void array_file_fini(array_file *file);
