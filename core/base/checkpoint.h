/// Checkpoints: the bytes of a solver's state, in one envelope for all solvers.
///
///     offset  bytes  content, little-endian
///     0       4      magic "BFCP"
///     4       4      CHECKPOINT_VERSION
///     8       4      owner of the state, enum checkpoint_kind
///     12      4      0
///     16      8      digest of the definition that the state belongs to; 0 of envelopes within a run's, which has it
///     24      8      n, length of the payload
///     32      8      digest of the bytes 0 to 31 and of the payload
///     40      n      payload: fields as the solver writes them
///
/// A checkpoint is read only by the same version into a solver of the same kind and definition. Envelopes
/// may be nested: the payload of a run's ends with its solver's.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Incremented with every change of the format of any solver's state.
enum { CHECKPOINT_VERSION = 25 };

/// The owner of a checkpoint's state.
typedef enum checkpoint_kind {
    CHECKPOINT_RUN = 1, ///< core/run
    CHECKPOINT_MACRO,   ///< core/macro
    CHECKPOINT_DISK,    ///< core/micro/disk
    CHECKPOINT_BODY,    ///< core/micro/body
} checkpoint_kind;

/// A checkpoint that is being written. checkpoint_begin(), checkpoint_end().
typedef struct checkpoint_writer {
    bf_buffer *out;  ///< what it is appended to
    size_t start;    ///< of the envelope in *out
    bool has_failed; ///< an allocation failed; further writes do nothing
} checkpoint_writer;

/// A checkpoint that is being read. checkpoint_open().
typedef struct checkpoint_reader {
    const char *at; ///< the next byte
    size_t n_left;  ///< bytes of the payload from there on
} checkpoint_reader;

/// Begin a checkpoint at the end of *out, which must outlive the writer.
void checkpoint_begin(checkpoint_writer *w, bf_buffer *out, checkpoint_kind kind,
                      uint64_t definition);

/// Append n bytes to the payload.
void checkpoint_write(checkpoint_writer *w, const void *bytes, size_t n);

/// Where in the payload the next byte is written.
size_t checkpoint_at(const checkpoint_writer *w);

/// Replace n bytes of the payload from `at` on, which were written before: for counts that are known only at the end.
void checkpoint_rewrite(checkpoint_writer *w, size_t at, const void *bytes, size_t n);

/// Complete the envelope. BF_ENOMEM: some write had no memory; the buffer is as before checkpoint_begin().
BF_MUST_CHECK bf_status checkpoint_end(checkpoint_writer *w, bf_error *err);

/// Begin to read the n bytes of a checkpoint, which must outlive the reader. BF_ECORRUPT: damaged, or of
/// another version, kind or definition.
BF_MUST_CHECK bf_status checkpoint_open(checkpoint_reader *r, const void *bytes, size_t n,
                                        checkpoint_kind kind, uint64_t definition, bf_error *err);

/// Copy the next n bytes to ret_bytes. False: there are not so many left.
BF_MUST_CHECK bool checkpoint_read(checkpoint_reader *r, void *ret_bytes, size_t n);

/// The next n_items items of size bytes, in place and not aligned. NULL: there are not so many left.
const char *checkpoint_read_items(checkpoint_reader *r, uint64_t n_items, size_t size);
