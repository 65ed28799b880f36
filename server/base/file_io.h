/// Files of the command line: read whole, written whole.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/// Append what path holds to *out; "-" is standard input, a directory stands for `inside` in it
/// (NULL: directories are refused). BF_EINPUT: cannot be opened or read; BF_ELIMIT: more than limit
/// bytes; BF_ENOMEM. *out is then as before.
BF_MUST_CHECK bf_status file_io_read(const char *path, const char *inside, size_t limit,
                                     bf_buffer *out, bf_error *err);

/// Same from an open descriptor to its end; name is for the error's text.
BF_MUST_CHECK bf_status file_io_read_fd(int fd, const char *name, size_t limit, bf_buffer *out,
                                        bf_error *err);

/// Write n bytes to a blocking descriptor. False: errno tells why, some bytes may be out.
bool file_io_write_fd(int fd, const void *bytes, size_t n);

/// When a replaced file is on the disk.
typedef enum file_io_sync {
    FILE_IO_LATER, ///< whenever the system likes
    FILE_IO_NOW,   ///< its bytes when it gets its name, the name when the call returns
} file_io_sync;

/// Put a file of n bytes under a name in an open directory in one step: a reader finds the old file
/// or the new one, never a part. BF_ESYSTEM: the old one is still there, or the new one if only the directory could not
/// be synced.
BF_MUST_CHECK bf_status file_io_replace(int directory, const char *name, const void *bytes,
                                        size_t n, file_io_sync sync, bf_error *err);

/// Bytes of a file that is made of several.
typedef struct file_io_piece {
    const void *bytes; ///< n of them
    size_t n;          ///< bytes
} file_io_piece;

/// The same with a file that is all the pieces, in order.
BF_MUST_CHECK bf_status file_io_replace_by_pieces(int directory, const char *name,
                                                  const file_io_piece *pieces, size_t n_pieces,
                                                  file_io_sync sync, bf_error *err);

/// Give a file that was written under a temporary name its own one, unless that is taken; both are in
/// one directory, and on disk when this returns. BF_EINPUT: the name is taken; BF_ESYSTEM: it cannot
/// be done. The temporary name is then still there.
BF_MUST_CHECK bf_status file_io_publish(const char *temporary, const char *path, bf_error *err);

/// Put a file that was written under a temporary name in the place of one in the same directory; it is on disk when this
/// returns. BF_ESYSTEM: the old one is still there, or the new one if only the directory could not be synced.
BF_MUST_CHECK bf_status file_io_take_place(const char *temporary, const char *path, bf_error *err);

/// Make a directory and what is above it, like mkdir -p. What is there already is left as it is, and
/// may be something else than a directory. False: errno.
bool file_io_make_directories(const char *path, mode_t mode, file_io_sync sync);
