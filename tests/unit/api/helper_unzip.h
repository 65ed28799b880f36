/// ZIP archives taken apart by libarchive's reader, which checks their sizes and checksums.

#pragma once

#include "core/base/buffer.h"

#include <stdint.h>

enum { UNZIP_FILES_MAX = 64 };

/// A file of an archive.
typedef struct unzip_file {
    char name[64];     ///< with its folders
    int64_t mtime_s;   ///< Unix
    bf_buffer content; ///< its bytes
} unzip_file;

/// Read an archive of at most UNZIP_FILES_MAX files. Returns how many; unzip_fini() frees them. Fails
/// the test where the archive is damaged.
size_t unzip_all(const bf_buffer *zip, unzip_file *ret_files);

/// Free what the files own.
void unzip_fini(unzip_file *files, size_t n);
