/// Inside the store: large blobs, compressed and cut into rows. Knows nothing of runs.

#pragma once

#include "api/snapshots.h"
#include "core/base/buffer.h"
#include "core/base/status.h"
#include "core/observe/frame.h"
#include "server/store/connection.h"

#include <stddef.h>
#include <stdint.h>

/// Kinds of chunked blobs. The values stand in the store: never renumber.
typedef enum store__blob {
    STORE__BLOB_SNAPSHOT,   ///< item: index of the snapshot
    STORE__BLOB_CHECKPOINT, ///< item: 0
    STORE__BLOB_PARTS,      ///< item: index of the snapshot that they belong to
} store__blob;

/// The blob that is an array of a snapshot.
static inline store__blob store__blob_of(api_array_kind kind)
{
    return kind == API_ARRAY_PARTS ? STORE__BLOB_PARTS : STORE__BLOB_SNAPSHOT;
}

/// Bytes of a blob that are compressed alone, as a frame of zstd in a row of its own, so that they can be read alone.
/// Blobs of stores before this are one frame, cut into rows.
#define STORE__SLICE_BYTES FRAME_SLICE_BYTES

/// What compresses, again and again; zstd's.
typedef struct ZSTD_CCtx_s store__packer;

/// Create one. NULL: no memory.
store__packer *store__packer_create(void);
void store__packer_destroy(store__packer *packer);

/// Append bytes, compressed, to *out: one frame for each slice of them.
BF_MUST_CHECK bf_status store__pack(store__packer *packer, const void *bytes, size_t n,
                                    bf_buffer *out, bf_error *err);

/// Append what was compressed to *out. BF_ECORRUPT: damaged.
BF_MUST_CHECK bf_status store__unpack(const bf_buffer *compressed, bf_buffer *out, bf_error *err);

/// Insert a compressed blob, or its part from byte `at` on, each frame as a chunk. What was stored of the blob before gives
/// way to its first byte. BF_ECORRUPT: `at` is not where the chunks that are stored end.
BF_MUST_CHECK bf_status store__insert_chunks(store__connection *writer, int64_t results,
                                             store__blob kind, uint64_t item, uint64_t at,
                                             const bf_buffer *compressed, bf_error *err);

/// Append the chunks of a compressed blob to *out; nothing if there is none. BF_ECORRUPT: one is missing before others.
BF_MUST_CHECK bf_status store__get_chunks(store__connection *c, int64_t results, store__blob kind,
                                          uint64_t item, bf_buffer *out, bf_error *err);

/// Append one chunk of a blob to *out. BF_ECORRUPT: there is none.
BF_MUST_CHECK bf_status store__get_chunk(store__connection *c, int64_t results, store__blob kind,
                                         uint64_t item, uint64_t part, bf_buffer *out,
                                         bf_error *err);

/// How many chunks a blob has: one more than the number of the last one.
BF_MUST_CHECK bf_status store__count_chunks(store__connection *c, int64_t results, store__blob kind,
                                            uint64_t item, uint64_t *ret_n, bf_error *err);

/// Turn a failure of zstd into an error: BF_ENOMEM, or `otherwise`.
bf_status store__fail_zstd(size_t code, bf_status otherwise, bf_error *err);

/// Delete a compressed blob.
BF_MUST_CHECK bf_status store__delete_chunks(store__connection *writer, int64_t results,
                                             store__blob kind, uint64_t item, bf_error *err);

/// Delete what is stored of snapshots from this one on: none of them was completed.
BF_MUST_CHECK bf_status store__delete_open_snapshots(store__connection *writer, int64_t results,
                                                     uint64_t first, bf_error *err);
