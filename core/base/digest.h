/// A 64-bit digest of bytes, after MurmurHash64A, over little-endian 64-bit words. It
/// recognises torn and damaged bytes and compares states; it does not resist an adversary.

#pragma once

#include <stddef.h>
#include <stdint.h>

/// The digest of no bytes: where a chain of digest_add() starts.
#define DIGEST_START UINT64_C(0xcbf29ce484222325)

/// The digest after n further bytes. The cuts count: adding a and then b is not adding ab.
uint64_t digest_add(uint64_t digest, const void *bytes, size_t n);
