/// A 64-bit digest of bytes, after MurmurHash64A, over little-endian 64-bit words. It
/// detects truncated and damaged bytes and compares states; it is not cryptographic.

#pragma once

#include <stddef.h>
#include <stdint.h>

/// The digest of no bytes: where a chain of digest_add() starts.
#define DIGEST_START UINT64_C(0xcbf29ce484222325)

/// The digest after n further bytes. It depends on the division of the bytes:
/// adding a and then b is not adding ab.
uint64_t digest_add(uint64_t digest, const void *bytes, size_t n);
