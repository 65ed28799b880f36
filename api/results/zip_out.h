/// A ZIP archive that is written as a stream: bytes are appended as soon as they are final. Files are deflated; the same files give the same bytes in every time zone but for the
/// DOS times, which are local by that format: a program that wants the same bytes everywhere runs
/// in UTC.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

/// An archive being written; opaque. Some 300 kB, and 100 bytes for each file in it.
typedef struct zip_out zip_out;

/// Begin an archive whose files carry the time mtime_s (Unix). BF_ENOMEM.
BF_MUST_CHECK bf_status zip_out_create(int64_t mtime_s, zip_out **ret_zip, bf_error *err);

/// For a file whose size is not known before its end.
#define ZIP_OUT_ANY_SIZE SIZE_MAX

/// Begin a file of n bytes; the one before is complete. name is ASCII with '/' between folders. This
/// and the following append to *out what became ready of the archive. After a failure (BF_ENOMEM)
/// nothing but zip_out_destroy() is left.
BF_MUST_CHECK bf_status zip_out_file(zip_out *z, const char *name, size_t n, bf_buffer *out,
                                     bf_error *err);

/// Add n bytes to the file, no more than are left of it.
BF_MUST_CHECK bf_status zip_out_bytes(zip_out *z, const void *bytes, size_t n, bf_buffer *out,
                                      bf_error *err);

/// End the archive: its directory.
BF_MUST_CHECK bf_status zip_out_finish(zip_out *z, bf_buffer *out, bf_error *err);

/// Free it, finished or not. NULL is fine. Always returns NULL.
zip_out *zip_out_destroy(zip_out *z);
