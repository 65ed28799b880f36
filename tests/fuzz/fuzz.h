/// What all fuzz targets share: the entry that libFuzzer and replay.c call, and readers of an input.
///
/// A target gives bytes to a reader of ours that meets bytes of strangers. It fails by a report of a sanitizer, by
/// a broken invariant (BF_CHECK) and by fuzz_require().

#pragma once

#include "core/base/buffer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Read one input. Always returns 0, as libFuzzer wants it.
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n);

/// Say what does not hold and abort, if it does not.
void fuzz_require(bool holds, const char *what);

/// The n bytes with a terminating zero, on the heap, so that a read beyond them is found. The caller frees it, free().
char *fuzz_text(const uint8_t *bytes, size_t n);

/// Write the digest of a checkpoint (core/base/checkpoint.h) over the one in the n bytes, so that what follows it is
/// read, too. False: they are shorter than an envelope.
bool fuzz_seal_checkpoint(uint8_t *bytes, size_t n);

/// Same for a frame (core/observe/frame.h), whose length is that of the n bytes.
bool fuzz_seal_frame(uint8_t *bytes, size_t n);
