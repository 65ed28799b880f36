/// SHA-256 (FIPS 180-4): a digest of bytes that resists an adversary, so that equal digests may be
/// taken for equal bytes. digest.h is the quick one for damage.

#pragma once

#include <stddef.h>
#include <stdint.h>

enum {
    SHA256_SIZE = 32,  ///< bytes of a digest
    SHA256__BLOCK = 64 ///< bytes of a block
};

/// A digest on its way. sha256_begin() first; then any number of sha256_add(); at last sha256_end().
typedef struct sha256 {
    uint32_t state[8];                  ///< after the whole blocks so far
    uint64_t n;                         ///< bytes so far
    unsigned char block[SHA256__BLOCK]; ///< the bytes that do not fill a block yet
} sha256;

/// Begin.
void sha256_begin(sha256 *s);

/// Add n bytes. Cuts do not count: adding a and then b is adding ab.
void sha256_add(sha256 *s, const void *bytes, size_t n);

/// Write the digest of all that was added. *s is to be begun again.
void sha256_end(sha256 *s, unsigned char ret_digest[SHA256_SIZE]);
