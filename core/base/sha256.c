#include "core/base/sha256.h"

#include <string.h>

// Names of functions and variables are those of FIPS 180-4, sections 4.1.2 and 6.2.2.
static const uint32_t K[SHA256__BLOCK] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2,
};

static const uint32_t initial[8] = { 0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                     0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19 };

static uint32_t rotate(uint32_t x, unsigned n)
{
    return x >> n | x << (32 - n);
}

static void put_big(uint32_t x, unsigned char *to)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(x >> (24 - 8 * i));
}

static void schedule(const unsigned char *block, uint32_t W[SHA256__BLOCK])
{
    for (size_t t = 0; t < 16; t++, block += 4)
        W[t] = (uint32_t)block[0] << 24 | (uint32_t)block[1] << 16 | (uint32_t)block[2] << 8 |
               block[3];
    for (size_t t = 16; t < SHA256__BLOCK; t++) {
        uint32_t sigma0 = rotate(W[t - 15], 7) ^ rotate(W[t - 15], 18) ^ W[t - 15] >> 3;
        uint32_t sigma1 = rotate(W[t - 2], 17) ^ rotate(W[t - 2], 19) ^ W[t - 2] >> 10;
        W[t] = sigma1 + W[t - 7] + sigma0 + W[t - 16];
    }
}

static void add_block(uint32_t state[8], const unsigned char *block)
{
    uint32_t W[SHA256__BLOCK], v[8];

    schedule(block, W);
    memcpy(v, state, sizeof v);
    for (size_t t = 0; t < SHA256__BLOCK; t++) {
        uint32_t a = v[0], e = v[4];
        uint32_t sum0 = rotate(a, 2) ^ rotate(a, 13) ^ rotate(a, 22);
        uint32_t sum1 = rotate(e, 6) ^ rotate(e, 11) ^ rotate(e, 25);
        uint32_t majority = (a & v[1]) ^ (a & v[2]) ^ (v[1] & v[2]);
        uint32_t choice = (e & v[5]) ^ (~e & v[6]);
        uint32_t T1 = v[7] + sum1 + choice + K[t] + W[t];
        memmove(v + 1, v, 7 * sizeof *v);
        v[4] += T1;
        v[0] = T1 + sum0 + majority;
    }
    for (size_t i = 0; i < 8; i++)
        state[i] += v[i];
}

void sha256_begin(sha256 *s)
{
    s->n = 0;
    memcpy(s->state, initial, sizeof initial);
}

void sha256_add(sha256 *s, const void *bytes, size_t n)
{
    const unsigned char *from = bytes;

    while (n > 0) {
        size_t used = s->n % SHA256__BLOCK;
        size_t room = SHA256__BLOCK - used;
        size_t taken = n < room ? n : room;
        memcpy(s->block + used, from, taken);
        s->n += taken;
        from += taken;
        n -= taken;
        if (taken == room)
            add_block(s->state, s->block);
    }
}

void sha256_end(sha256 *s, unsigned char ret_digest[SHA256_SIZE])
{
    static const unsigned char padding[SHA256__BLOCK] = { 0x80 };
    uint64_t n_bits = s->n * 8;
    unsigned char length[8];

    put_big((uint32_t)(n_bits >> 32), length);
    put_big((uint32_t)n_bits, length + 4);
    // One byte of padding at least, and then as many as leave room for the length.
    sha256_add(s, padding, SHA256__BLOCK - (s->n + sizeof length) % SHA256__BLOCK);
    sha256_add(s, length, sizeof length);
    for (size_t i = 0; i < 8; i++)
        put_big(s->state[i], ret_digest + 4 * i);
}
